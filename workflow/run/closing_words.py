"""What a run with measurements says before its answer: what was read, what describes it, and what to doubt."""

from collections.abc import Iterator
from pathlib import Path

from mesoscale.topography.summary import doubt_lines, measurement_lines
from workflow.files.results import load_csv, load_json


def closing_words(results: Path) -> Iterator[str]:
    """Lines about the surface of a scene: a table, the description, the judgement of the scans, then the doubts."""
    content = load_json(results / "topography/parameters.json")
    yield ""
    yield from measurement_lines(content)
    description = content["description"]
    chosen = "set by the scene" if description["overridden"] else "chosen by evidence"
    yield f"described by {description['name']} ({chosen}): {description['meaning']}"
    picture = results / "topography/surface.png"
    if picture.is_file():
        yield f"a picture is in {picture}"
    if (results / "topography/judged.csv").is_file():
        yield from judgement(load_csv(results / "topography/judged.csv"))
    yield from doubt_lines(content)


def judgement(rows: list[dict[str, str]]) -> Iterator[str]:
    """In words whether pressing the scans agrees with their description; a doubt where it does not."""
    if not rows:
        yield "no scan could be pressed (none is areal with square pixels)"
        return
    inside = sum(row["inside"] == "True" for row in rows)
    way = "made without it" if rows[0]["left_out"] == "True" else "made from it"
    contact = [row for row in rows if row["quantity"] == "first_contact"]
    outside = [row for row in contact if row["inside"] != "True"]
    summary = f"pressing each scan agrees with its description ({way}) in {inside} of {len(rows)} numbers"
    if not outside:
        yield f"{summary}, in all {len(contact)} first contacts"
        return
    row = outside[0]
    yield (
        f"DOUBT (pressing_disagrees, about contact): {summary}; {row['scan']} touches first at "
        f"{float(row['pressed']):.3g} nm, its description says {float(row['low']):.3g} to {float(row['high']):.3g} nm; "
        "measure more places"
    )
