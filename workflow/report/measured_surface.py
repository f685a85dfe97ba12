"""What describes the measured surface: the evidence, the doubts, the spectrum over all scales, the
scans as judges.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import takewhile
from typing import Any

from workflow.report.available import CsvRow, Results
from workflow.report.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, SKY, SOFT, draw
from workflow.report.numbers import cell, show, shown_unit, yes_or_no
from workflow.report.page import Block, DoubtNote, Figure, PageTable, table

JUDGED = "topography/judged.csv"
QUANTITIES = {
    "rms": "RMS (nm)",
    "first_contact": "first contact (nm)",
    "separation_1uN": "separation at 1 µN on a cell (nm)",
    "separation_7uN": "separation at 7 µN on a cell (nm)",
    "area_7uN": "area at 7 µN (nm²)",
}


def chosen_description(parameters: Mapping[str, Any]) -> str:
    """What random surfaces follow, as a further sentence of the lead; empty without a
    description.
    """
    description = parameters.get("description")
    if not description:
        return ""
    how = "set by the scene" if description["overridden"] else "chosen by the tests below"
    return f" Random surfaces follow {description['meaning']} ({how})."


def described_surface(results: Results, parameters: Mapping[str, Any]) -> Iterator[Block]:
    """The description of the surface, its evidence and its judgement."""
    description = parameters.get("description")
    if not description:
        return
    columns = {
        "question": "test",
        "answer": "outcome",
        "passed": lambda row: yes_or_no(row["passed"]),
    }
    yield table("Which description of the surface", description["evidence"], columns)
    yield from doubts(parameters, "heights")
    if parameters.get("synthetic"):
        yield from doubts(parameters, "rms", "spectrum", "contact")
        return
    yield Figure(
        _one_spectrum(results, parameters),
        "One spectrum over all scales from all measurements, with its band. Grey is what levelling,"
        " tip, noise or pixels disturb; line profiles are converted to the spectrum of an isotropic"
        " surface.",
    )
    yield from doubts(parameters, "spectrum")
    if parameters.get("one_spectrum"):
        yield from _statistics(parameters)
    yield from doubts(parameters, "rms")
    if results.has(JUDGED) and results.csv(JUDGED):
        yield _judgement(results.csv(JUDGED))
    yield from doubts(parameters, "contact")


def doubts(parameters: Mapping[str, Any], *about: str) -> Iterator[DoubtNote]:
    """The doubts about some quantities, to stand behind their numbers."""
    for doubt in parameters.get("doubts", []):
        if doubt["about"] in about:
            note = f"Doubt about {doubt['about']} ({doubt['code']}): {doubt['text']}."
            if doubt["remedy"]:
                note += f" To do: {doubt['remedy']}."
            yield DoubtNote(note)


def short_names(names: Sequence[str]) -> dict[str, str]:
    """Names of measurements without what all of them begin with."""
    words = [name.split("_") for name in names]
    alike = sum(
        1 for _ in takewhile(lambda column: len(set(column)) == 1, zip(*words, strict=False))
    )
    cut = 0
    if len(names) > 1:
        cut = min(alike, *(len(split) - 1 for split in words))
    return {name: "_".join(split[cut:]) for name, split in zip(names, words, strict=True)}


def _one_spectrum(results: Results, parameters: Mapping[str, Any]) -> str | None:
    """All spectra with their trusted parts, and the one over all scales with its band."""
    groups, _, attributes = results.h5("topography/spectra.h5")
    if "one_spectrum" not in groups:
        return None
    names = sorted(name for name in groups if name.startswith("scans/"))
    short = short_names([name.removeprefix("scans/") for name in names])
    apart = (BLUE, GREEN, PURPLE, SKY)
    several = 1 < len(names) <= len(apart)

    def plot(axis: Any) -> None:
        for name, color in zip(names, apart if several else [SKY] * len(names), strict=False):
            q = groups[name]["q"]
            psd = groups[name]["psd"]
            low = float(attributes[name]["trusted_low"])
            high = float(attributes[name]["trusted_high"])
            trusted = (q >= low) & (q <= high)
            label = f"{short[name.removeprefix('scans/')]}, trusted range" if several else None
            axis.loglog(q, psd, color=SOFT, linewidth=0.6, alpha=0.7, zorder=1)
            axis.loglog(q[trusted], psd[trusted], color=color, linewidth=1.6, zorder=4, label=label)
        if not several:
            axis.plot([], [], color=SKY, label="measurements, trusted range")
        axis.plot([], [], color=SOFT, label="limited by levelling, tip, noise or pixels")
        common = groups["one_spectrum"]
        level = f"{float(parameters['confidence']):.0%}"
        axis.fill_between(
            common["q"],
            common["band_low"],
            common["band_high"],
            color=ORANGE,
            alpha=0.25,
            linewidth=0,
        )
        axis.loglog(
            common["q"], common["psd"], color=ORANGE, label=f"one spectrum, {level} band", zorder=3
        )
        end = parameters["trusted_end"]
        axis.axvline(
            end["value"],
            color=INK,
            linewidth=0.8,
            linestyle="--",
            label=f"trusted end ({end['limit']})",
        )
        axis.set(xlabel="wave vector q (1/nm)", ylabel="PSD (nm⁴)")
        axis.legend(fontsize=8)

    return draw("one_spectrum", "Spectrum over all scales", plot, (5.6, 4.4))


def _statistics(parameters: Mapping[str, Any]) -> Iterator[Block]:
    common = parameters["one_spectrum"]
    names = {"rms_height": "RMS height", "rms_slope": "RMS slope", "rms_curvature": "RMS curvature"}
    yield table(
        f"The measured surface, all waves from {show(common['from_q'])} to"
        f" {show(common['to_q'])} /nm",
        [{"what": text, **common[key]} for key, text in names.items()],
        {
            "what": "what",
            "unit": lambda row: shown_unit(row["unit"]),
            "value": cell("value"),
            f"{float(parameters['confidence']):.0%} interval": lambda row: " to ".join(
                map(show, row["interval"])
            ),
        },
    )
    if not common["overlaps"] and len(common["measurements"]) > 1:
        yield "No two measurements see common waves: none can be checked by another."
    if common["overlaps"]:
        short = short_names(common["measurements"])
        yield table(
            "Where measurements overlap",
            common["overlaps"][:12],
            {
                "measurements": lambda row: f"{short[row['first']]}, {short[row['second']]}",
                "shared q (1/nm)": lambda row: f"{show(row['from_q'])} to {show(row['to_q'])}",
                "ratio of C": cell("ratio"),
                "expected within": lambda row: f"a factor of {show(row['expected_within'])}",
                "agree": lambda row: yes_or_no(row["agrees"]),
            },
        )


def _judgement(rows: Sequence[CsvRow]) -> PageTable:
    short = short_names(list(dict.fromkeys(row["scan"] for row in rows)))
    made = {"True": "without it", "False": "from it"}
    return table(
        "The scans pressed (their largest square, made periodic), beside surfaces made from their"
        " description",
        rows,
        {
            "scan": lambda row: short[row["scan"]],
            "quantity": lambda row: QUANTITIES.get(row["quantity"], row["quantity"]),
            "pressed": cell("pressed"),
            "description, 90 % interval": lambda row: f"{show(row['low'])} to {show(row['high'])}",
            "inside": lambda row: yes_or_no(row["inside"]),
            "description made": lambda row: made[row["left_out"]],
        },
    )
