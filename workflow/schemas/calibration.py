"""Tables of the calibration."""

from mesoscale.calibration.observables import LAWS, OBSERVABLES
from mesoscale.settings.definitions import INPUTS
from workflow.schemas.inputs_and_law import SEED
from workflow.schemas.table import Column, Table, integer, number, text

_INPUTS = tuple(number(row.name, row.unit, row.label, optional=row.may_lack) for row in INPUTS)


def _spread(unit: str, state: str) -> tuple[Column, ...]:
    return tuple(
        number(f"{state}_{name}", unit, f"{words} of the {state}")
        for name, words in (("q05", "5 % quantile"), ("q50", "median"), ("q95", "95 % quantile"))
    )


_NEXT = (
    text("kind", "kind of measurement"),
    text("measurement", "what is measured, and how well"),
    number("width_now_V", "V", "width of the central 90 % of the release voltage"),
    number("width_then_V", "V", "its expected width after the measurement"),
    number("reduction", "1", "expected reduction as a share"),
    number("standard_error", "1", "its standard error by the finite number of made-up data"),
    number("effective_samples", "1", "effective samples of the posterior behind one made-up data set"),
)

TABLES = (
    Table(
        ("calibration/cycles/chunk_*.csv", "calibration/local_cycles.csv"),
        "One contact cycle over the prior (local: where the posterior lies), and what can be measured of it.",
        (
            integer("run", "number of the run"),
            SEED,
            *_INPUTS,
            *(number(row.name, row.unit, "observable of the surface (docs/calibration.md)") for row in OBSERVABLES),
            *(number(row.name, row.unit, "parameter of the law fitted to the cycle") for row in LAWS),
        ),
    ),
    Table(
        ("calibration/samples.csv",),
        "One sample of the posterior; no row if the chain has not converged.",
        (*_INPUTS, number("log_likelihood", "1", "logarithm of the likelihood of the measurements")),
    ),
    Table(
        ("calibration/summary.csv",),
        "One input before and after the measurements.",
        (
            text("parameter", "name of the input"),
            text("unit", "its unit"),
            number("prior_mean", "`unit`", "mean of the prior"),
            number("prior_sd", "`unit`", "standard deviation of the prior"),
            number("posterior_mean", "`unit`", "mean of the posterior"),
            number("posterior_sd", "`unit`", "standard deviation of the posterior"),
            number("bits", "bit", "information gained on this input alone"),
            *_spread("`unit`", "prior"),
            *_spread("`unit`", "posterior"),
        ),
    ),
    Table(
        ("calibration/learned.csv",),
        "One table of measurements.",
        (
            text("kind", "kind of measurement"),
            text("file", "its file"),
            integer("rows", "rows in it"),
            number("alone_bits", "bit", "information gained from this table alone"),
            number("added_bits", "bit", "information gained by adding it to all the others"),
            number("probability", "1", "share of made-up data that are less likely, given all the others"),
            text("verdict", "agreement or contradiction in words"),
        ),
    ),
    Table(
        ("calibration/next.csv",),
        "One kind of measurement that could be made next, for the lumped switch.",
        _NEXT,
    ),
    Table(
        ("calibration/next_on_pad.csv",),
        "One kind of measurement that could be made next, for the switch on the pad; no row if too few are solved.",
        (
            *_NEXT,
            integer("solved", "switches that were solved on the pad"),
            integer("refused", "switches that press the pad harder than it was computed"),
        ),
    ),
    Table(
        ("calibration/predictive.csv",),
        "What the next surface or switch shows, before and after the measurements.",
        (
            text("quantity", "what is predicted"),
            text("unit", "its unit"),
            number("force_nN", "nN", "net force of a separation; else empty", empty=True),
            *_spread("`unit`", "prior"),
            *_spread("`unit`", "posterior"),
        ),
    ),
    Table(
        ("calibration/responses.csv",),
        "One observable in one round of contact cycles where the posterior lies (lengths in nm, others as logarithms).",
        (
            integer("round", "number of the round; 0 has the cycles over the prior alone"),
            text("observable", "what has a response"),
            integer("runs", "cycles behind the response"),
            integer("terms", "terms of the response"),
            number("error", "nm or 1", "standard error of the response over the posterior"),
            number("posterior_sd", "nm or 1", "standard deviation of the prediction over the posterior"),
            number("error_share", "1", "the first as a share of the second"),
            number("bias", "nm or 1", "mean difference of new cycles from the response", empty=True),
            number("bias_error", "nm or 1", "its standard error", empty=True),
        ),
    ),
)
