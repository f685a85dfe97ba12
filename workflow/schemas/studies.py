"""Tables that all stages share: accuracy and stability."""

from workflow.schemas.table import Table, boolean, number, text

TABLES = (
    Table(
        ("accuracy/*.csv",),
        "One value of one knob.",
        (
            text("stage", "stage of the study"),
            text("case", "quantity whose error it is"),
            text("knob", "setting that is varied"),
            text("value", "its value"),
            number("error", "1", "error against the reference; `error_metric` says which"),
            text("error_metric", "what the error is"),
            text("reference", "what the error is against", empty=True),
            number("wall_s", "s", "run time", empty=True),
            number("cpu_s", "s", "processor time", empty=True),
            number("peak_rss_MB", "MB", "largest memory so far", empty=True),
        ),
    ),
    Table(
        ("stability/contact.csv",),
        "One hard case.",
        (
            text("stage", "stage of the study"),
            text("case", "name of the case"),
            text("description", "what is hard about it"),
            text("checks", "what is checked"),
            boolean("passed", "whether it passed"),
            text("detail", "numbers behind the verdict, or why it failed", empty=True),
            number("wall_s", "s", "run time"),
        ),
    ),
)
