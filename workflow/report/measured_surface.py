"""What describes the measured surface: the evidence, the doubts, the spectrum over all scales, the scans as judges."""

from collections.abc import Mapping
from typing import Any

from workflow.report.available import Results
from workflow.report.drawing import draw
from workflow.report.numbers import show, shown_unit
from workflow.report.page import Doubt, Section, Table
from workflow.report.surface_picture import draw_one_spectrum, short_names

JUDGED = "topography/judged.csv"
QUANTITIES = {
    "rms": "RMS (nm)",
    "first_contact": "first contact (nm)",
    "separation_1uN": "separation at 1 µN on a cell (nm)",
    "separation_7uN": "separation at 7 µN on a cell (nm)",
    "area_7uN": "area at 7 µN (nm²)",
}


def describe_surface(results: Results, parameters: Mapping[str, Any], section: Section) -> None:
    """Add the description of the surface, its evidence and its judgement to the section on topography."""
    description = parameters.get("description")
    if not description:
        return
    section.lead += f" Random surfaces follow {description['meaning']}" + (
        " (set by the scene)." if description["overridden"] else " (chosen by the tests below)."
    )
    rows = [(row["test"], row["outcome"], "yes" if row["passed"] else "no") for row in description["evidence"]]
    section.blocks.append(Table("Which description of the surface", ("question", "answer", "passed"), rows))
    place_doubts(parameters, section, "heights")
    if parameters.get("synthetic"):
        place_doubts(parameters, section, "rms", "spectrum", "contact")
        return
    section.add(
        _one_spectrum(results, parameters),
        "One spectrum over all scales from all measurements, with its band. Grey is what levelling, tip, noise or "
        "pixels disturb; line profiles are converted to the spectrum of an isotropic surface.",
    )
    place_doubts(parameters, section, "spectrum")
    _statistics(parameters, section)
    place_doubts(parameters, section, "rms")
    if results.has(JUDGED):
        _judgement(results, section)
    place_doubts(parameters, section, "contact")


def place_doubts(parameters: Mapping[str, Any], section: Section, *about: str) -> None:
    """Put the doubts about some quantities behind what the section has by now."""
    for doubt in parameters.get("doubts", []):
        if doubt["about"] in about:
            remedy = f" To do: {doubt['remedy']}." if doubt["remedy"] else ""
            section.blocks.append(Doubt(f"Doubt about {doubt['about']} ({doubt['code']}): {doubt['text']}.{remedy}"))


def _one_spectrum(results: Results, parameters: Mapping[str, Any]) -> str | None:
    groups, _, attributes = results.h5("topography/spectra.h5")
    if "one_spectrum" not in groups:
        return None

    def plot(axis: Any) -> None:
        draw_one_spectrum(axis, groups, attributes, parameters)

    return draw("one_spectrum", "Spectrum over all scales", plot, (5.6, 4.4))


def _statistics(parameters: Mapping[str, Any], section: Section) -> None:
    one = parameters.get("one_spectrum")
    if not one:
        return
    header = ("what", "unit", "value", f"{float(parameters['confidence']):.0%} interval")
    names = {"rms_height": "RMS height", "rms_slope": "RMS slope", "rms_curvature": "RMS curvature"}
    rows = [
        (
            text,
            shown_unit(one[key]["unit"]) or "–",
            show(one[key]["value"]),
            " to ".join(show(end) for end in one[key]["interval"]),
        )
        for key, text in names.items()
    ]
    ends = f"{show(one['from_q'])} to {show(one['to_q'])} /nm"
    section.blocks.append(Table(f"The measured surface, all waves from {ends}", header, rows))
    if not one["overlaps"] and len(one["measurements"]) > 1:
        section.notes.append("No two measurements see common waves: none can be checked by another.")
    if one["overlaps"]:
        short = short_names(one["measurements"])
        header = ("measurements", "shared q (1/nm)", "ratio of C", "expected within", "agree")
        rows = [
            (
                f"{short[pair['first']]}, {short[pair['second']]}",
                f"{show(pair['from_q'])} to {show(pair['to_q'])}",
                show(pair["ratio"]),
                f"a factor of {show(pair['expected_within'])}",
                "yes" if pair["agrees"] else "no",
            )
            for pair in one["overlaps"][:12]
        ]
        section.blocks.append(Table("Where measurements overlap", header, rows))


def _judgement(results: Results, section: Section) -> None:
    rows = results.csv(JUDGED)
    if not rows:
        return
    short = short_names(list(dict.fromkeys(row["scan"] for row in rows)))
    lines = [
        (
            short[row["scan"]],
            QUANTITIES.get(row["quantity"], row["quantity"]),
            show(float(row["pressed"])),
            f"{show(float(row['low']))} to {show(float(row['high']))}",
            "yes" if row["inside"] == "True" else "no",
            "without it" if row["left_out"] == "True" else "from it",
        )
        for row in rows
    ]
    header = ("scan", "quantity", "pressed", "description, 90 % interval", "inside", "description made")
    section.blocks.append(
        Table(
            "The scans pressed (their largest square, made periodic), beside surfaces made from their description",
            header,
            lines,
        )
    )
    section.files.append(JUDGED)
