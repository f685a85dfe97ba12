"""Tables of the uncertain inputs, of the law and of the cycles behind it."""

from mesoscale.law.parameters import LAW
from mesoscale.settings.definitions import INPUTS
from workflow.schemas.table import Column, Table, boolean, integer, number, text

INPUT_VALUES = tuple(
    number(row.name, row.unit, f"{row.label} of the run", optional=row.may_lack) for row in INPUTS
)
"""One column per uncertain input in use."""
LAW_VALUES = tuple(number(row.name, row.unit, row.meaning, empty=True) for row in LAW)
SEED = integer("seed", "seed of the random surface")
BRANCH = text("branch", "closing or opening")

_FIT: tuple[Column, ...] = (
    *LAW_VALUES,
    text("covariance", "covariance of C_a, C_r and ρ_r as JSON; null where undetermined"),
    number(
        "residual",
        "1",
        "RMS misfit of the law over the window, relative to the largest force",
        empty=True,
    ),
    text("status", "ok, or why the fit is poor or missing"),
)
_CURVE_STATUS = text("curve_status", "ok, unconverged, or failed: why", empty=True)

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
    Table(
        ("law/parameters.csv",),
        "The law of one branch of one run of the design.",
        (
            integer("run", "number of the run"),
            integer("node", "number of the node of the design; 0 is its centre"),
            SEED,
            BRANCH,
            *_FIT,
            _CURVE_STATUS,
            *INPUT_VALUES,
        ),
    ),
    Table(
        ("law/nominal.csv",),
        "The law of one branch of one nominal curve.",
        (text("curve", "group of curves/nominal.h5"), BRANCH, *_FIT, _CURVE_STATUS),
    ),
    Table(
        ("history/cycles.csv",),
        "One cycle of one surface.",
        (
            SEED,
            integer("cycle", "number of the cycle, from 1"),
            number("held_s", "s", "time under load so far"),
            number("first_contact_nm", "nm", "separation of first contact"),
            number("closed_nm", "nm", "separation at the end of the hold"),
            number("last_contact_nm", "nm", "separation of last contact"),
            number("contact_area_nm2", "nm²", "contact area at the end of closing"),
            number("dissipated_nN_nm", "nN nm", "energy dissipated, creep included"),
            number("pull_off_nN", "nN", "largest net attraction on opening"),
            *(
                number(f"opening_{row.name}", row.unit, f"{row.meaning}, on opening", empty=True)
                for row in LAW
            ),
            text("opening_status", "ok, or why the fit of the opening is poor or missing"),
            boolean("converged", "whether the cycle and its hold converged"),
        ),
    ),
    Table(
        ("history/dwell.csv",),
        "One time of one hold.",
        (
            SEED,
            integer("cycle", "number of the cycle, from 1"),
            number("held_s", "s", "time under load so far"),
            number("hardness_factor", "1", "hardness relative to that without time under load"),
            number("separation_nm", "nm", "mean separation"),
            number("contact_area_nm2", "nm²", "contact area"),
            integer("asperities", "asperities in contact"),
        ),
    ),
)
