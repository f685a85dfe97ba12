"""Figures of the atomistic stages: hardness and elasticity."""

from itertools import cycle

import numpy as np

from workflow.report.available import Results, Row, column, number
from workflow.report.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, SERIES, SKY, SOFT, draw

SCALES = {"1.0": ("full energies", BLUE, "o"), "0.5": ("halved energies", ORANGE, "s")}
SLICE_NM = 0.25  # half the thickness of a slice that is drawn
PAPER_HARDNESS = ((3.0, 10.0), (15.0, 2.0))  # nm, GPa: "~10 GPa at 3 nm, ~2 GPa at 15 nm" in the paper's text


def contact_stress(results: Results) -> str | None:
    """Figure 7: contact stress against contact length of the closing runs."""
    runs = results.matching("hardness/closing/", ".csv")
    if not runs:
        return None
    points = {row["run"]: row for row in results.csv("hardness/points.csv")}

    def plot(axis):
        highest = 1.0
        for name in runs:
            rows = results.csv(name)
            length, stress = column(rows, "contact_length_nm"), column(rows, "contact_stress_GPa")
            run = name.rpartition("/")[2].removesuffix(".csv")
            point = points.get(run, {})
            _, color, _ = _scale(point)
            use = np.isfinite(length) & np.isfinite(stress) & (length > 0.8)
            if not use.any():
                continue
            axis.plot(length[use], stress[use], color=color, linewidth=0.8, alpha=0.7)
            highest = max(highest, float(np.quantile(stress[use], 0.98)))
            at, hardness = number(point.get("contact_length_nm")), number(point.get("hardness_GPa"))
            if point.get("status") == "yield" and np.isfinite(at):
                axis.plot(at, hardness, "D", color=color, markeredgecolor=INK, markersize=6)
                onset = number(point.get("onset_length_nm"))
                if np.isfinite(onset):
                    then = np.argmin(np.abs(length[use] - onset))
                    axis.plot(
                        length[use][then], stress[use][then], "o", color=color, markerfacecolor="none", markersize=6
                    )
        for label, color, _ in SCALES.values():
            axis.plot([], [], color=color, label=label)
        axis.plot([], [], "o", color=SOFT, markerfacecolor="none", label="onset of plastic flow")
        axis.plot([], [], "D", color=SOFT, label="hardness of the run")
        axis.set(
            xlabel="contact length √A (nm)",
            ylabel="contact stress (GPa)",
            ylim=(0, 1.1 * highest),
            xlim=(0.8, None),
        )
        axis.legend()

    return draw("fig7", "Contact stress against contact length of each closing run", plot)


def hardness_size(results: Results) -> str | None:
    """Figure 8: hardness against contact length, with the fit and the paper's two stated values."""
    points = results.csv("hardness/points.csv")
    fit = results.json("hardness/fit.json") if results.has("hardness/fit.json") else {}

    def plot(axis):
        for key, (label, color, marker) in SCALES.items():
            part = [row for row in points if _key(row) == key and row.get("status") == "yield"]
            if part:
                length, hardness = column(part, "contact_length_nm"), column(part, "hardness_GPa")
                low, high = column(part, "hardness_lo"), column(part, "hardness_hi")
                bars = np.nan_to_num(np.clip([hardness - low, high - hardness], 0, None))
                face = color if key == "1.0" else "none"
                axis.errorbar(
                    length, hardness, yerr=bars, fmt=marker, color=color, markerfacecolor=face, label=label, capsize=3
                )
        if fit.get("curve"):
            length, low, high, middle = (
                np.array([point[key] for point in fit["curve"]], dtype=float)
                for key in ("contact_length_nm", "low_GPa", "high_GPa", "median_GPa")
            )
            axis.fill_between(length, low, high, color=GREEN, alpha=0.18, linewidth=0)
            axis.plot(length, middle, color=GREEN, label="H_macro + H′/√L in use, 68 %")
        length = np.linspace(1.5, 20, 200)
        axis.fill_between(
            length,
            0.7 + 1.95 / np.sqrt(length),
            3.2 + 14.8 / np.sqrt(length),
            color=SOFT,
            alpha=0.13,
            linewidth=0,
        )
        axis.plot(
            *zip(*PAPER_HARDNESS, strict=True),
            "x",
            color=INK,
            markersize=8,
            label="paper, values in its text",
        )
        axis.fill_between([], [], [], color=SOFT, alpha=0.3, label="paper, range of its Table 1")
        axis.set(xlabel="contact length √A (nm)", ylabel="hardness (GPa)", ylim=(0, None), xlim=(1, 20))
        axis.legend(fontsize=8.5)

    return draw("fig8", "Hardness of single asperities against contact length", plot)


def contact_pictures(results: Results) -> str | None:
    """Slices through a contact before, at and after the onset of plastic flow, relaxed without the counterface."""
    points = [
        row
        for row in results.csv("hardness/points.csv")
        if row.get("status") == "yield" and all(results.has(path) for path in _pictures_of(row["run"]))
    ]
    if not points:
        return None
    # the fewest atoms show single bonds best
    point = min(points, key=lambda row: (-number(row["energy_scale"]), number(row["wavelength_nm"])))
    witness, snapshots = (results.csv(path) for path in _pictures_of(point["run"]))
    travel, onset = column(witness, "displacement_nm"), number(point["onset_displacement_nm"])
    chosen = (0, int(np.argmin(np.abs(travel - onset))), len(witness) - 1)
    step, kind, x, y, z = (column(snapshots, name) for name in ("step", "type", "x_nm", "y_nm", "z_nm"))
    thin = np.abs(y - number(point["wavelength_nm"]) / 4) < SLICE_NM
    points_per_nm = 2 * 180 / number(point["wavelength_nm"])  # of a marker's diameter, on a panel 180 points wide

    def plot(*axes):
        for axis, k, title in zip(axes, chosen, ("before contact", "onset", "end"), strict=True):
            at = thin & (step == float(witness[k]["step"]))
            for species, radius_nm, color in ((2.0, 0.11, SKY), (1.0, 0.07, BLUE)):
                part = at & (kind == species)
                axis.scatter(x[part], z[part], s=(radius_nm * points_per_nm) ** 2, color=color, linewidths=0)
            exchanged = int(number(witness[k]["exchanged_bonds"]))
            axis.set_title(f"{title}: {travel[k]:.2f} nm, {exchanged} bonds exchanged", fontsize=9)
            axis.set(xlabel="x (nm)", aspect="equal", ylim=(0, 1.05 * float(z.max())))
            axis.grid(False)
        axes[0].set_ylabel("z (nm)")

    return draw("pictures", f"Slices through the contact of run {point['run']}", plot, (9.4, 3.2), columns=3)


def _pictures_of(run: str) -> tuple[str, str]:
    return f"hardness/witness/{run}.csv", f"hardness/snapshots/{run}.csv"


def elastic_distribution(results: Results) -> str | None:
    """Figure 5: bulk moduli of the ensemble and the resulting E*."""
    rows = results.csv("elastic/bulk_moduli.csv")
    summary = results.json("elastic/e_star.json")
    names = sorted({(row["xc"], row.get("ions", "")) for row in rows})
    samples = results.h5("elastic/e_star.h5")[0] if results.has("elastic/e_star.h5") else {}
    flat = {name: values for group in samples.values() for name, values in group.items()}
    glasses = {*summary.get("structures_used", []), *(kept["structure"] for kept in summary.get("kept_out", []))}
    trusted = [row for row in rows if not row.get("flags") and np.isfinite(number(row.get("B_GPa")))]

    def plot(axis, other):
        every = column(trusted, "B_GPa")
        bins = np.linspace(every.min() - 5, every.max() + 5, 12) if every.size else np.linspace(0, 1, 2)
        for (xc, ions), color in zip(names, cycle(SERIES), strict=False):
            kind = [row for row in trusted if (row["xc"], row.get("ions", "")) == (xc, ions)]
            label = f"{xc.upper()}, {ions} ions" if ions else xc.upper()
            part = column([row for row in kind if row["structure"] in glasses], "B_GPa")
            if part.size:
                axis.hist(part, bins=bins, color=color, alpha=0.5, label=label, linewidth=0)
            for row in kind:
                if row["structure"] not in glasses:
                    crystal = f"{row['structure']} crystal, {xc.upper()}"
                    axis.axvline(number(row["B_GPa"]), color=color, linestyle="--", label=crystal)
        axis.set(xlabel="bulk modulus B (GPa)", ylabel="structures")
        axis.set_ylim(0, 1.7 * axis.get_ylim()[1])  # room for the legend
        axis.yaxis.get_major_locator().set_params(integer=True)
        axis.legend(fontsize=8.5)
        mean, std = number(summary.get("mean_GPa")), number(summary.get("std_GPa"))
        e_star = next((values for name, values in flat.items() if "e_star" in name.lower()), None)
        grid = np.linspace(min(75, mean - 4 * std), max(107, mean + 4 * std), 300)
        if e_star is not None and np.size(e_star) > 50:
            other.hist(np.ravel(e_star), bins=50, density=True, color=BLUE, alpha=0.5, label="here", linewidth=0)
        else:
            other.plot(grid, _normal(grid, mean, std), color=BLUE, label=f"here, {mean:.1f} ± {std:.1f} GPa")
        other.plot(grid, _normal(grid, 91.0, 3.8), "--", color=ORANGE, label="paper, 91 ± 3.8 GPa")
        other.set(xlabel="E* (GPa)", ylabel="density (1/GPa)", ylim=(0, None))
        other.legend(fontsize=8.5)

    return draw("fig5", "Bulk moduli of the structures and the effective modulus", plot, (9.4, 3.7), columns=2)


def energy_volume(results: Results) -> str | None:
    """E(V) of every structure, the data behind figure 5."""
    rows = [row for row in results.csv("elastic/points.csv") if row.get("converged") in ("True", "true", "1")]
    curves: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        curves.setdefault((row["structure"], row["xc"], row.get("ions", "")), []).append(row)
    if not curves:
        return None

    def plot(axis):
        colors = {xc: SERIES[i % len(SERIES)] for i, xc in enumerate(sorted({key[1] for key in curves}))}
        for (_, xc, _), part in curves.items():
            strain, energy = column(part, "strain"), column(part, "energy_eV")
            order = np.argsort(strain)
            axis.plot(
                100 * strain[order],
                energy[order] - energy.min(),
                "o-",
                color=colors[xc],
                markersize=3,
                linewidth=1,
            )
        for xc, color in colors.items():
            axis.plot([], [], "o-", color=color, label=xc.upper())
        axis.set(xlabel="strain (%)", ylabel="energy above lowest point (eV per cell)")
        axis.legend()

    return draw("energy", "Energy against strain of every structure", plot, (5.6, 3.6))


def _scale(point: Row) -> tuple[str, str, str]:
    return SCALES.get(_key(point), ("other energies", PURPLE, "^"))


def _key(point: Row) -> str:
    value = number(point.get("energy_scale", "1"))
    return f"{value:.1f}" if np.isfinite(value) else "1.0"


def _normal(x: np.ndarray, mean: float, std: float) -> np.ndarray:
    return np.exp(-(((x - mean) / std) ** 2) / 2) / (std * np.sqrt(2 * np.pi))
