"""Tables that all stages share: accuracy and stability."""

from workflow.schemas.table import Table, boolean, number, text

TABLES = (
    Table(
        ("accuracy/*.csv", "contact/errors.csv", "answer/errors.csv"),
        "One value of one knob.",
        (
            text("stage", "stage of the study"),
            text("case", "quantity whose error it is"),
            text("knob", "setting that is varied"),
            text("value", "its value"),
            boolean("shipped", "whether it is the value in use"),
            number(
                "error", "as `unit` says", "root mean square error over the samples", empty=True
            ),
            number(
                "own_error",
                "as `unit` says",
                "standard error of `error`; empty where not known",
                empty=True,
            ),
            text("unit", "unit of both"),
            number(
                "release_V",
                "V",
                "what the error moves in the release; empty where not known",
                empty=True,
            ),
            text("reference", "what the error is against, and the samples", empty=True),
            number("wall_s", "s", "run time of one computation", empty=True),
            number("cpu_s", "s", "processor time of one computation", empty=True),
            number("peak_rss_MB", "MB", "largest memory meanwhile", empty=True),
        ),
    ),
    Table(
        ("stability/*.csv",),
        "One hard case.",
        (
            text("stage", "stage of the study"),
            text("case", "name of the case"),
            text("description", "what is hard about it"),
            text("checks", "what is checked"),
            boolean("passed", "whether it passed"),
            text("detail", "numbers behind the verdict, or why it failed", empty=True),
            number("wall_s", "s", "run time"),
            number("cpu_s", "s", "processor time"),
        ),
    ),
)
