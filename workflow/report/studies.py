"""Error against run time and stability of all stages, with the settings that they recommend."""

from collections.abc import Iterator

import numpy as np

from workflow.report.available import CsvRow, Results
from workflow.report.numbers import column, number, show
from workflow.report.page import Block, PageTable, Section, section

GOOD_ENOUGH = 0.01  # an error below this is not worth more time
NEAR_BEST = 2.0  # nor is one within this factor of the best


def studies(results: Results) -> list[Section]:
    """The sections of the studies that exist."""
    sections = []
    for folder, key, build in (("accuracy", "knob", _accuracy), ("stability", "passed", _stability)):
        # a stage may keep tables of another kind beside them, which its own section shows
        names = [name for name in results.matching(f"{folder}/", ".csv") if key in (results.csv(name) or [{}])[0]]
        if names:
            tables = {name.removeprefix(f"{folder}/").removesuffix(".csv"): results.csv(name) for name in names}
            title, lead, *blocks = build(tables)
            sections.append(section(folder, str(title), str(lead), blocks, names))
    return sections


def _accuracy(tables: dict[str, list[CsvRow]]) -> Iterator[Block]:
    yield "Error against run time"
    yield (
        "What each numerical choice costs and buys. Recommended is the cheapest value whose largest error over all "
        f"outputs is below {GOOD_ENOUGH:.0%} or within a factor {NEAR_BEST:g} of the best one tried."
    )
    names = ("stage", "setting", "recommended", "its largest error", "its time (s)", "best error tried")
    lines = [line for stage, rows in tables.items() for line in recommended(stage, rows)]
    yield PageTable("Recommended settings", (*names, "at (s)", "against"), lines, heads=2)


def _stability(tables: dict[str, list[CsvRow]]) -> Iterator[Block]:
    failed = [f"{stage}: {row['case']}" for stage, rows in tables.items() for row in rows if not _passed(row)]
    total = sum(map(len, tables.values()))
    yield "Stability"
    yield f"Unusual inputs and what the code does with them: {total - len(failed)} of {total} cases passed."
    if failed:
        yield "Not passed: " + "; ".join(failed) + "."


def curves(rows: list[CsvRow]) -> dict[tuple[str, str], list[tuple[str, float, float]]]:
    """By knob and reference: value, largest error over the cases, and time (s), cheapest first."""
    groups: dict[tuple[str, str], dict[str, list[CsvRow]]] = {}
    for row in rows:
        knob = groups.setdefault((row["knob"], row.get("reference", "")), {})
        knob.setdefault(row["value"], []).append(row)
    knobs = {}
    for key, values in groups.items():
        points = []
        for value, part in values.items():
            errors = column(part, "error")
            if np.isfinite(errors).any():
                points.append((value, float(np.nanmax(errors)), float(np.nanmean(column(part, "wall_s")))))
        if points:
            knobs[key] = sorted(points, key=lambda point: point[2])
    return knobs


def recommended(stage: str, rows: list[CsvRow]) -> list[tuple[str, ...]]:
    """One line per knob that was tried at more than one value."""
    lines = []
    for (knob, reference), points in curves(rows).items():
        if len(points) < 2:
            continue
        best = min(points, key=lambda point: point[1])
        limit = max(GOOD_ENOUGH, NEAR_BEST * best[1])
        value, error, seconds = next(point for point in points if point[1] <= limit)
        numbers = (show(error, 2), show(seconds, 2), show(best[1], 2), show(best[2], 2))
        lines.append((stage, knob, _cell(value), *numbers, reference))
    return lines


def _passed(row: CsvRow) -> bool:
    return row.get("passed", "") in ("True", "1", "true")


def _cell(text: str) -> str:
    """A number shortened, whole numbers and words as they are."""
    value = number(text)
    return show(value) if np.isfinite(value) and not value.is_integer() else text.removesuffix(".0")
