"""Tables that all stages share: accuracy, stability, and the draws behind the contact model's stability."""

from workflow.schemas.table import Table, boolean, integer, number, text

_HARDNESS = "; hardness alone"

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
            number("hardness_GPa", "GPa", "plateau stress" + _HARDNESS, empty=True, optional=True),
            number("hardness_lo", "GPa", "lower end of its 68 % interval" + _HARDNESS, empty=True, optional=True),
            number("hardness_hi", "GPa", "upper end of its 68 % interval" + _HARDNESS, empty=True, optional=True),
            text("status", "yield, no_yield, or rejected: why" + _HARDNESS, empty=True, optional=True),
            integer("atom_steps", "atoms times MD steps" + _HARDNESS, empty=True, optional=True),
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
        ),
    ),
)
