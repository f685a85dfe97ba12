"""Hardness of single asperities: figures 7 and 8."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from workflow.report.available import CsvRow, Results
from workflow.report.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, SOFT, draw
from workflow.report.numbers import cell, column, number, show, spread
from workflow.report.page import Block, CellText, Figure, stage, table

PAPER_VALUES = ((3.0, 10.0), (15.0, 2.0))
"""Contact length (nm) and hardness (GPa) in the text of Kim et al. (2013)."""
TABLE_1 = {"H_macro_GPa": (0.7, 3.2), "H_prime_GPa_nm0.5": (1.95, 14.8)}
"""Ranges of both constants of eq. 4 in Table 1 of Kim et al. (2013)."""
SCALES = {"1.0": ("full energies", BLUE, "o"), "0.5": ("halved energies", ORANGE, "s")}


@stage("Hardness of single asperities", "hardness/points.csv", also=("hardness/fit.json",))
def describe(results: Results) -> Iterator[Block]:
    """Figures 7 and 8, and every run."""
    points = results.csv("hardness/points.csv")
    fit = results.content("hardness/fit.json")
    yield (
        "Molecular dynamics of one asperity pressed against a flat; hardness is the contact stress"
        " beyond the onset of plastic flow."
    )
    yield Figure(
        contact_stress(results),
        "Contact stress against contact length of every closing run. Circles: where plastic flow"
        " was first witnessed by exchanged bonds; diamonds: the hardness of runs that yielded.",
        "Figure 7",
    )
    captions = [
        "Hardness against contact length, with full and with halved energies where both were run."
    ]
    if _as_paper(results):
        captions.append(" Grey: Table 1 of the paper; crosses: the values in its text.")
    if fit.get("curve"):
        captions.append(f" Green: eq. 4{_use_of_eq_4(results)}, with its 68 % interval.")
    yield Figure(
        hardness_size(results),
        "".join(captions),
        "Figure 8",
    )
    columns: dict[str, CellText] = {
        "run": "run",
        "energy scale": cell("energy_scale"),
        "film (nm)": cell("film_nm"),
        "λ (nm)": cell("wavelength_nm"),
        "contact length (nm)": cell("contact_length_nm"),
        "hardness (GPa)": lambda row: spread(row, "hardness_GPa", "hardness_lo", "hardness_hi"),
        "bond exchanges per 0.1 nm: before → onset → after": lambda row: " → ".join(
            show(row.get(f"exchanges_{when}")) for when in ("before", "at_onset", "after")
        ),
        "p of the onset": cell("onset_p_value"),
        "status": "status",
    }
    # no film, or one thickness: the column says nothing
    if len({row.get("film_nm") for row in points}) == 1:
        del columns["film (nm)"]
    yield table("Every run and what became of it", points, columns)
    yield from _fit_notes(fit)


def _as_paper(results: Results) -> bool:
    """Whether the figure has the paper's values: in scene `paper`, and where energies enter as in
    the paper.
    """
    fit = results.content("hardness/fit.json")
    return results.beside_paper or fit.get("energies_from") == "scales"


def _twin_notes(fit: dict[str, Any]) -> Iterator[str]:
    """What scaled energies do to the hardness, and the hardness by both ways to bound the
    energies.
    """
    for row in fit.get("twins", ()):
        ratio = row["ratio"]
        yield (
            f"With energies × {show(row['energy_scale'])} the hardness is {show(ratio['median'])}"
            f" [{show(ratio['low'])}, {show(ratio['high'])}] of that with full ones. The pairs of"
            f" runs are {row['pairs']}; the 68 % interval is from the 11 % by which runs of one"
            " kind scatter."
        )
    for rule, words in (("measured", "bounded by indentation"), ("scales", "as run, both alike")):
        if quantiles := fit.get("hardness_GPa", {}).get(rule):
            span = (
                f"{show(quantiles['median'])} [{show(quantiles['low'])},"
                f" {show(quantiles['high'])}] GPa"
            )
            yield f"Hardness with the energies {words}: {span} (median and 68 % interval)."


def _use_of_eq_4(results: Results) -> str:
    """Whether the scene takes eq. 4, in words."""
    if not results.has("inputs.csv"):
        return ""
    names = {row["parameter"] for row in results.csv("inputs.csv")}
    if "h_prime" in names:
        return ", in use"
    return ", which this scene does not take"


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
            length = column(rows, "contact_length_nm")
            stress = column(rows, "contact_stress_GPa")
            run = name.rpartition("/")[2].removesuffix(".csv")
            point = points.get(run, {})
            _, color, _ = _scale(point)
            use = np.isfinite(length) & np.isfinite(stress) & (length > 0.8)
            if not use.any():
                continue
            axis.plot(length[use], stress[use], color=color, linewidth=0.8, alpha=0.7)
            highest = max(highest, float(np.quantile(stress[use], 0.98)))
            contact_nm = number(point.get("contact_length_nm"))
            hardness = number(point.get("hardness_GPa"))
            if point.get("status") == "yield" and np.isfinite(contact_nm):
                axis.plot(contact_nm, hardness, "D", color=color, markeredgecolor=INK, markersize=6)
                onset = number(point.get("onset_length_nm"))
                if np.isfinite(onset):
                    then = np.argmin(np.abs(length[use] - onset))
                    axis.plot(
                        length[use][then],
                        stress[use][then],
                        "o",
                        color=color,
                        markerfacecolor="none",
                        markersize=6,
                    )
        for label, color, _ in dict.fromkeys(map(_scale, points.values())):
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
    fit = results.content("hardness/fit.json")

    # nm, where H levels off
    longest = max(float(np.nanmax(column(points, "contact_length_nm"), initial=0.0)), 18.0)

    def plot(axis):
        for key, (label, color, marker) in SCALES.items():
            of_key = [row for row in points if _key(row) == key and row.get("status") == "yield"]
            if of_key:
                length = column(of_key, "contact_length_nm")
                hardness = column(of_key, "hardness_GPa")
                low = column(of_key, "hardness_lo")
                high = column(of_key, "hardness_hi")
                bars = np.nan_to_num(np.clip([hardness - low, high - hardness], 0, None))
                face = color if key == "1.0" else "none"
                axis.errorbar(
                    length,
                    hardness,
                    yerr=bars,
                    fmt=marker,
                    color=color,
                    markerfacecolor=face,
                    label=label,
                    capsize=3,
                )
        if fit.get("curve"):
            length, low, high, middle = (
                np.array([point[key] for point in fit["curve"]], dtype=float)
                for key in ("contact_length_nm", "low_GPa", "high_GPa", "median_GPa")
            )
            axis.plot(length, middle, color=GREEN, label="H_macro + H′/√L (eq. 4)")
            axis.fill_between(
                length, low, high, color=GREEN, alpha=0.18, linewidth=0, label="its 68 % interval"
            )
        if _as_paper(results):
            lengths = np.geomspace(1.0, longest, 60)
            smallest, largest = (
                macro + prime / np.sqrt(lengths)
                for macro, prime in zip(
                    TABLE_1["H_macro_GPa"], TABLE_1["H_prime_GPa_nm0.5"], strict=True
                )
            )
            axis.fill_between(
                lengths, smallest, largest, color=SOFT, alpha=0.15, linewidth=0, label="Table 1"
            )
            axis.plot(*zip(*PAPER_VALUES, strict=True), "x", color=INK, label="paper, in its text")
        axis.set(
            xlabel="contact length √A (nm)",
            ylabel="hardness (GPa)",
            ylim=(0, None),
            xlim=(1, 1.1 * longest),
        )
        axis.legend()

    return draw("fig8", "Hardness of single asperities against contact length", plot)


def _scale(point: CsvRow) -> tuple[str, str, str]:
    return SCALES.get(_key(point), ("other energies", PURPLE, "^"))


def _key(point: CsvRow) -> str:
    scale = number(point.get("energy_scale", "1"))
    if not np.isfinite(scale):
        return "1.0"
    return f"{scale:.1f}"


def _fit_notes(fit: dict[str, Any]) -> list[str]:
    """Both constants in use, what the energies do, and the attraction of the tops."""
    notes = [*_twin_notes(fit)]
    for key, label, unit, origin in (
        ("H_macro_GPa", "H_macro", "GPa", "from the literature"),
        ("H_prime_GPa_nm0.5", "H′", "GPa nm½", "from the points"),
    ):
        if isinstance(entry := fit.get(key), dict):
            span = f"{show(entry['median'])} [{show(entry['low'])}, {show(entry['high'])}] {unit}"
            notes.append(f"{label} in use, {origin}: {span} (median and 68 % interval).")
    if free := fit.get("free_fit"):
        macro, prime = (
            f"{show(free[key]['mean'])} [{show(free[key]['low'])}, {show(free[key]['high'])}]"
            for key in TABLE_1
        )
        notes.append(
            f"Both constants fitted freely: H_macro {macro} GPa, H′ {prime} GPa nm½ (mean and 68 %"
            f" interval). {free['verdict'][0].upper()}{free['verdict'][1:]}."
        )
    if film := fit.get("film"):
        base, (low, high) = film["base_GPa"], film["length_over_thickness"]
        errors = {name: f"{100 * error:.0f} %" for name, error in film["left_out"].items()}
        notes.append(
            f"At a film thickness that its fit had not, the law film errs by {errors['film']}, eq."
            f" 4 by {errors['paper']}, a constant by {errors['constant']}."
        )
        notes.append(
            f"The body below as pressed has {show(base['median'])} [{show(base['low'])},"
            f" {show(base['high'])}] GPa. Runs have L/t from {show(low)} to {show(high)}; wider"
            " contacts extrapolate the law."
        )
    if cutoff := fit.get("inputs", {}).get("gap_cutoff"):
        low, high = np.quantile(cutoff["values"], [0.05, 0.95]).tolist()
        notes.append(
            f"The tops of {len(fit['tops'])} runs attract a smooth body with the work of a flat of"
            f" cut-off D₀, {show(low)} to {show(high)} nm (90 % interval). Their largest force is"
            f" that of {show(float(np.mean(column(fit['tops'], 'by_force_nm'))))} nm, which no"
            " contact of several tops feels."
        )
    return notes
