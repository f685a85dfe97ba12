"""Table of the uncertain inputs."""

from workflow.schemas.table import Table, number, text

TABLES = (
    Table(
        ("inputs.csv", "pad/inputs.csv", "calibration/priors.csv"),
        "An uncertain input in use (the paper's Table 1).",
        (
            text("parameter", "name of the input"),
            text("unit", "its unit"),
            text(
                "distribution",
                "its kind, as inputs.<name>.distribution; of samples with the values as JSON",
            ),
            number(
                "a", "`unit`", "lower bound (uniform), mean (normal) or value (fixed)", empty=True
            ),
            number(
                "b", "`unit`", "upper bound (uniform) or standard deviation (normal)", empty=True
            ),
            number("low", "`unit`", "lower end of the truncation", empty=True),
            number("high", "`unit`", "upper end of the truncation", empty=True),
            text("correlation", "rank correlation with inputs above, as JSON", empty=True),
            text("origin", "literature, or the stage that computed it"),
            text(
                "varies",
                "common: one unknown value for all devices; each: another for each of them",
            ),
            text("file", "result file or publication that it comes from"),
        ),
    ),
)
