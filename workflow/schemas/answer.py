"""Table of what moves the release."""

from workflow.schemas.table import Table, boolean, number, text

TABLES = (
    Table(
        ("answer/budget.csv",),
        "One effect on the release of the switch at central inputs.",
        (
            text("effect", "its name"),
            number("volts", "V", "by how much it moves the release; empty: not known", empty=True),
            text("about", "what the volts stand for"),
            text("how", "computed here, by literature, a condition of the answer, or unknown"),
            boolean("held", "whether the interval of the release holds it"),
            text("settle", "what would settle it"),
            text("source", "where the volts come from"),
        ),
    ),
)
