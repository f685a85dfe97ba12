"""What a run with measurements says before its answer: what was read, what describes it, and what
to doubt.
"""

from collections.abc import Iterator
from pathlib import Path

from mesoscale.scan_checks.judged import disagreeing, testable
from mesoscale.topography.summary import doubt_lines, measurement_lines
from workflow.files.results import load_csv, load_json


def closing_words(results: Path) -> Iterator[str]:
    """Lines about the surface of a scene: a table, the description, the judgement of the scans,
    then the doubts.
    """
    content = load_json(results / "topography/parameters.json")
    yield ""
    yield from measurement_lines(content)
    description = content["description"]
    chosen = "set by the scene" if description["overridden"] else "chosen by evidence"
    yield f"described by {description['name']} ({chosen}): {description['meaning']}"
    if (results / "topography/judged.csv").is_file():
        yield from judgement(load_csv(results / "topography/judged.csv"))
    yield from doubt_lines(content)


def judgement(rows: list[dict[str, str]]) -> Iterator[str]:
    """In words whether pressing the scans agrees with their description; a doubt where it does
    not.
    """
    if not rows:
        yield "no scan could be pressed (none is areal with square pixels)"
        return
    inside = sum(row["inside"] == "True" for row in rows)
    origin = "made without it" if testable(rows) else "made from it"
    summary = (
        f"pressing each scan agrees with its description ({origin}) in {inside} of {len(rows)}"
        " numbers"
    )
    if worst := disagreeing(rows):
        yield (
            f"DOUBT (pressing_disagrees, about contact): {summary}; {worst[0]['scan']} touches"
            f" first at {float(worst[0]['pressed']):.3g} nm, its description says"
            f" {float(worst[0]['low']):.3g} to {float(worst[0]['high']):.3g} nm; measure more"
            " places"
        )
    elif testable(rows):
        yield f"{summary}; first contacts differ by no more than chance"
    else:
        yield (
            "pressing the scan is not testable: its description is made from this scan alone;"
            " measure more places"
        )
