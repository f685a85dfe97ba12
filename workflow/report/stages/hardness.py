"""Hardness of single asperities: figures 7 and 8."""

from typing import Any

import numpy as np

from workflow.report.available import Results, Row
from workflow.report.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, SKY, SOFT, draw
from workflow.report.numbers import column, number, show
from workflow.report.page import Section, Table

SCALES = {"1.0": ("full energies", BLUE, "o"), "0.5": ("halved energies", ORANGE, "s")}
SLICE_NM = 0.25  # half the thickness of a slice that is drawn
PAPER_HARDNESS = ((3.0, 10.0), (15.0, 2.0))  # nm, GPa: "~10 GPa at 3 nm, ~2 GPa at 15 nm" in the paper's text


def describe(results: Results) -> Section | None:
    """Figures 7 and 8, and every run."""
    if not results.has("hardness/points.csv"):
        return None
    points = results.csv("hardness/points.csv")
    fit = results.json("hardness/fit.json") if results.has("hardness/fit.json") else {}
    section = Section(
        "hardness",
        "Hardness of single asperities",
        "Molecular dynamics of one asperity pressed against a flat, with full and with halved energies; "
        "hardness is the contact stress beyond the onset of plastic flow.",
        results.origin_of("hardness"),
    )
    section.add(
        contact_stress(results),
        "Contact stress against contact length of every closing run. Circles: where plastic flow was first witnessed "
        "by exchanged bonds; diamonds: the hardness of runs that yielded.",
        "Figure 7",
    )
    section.add(
        hardness_size(results),
        "Hardness against contact length. Green: in use, with its 68 % interval; dark green: the part of it that is "
        "scatter between runs."
        + (
            " Grey: the range that the paper's Table 1 spans; crosses: the two values its text gives."
            if results.beside_paper
            else ""
        ),
        "Figure 8",
    )
    section.add(
        contact_pictures(results),
        "A slice of 0.5 nm through a contact, relaxed without the counterface; dark: cations, light: oxygen.",
        wide=True,
    )
    lines = [
        (
            row["run"],
            show(row.get("energy_scale")),
            row.get("geometry", ""),
            show(row.get("wavelength_nm")),
            show(row.get("contact_length_nm")),
            _range(row, "hardness"),
            " → ".join(show(row.get(key)) for key in ("exchanges_before", "exchanges_at_onset", "exchanges_after")),
            show(row.get("onset_p_value")),
            row.get("status", ""),
        )
        for row in points
    ]
    header = (
        "run", "energy scale", "geometry", "λ (nm)", "contact length (nm)", "hardness (GPa)",
        "bond exchanges per 0.1 nm: before → onset → after", "p of the onset", "status",
    )  # fmt: skip
    if len({line[2] for line in lines}) == 1:  # one geometry: its column says nothing
        header, *lines = ((*line[:2], *line[3:]) for line in (header, *lines))
    section.blocks.append(Table("Every run and what became of it", header, lines))
    section.notes += _fit_notes(fit)
    section.files += ["hardness/points.csv", "hardness/fit.json"]
    section.gates += results.gate_of("hardness", "hardness/fit.json")
    return section


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
    """Figure 8: hardness against contact length, with the fit."""
    points = results.csv("hardness/points.csv")
    fit = results.json("hardness/fit.json") if results.has("hardness/fit.json") else {}

    longest = max(float(np.nanmax(column(points, "contact_length_nm"), initial=0.0)), 18.0)  # nm, where H levels off

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
            axis.plot(length, middle, color=GREEN, label="H_macro + H′/√L in use")
            axis.fill_between(length, low, high, color=GREEN, alpha=0.18, linewidth=0, label="its 68 % interval")
            inner = (column(fit["curve"], f"statistical_{end}_GPa") for end in ("low", "high"))
            axis.fill_between(length, *inner, color=GREEN, alpha=0.35, linewidth=0, label="scatter between runs alone")
        if results.beside_paper:
            _draw_paper(axis)
        axis.set(xlabel="contact length √A (nm)", ylabel="hardness (GPa)", ylim=(0, None), xlim=(1, 1.1 * longest))
        axis.legend()

    return draw("fig8", "Hardness of single asperities against contact length", plot)


def _draw_paper(axis) -> None:
    length = np.linspace(1.5, 20, 200)
    low, high = 0.7 + 1.95 / np.sqrt(length), 3.2 + 14.8 / np.sqrt(length)
    axis.fill_between(length, low, high, color=SOFT, alpha=0.13, linewidth=0)
    axis.plot(*zip(*PAPER_HARDNESS, strict=True), "x", color=INK, markersize=8, label="paper, values in its text")
    axis.fill_between([], [], [], color=SOFT, alpha=0.3, label="paper, range of its Table 1")


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


def _scale(point: Row) -> tuple[str, str, str]:
    return SCALES.get(_key(point), ("other energies", PURPLE, "^"))


def _key(point: Row) -> str:
    value = number(point.get("energy_scale", "1"))
    return f"{value:.1f}" if np.isfinite(value) else "1.0"


def _range(row: Row, name: str) -> str:
    value = number(row.get(f"{name}_GPa"))
    if not np.isfinite(value):
        return "–"
    low, high = number(row.get(f"{name}_lo")), number(row.get(f"{name}_hi"))
    return f"{show(value)} [{show(low)}, {show(high)}]" if np.isfinite(low) else show(value)


SOURCES = {
    "seed": "glass and place of the cut", "run": "within a run", "energies": "full or halved energies",
    "size": "size of the asperity", "area": "contact area", "rate": "closing speed", "base": "thickness of the base",
    "potential": "potential", "shape": "steepness of the asperity", "h_macro": "H_macro",
}  # fmt: skip


def _budget_note(budget: dict[str, Any], kind: str) -> str:
    """The standard deviation of H′ of one kind, and its sources, the largest first."""
    part = budget[kind]
    largest_first = sorted(part["sources"].items(), key=lambda item: -item[1])
    sources = ", ".join(f"{SOURCES.get(name, name)} {show(value)}" for name, value in largest_first)
    return (
        f"Interval of H′, {kind} part: standard deviation {show(part['std'])} GPa nm½, "
        f"{show(100 * part['share'])} % of the variance ({sources})."
    )


def _fit_notes(fit: dict[str, Any]) -> list[str]:
    """What the MD points say about both constants, and how the halved energies compare."""
    notes = []
    method = "from the literature" if fit.get("method") == "literature" else "from the same points"
    for key, label, unit in (("H_macro_GPa", "H_macro", "GPa"), ("H_prime_GPa_nm0.5", "H′", "GPa nm½")):
        entry = fit.get(key)
        if isinstance(entry, dict):
            origin = method if label == "H_macro" else "from the points"
            span = f"{show(entry['median'])} [{show(entry['low'])}, {show(entry['high'])}] {unit}"
            notes.append(f"{label} in use, {origin}: {span} (median and 68 % interval).")
    free = fit.get("free_fit", {}).get("together", {})
    if "H_macro_GPa" in free:
        pairs = [
            f"{label} = {show(free[key]['median'])} [{show(free[key]['low'])}, {show(free[key]['high'])}]"
            for key, label in (("H_macro_GPa", "H_macro"), ("H_prime_GPa_nm0.5", "H′"))
        ]
        word = "" if free.get("identifiable") else ": the points alone do not identify both"
        notes.append(f"Free fit of both constants to all points: {', '.join(pairs)}{word}.")
    if cutoff := fit.get("inputs", {}).get("gap_cutoff"):
        low, high = show(cutoff["a"]), show(cutoff["b"])
        notes.append(
            f"The tops of {len(fit['tops'])} runs attract a smooth body like a flat with the cut-off D₀ of {low} nm "
            f"(by work) to {high} nm (by force)."
        )
    if budget := fit.get("budget"):
        notes += [_budget_note(budget, kind) for kind in ("statistical", "systematic")]
    for scale, change in fit.get("size_effect_at_one_shape", {}).items():
        words, _, _ = _scale({"energy_scale": scale.removeprefix("scale_")})
        notes.append(
            f"Between the runs with {words}, each where its contact is 0.5 to 0.6 wavelengths wide "
            f"({show(change['length_min_nm'])} to {show(change['length_max_nm'])} nm), hardness goes as length to the "
            f"power {show(-change['mean'])} [{show(-change['high'])}, {show(-change['low'])}] ({change['runs']} runs); "
            "0 is no size effect; the law in use, H_macro + H′/√L, goes as a power between −0.5 and 0."
        )
    for ratio in fit.get("halved_over_full", []):
        notes.append(
            f"Halved over full energies, asperity {ratio['asperity']}: {show(ratio['median'])} "
            f"[{show(ratio['low'])}, {show(ratio['high'])}]; 0.5 is expected."
        )
    if cost := fit.get("cost"):
        notes.append(
            f"Molecular dynamics: {show(cost['atom_steps'])} atom-steps, {show(cost['lammps_cpu_s'] / 60)} minutes of "
            f"CPU time; the Python around LAMMPS took {show(100 * cost['python_cpu_share'])} % of all."
        )
    return notes
