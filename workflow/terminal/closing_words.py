"""What a run with measurements says at its very end: what was read, what describes it, and what to doubt."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from workflow.results import load_csv, load_json

HEADS = ("measurement", "size (nm)", "points", "RMS (nm)", "trusted q (1/nm)", "ends by")


def closing_words(results: Path) -> Iterator[str]:
    """Lines about the surface of a scene: a table, the description, the judgement of the scans, then the doubts."""
    content = load_json(results / "topography/parameters.json")
    yield ""
    yield from _table([HEADS, *(_cells(row) for row in content["scans"])])
    description = content["description"]
    chosen = "set by the scene" if description["overridden"] else "chosen by evidence"
    yield f"described by {description['name']} ({chosen}): {description['meaning']}"
    picture = results / "topography/surface.png"
    if picture.is_file():
        yield f"a picture is in {picture}"
    if (results / "topography/judged.csv").is_file():
        yield from judgement(load_csv(results / "topography/judged.csv"))
    if (results / "topography/unseen.csv").is_file():
        yield from unseen(load_csv(results / "topography/unseen.csv"))
    for doubt in content["doubts"]:
        remedy = f"; {doubt['remedy']}" if doubt["remedy"] else ""
        yield f"DOUBT ({doubt['code']}, about {doubt['about']}): {doubt['text']}{remedy}"


def unseen(rows: list[dict[str, str]]) -> Iterator[str]:
    """In words what waves that no instrument saw do to the contact."""
    ends = dict.fromkeys((row["seen_q"], row["end_q"]) for row in rows if row["share"])
    for seen, end in ends:
        known = [row for row in rows if row["share"] and row["end_q"] == end]
        parts = (f"{row['quantity']} {float(row['shift']):+.0%} ({float(row['share']):.0%})" for row in known)
        waves = f"{float(seen):.2g} to {float(end):.2g} /nm"
        yield f"unseen waves of {waves} would change (share of the variance): {', '.join(parts)}"


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


def _cells(row: dict[str, Any]) -> tuple[str, ...]:
    ends = f"{row['trusted_low']:.2g} to {row['trusted_high']:.2g}"
    return row["name"], f"{row['length_nm']:.4g}", row["pixels"], f"{row['rms_heights_nm']:.3g}", ends, row["limit"]


def _table(rows: list[tuple[str, ...]]) -> Iterator[str]:
    widths = [max(len(row[k]) for row in rows) for k in range(len(HEADS))]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
