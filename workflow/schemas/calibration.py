"""Tables of the calibration."""

from mesoscale.calibration.observables import NAMES
from mesoscale.settings.definitions import INPUTS
from workflow.schemas.columns import SEED
from workflow.schemas.table import Table, integer, number, text

_INPUTS = tuple(number(row.name, row.unit, row.label, optional=row.may_lack) for row in INPUTS)
_SPREAD = tuple(
    number(f"{state}_{name}", "`unit`", f"{words} of the {state}")
    for state in ("prior", "posterior")
    for name, words in (("q05", "5 % quantile"), ("q50", "median"), ("q95", "95 % quantile"))
)

TABLES = (
    Table(
        ("calibration/cycles/chunk_*.csv",),
        "One contact cycle over the prior, and what can be measured of it.",
        (
            integer("run", "number of the run"),
            SEED,
            *_INPUTS,
            *(
                number(
                    name, name.rpartition("_")[2], "observable of the surface (docs/calibration.md)"
                )
                for name in NAMES
            ),
        ),
    ),
    Table(
        ("calibration/samples.csv",),
        "One sample of the posterior; no row if the chain has not converged.",
        (
            *_INPUTS,
            number("log_likelihood", "1", "logarithm of the likelihood of the measurements"),
        ),
    ),
    Table(
        ("calibration/summary.csv",),
        "One input before and after the measurements.",
        (text("parameter", "name of the input"), text("unit", "its unit"), *_SPREAD),
    ),
    Table(
        ("calibration/predictive.csv",),
        "What the next surface or switch shows, before and after the measurements; voltages where"
        " some were measured.",
        (
            text("quantity", "what is predicted"),
            text("unit", "its unit"),
            number("force_nN", "nN", "net force of a separation; else empty", empty=True),
            *_SPREAD,
        ),
    ),
)
