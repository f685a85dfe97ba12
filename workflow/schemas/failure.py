"""Table of the failure rate."""

from workflow.schemas.table import Table, number

TABLES = (
    Table(
        ("failure/failure.csv",),
        "One hold voltage with one law of attraction.",
        (
            number("hold_V", "V", "hold voltage"),
            number("attraction", "1", "factor on the attraction"),
            number("failing", "1", "probability of a failure by the response"),
            number(
                "failing_q95", "1", "share that fails of one batch, at most, with 95 % confidence"
            ),
            number("failing_sure", "1", "the same with 90 % confidence"),
        ),
    ),
)
