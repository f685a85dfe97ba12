"""Tables of the compact law of one cell."""

from workflow.schemas.columns import BRANCH, INPUT_VALUES, LAW_VALUES, SEED
from workflow.schemas.table import Column, Table, integer, number, text

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
        (text("curve", "group of contact/nominal.h5"), BRANCH, *_FIT, _CURVE_STATUS),
    ),
)
