"""`python -m workflow.schemas` writes docs/results.md."""

from pathlib import Path

from workflow.schemas import STAGES
from workflow.schemas.table import Column, Table

PAGE = Path(__file__).parents[2] / "docs" / "results.md"
INTRODUCTION = """# Result files

<!-- made by `python -m workflow.schemas`; edit the tables in workflow/schemas/ instead -->

Every CSV file of `results/SCENE/` with its columns. A star in a file's name stands for a run, a
scan or a chunk; in a column's name it stands for what tells its columns apart. A number that is not
determined is `nan`, or empty where the table says so. `unit` as a unit: that of the row's own
column `unit`. A file that does not fit its table is refused.
"""


def page() -> str:
    """The page, one table per kind of file."""
    sections = [INTRODUCTION]
    for stage, tables in STAGES.items():
        sections.append(f"\n## {stage}\n")
        sections += [_section(table) for table in tables]
    return "".join(sections)


def _section(table: Table) -> str:
    first, *further = table.paths
    also = f" The same: {', '.join(f'`{path}`' for path in further)}." if further else ""
    lines = [
        "| column | type | unit | meaning |",
        "| --- | --- | --- | --- |",
        *map(_line, table.columns),
    ]
    return f"\n### `{first}`\n\n{table.row}{also}\n\n" + "\n".join(lines) + "\n"


def _line(column: Column) -> str:
    kind = column.type + " or empty" * column.empty + ", not always there" * column.optional
    return f"| `{column.name}` | {kind} | {column.unit} | {column.meaning} |"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
