"""Tables of uncertainty and sensitivity."""

from mesoscale.law.parameters import LAW
from workflow.schemas.columns import BRANCH, INPUT_VALUES, SEED
from workflow.schemas.table import Column, Table, integer, number, text

_OUTPUT = text("output", "parameter of the law on closing, or its change on opening (delta_)")
_UNIT = text("unit", "unit of the output")
_INPUT = text("input", "name of the uncertain input")


def _fitted(empty: bool, status: bool) -> tuple[Column, ...]:
    columns: list[Column] = []
    for branch in ("closing", "opening"):
        columns += [
            number(f"{branch}_{row.name}", row.unit, f"{row.meaning}, {branch}", empty)
            for row in LAW
        ]
        if status:
            columns.append(
                text(f"{branch}_status", f"ok, or why the fit of the {branch} is poor or missing")
            )
    return tuple(columns)


def _in_unit(name: str, meaning: str, empty: bool = False) -> Column:
    """A number in the output's unit."""
    return number(name, "`unit`", meaning, empty)


def _with_ends(column: Column, bounds: str) -> tuple[Column, ...]:
    """A number with the ends of its interval."""
    low = number(f"{column.name}_low", column.unit, f"lower end of its {bounds}", column.empty)
    return (
        column,
        low,
        number(f"{column.name}_high", column.unit, f"upper end of its {bounds}", column.empty),
    )


_QUANTILES = {"q05": "5 % quantile", "q50": "median", "q95": "95 % quantile"}
_MISSING = integer("missing", "runs without this output")

_OUTPUTS = Table(
    ("uncertainty/outputs.csv",),
    "An output of the paper's Table 2.",
    (
        _OUTPUT,
        _UNIT,
        _in_unit("mean", "mean by the paper's method, averaged over seeds"),
        _in_unit("dev", "standard deviation by the paper's method, averaged over seeds"),
        _in_unit("mean_seed_sd", "standard deviation of the mean over seeds"),
        _in_unit("dev_seed_sd", "standard deviation of the deviation over seeds"),
        _in_unit("paper_mean", "the paper's mean"),
        _in_unit("paper_dev", "the paper's deviation"),
        number("mean_difference_in_seed_sd", "1", "mean minus the paper's, over mean_seed_sd"),
        number("dev_difference_in_seed_sd", "1", "deviation minus the paper's, over dev_seed_sd"),
        _in_unit(
            "paper_mean_exchanged", "the paper's mean with the labels of δC_a and δC_r exchanged"
        ),
        _in_unit("paper_dev_exchanged", "the paper's deviation with these labels exchanged"),
        number("mean_difference_in_seed_sd_exchanged", "1", "mean minus the paper's exchanged one"),
        number(
            "dev_difference_in_seed_sd_exchanged", "1", "deviation minus the paper's exchanged one"
        ),
        _in_unit("centre", "at the central inputs, averaged over seeds"),
        _in_unit("centre_seed_sd", "its standard deviation over seeds"),
        _in_unit("response_mean", "mean of the exported response, averaged over random surfaces"),
        _in_unit("response_dev", "standard deviation of the exported response"),
        *(
            _in_unit(f"response_{name}", f"{words} of the exported response")
            for name, words in _QUANTILES.items()
        ),
        _in_unit("cell_dev", "standard deviation of the direct runs, each a cell of its own"),
        *(
            _in_unit(f"cell_{name}", f"{words} of the direct runs")
            for name, words in _QUANTILES.items()
        ),
        number("seed_share", "1", "share of the variance that comes from the random surface"),
        integer("seeds_used", "seeds with all nodes"),
        integer("seeds", "seeds computed"),
        integer("runs", "runs of the design"),
        _MISSING,
    ),
)

_VALIDATION = Table(
    ("uncertainty/validation.csv",),
    "An output: the exported response beside direct runs. All but the counts is empty with fewer"
    " than three of these.",
    (
        _OUTPUT,
        _UNIT,
        integer("runs", "direct runs"),
        _MISSING,
        _in_unit("rmse", "root mean square error of held-out predictions", empty=True),
        _in_unit("bias", "mean error of held-out predictions", empty=True),
        *_with_ends(
            number("q2", "1", "1 - rmse² / variance of the direct runs", True),
            "90 % bootstrap interval",
        ),
        number(
            "surface_share",
            "1",
            "share of the variance between surfaces at equal inputs",
            empty=True,
        ),
        number(
            "explained",
            "1",
            "share of the rest that the response explains of runs left out",
            empty=True,
        ),
        text("doubt", "why the output is not to be trusted; empty where it is", empty=True),
    ),
)

_SENSITIVITY = Table(
    ("uncertainty/sensitivity.csv",),
    "An output with an input (the paper's Table 3).",
    (
        _OUTPUT,
        _INPUT,
        _UNIT,
        _in_unit("mu_star", "elementary effect by the paper's method, averaged over seeds"),
        _in_unit("mu_star_seed_sd", "its standard deviation over seeds"),
        _in_unit("paper_mu_star", "the paper's, with the labels of C_a and C_r exchanged"),
        _in_unit("paper_mu_star_as_printed", "the paper's, as printed"),
        number("difference_in_seed_sd", "1", "mu_star minus the paper's, over mu_star_seed_sd"),
        number("difference_in_seed_sd_as_printed", "1", "the same for the paper's as printed"),
        *_with_ends(
            number("sobol_first", "1", "first-order Sobol' index of the response"), "90 % interval"
        ),
        *_with_ends(
            number("sobol_total", "1", "total Sobol' index of the response"), "90 % interval"
        ),
        number("seed_share", "1", "share of the variance that comes from the random surface"),
        integer("seeds_used", "seeds with all nodes of level 1"),
    ),
)

_DIRECT = Table(
    ("uncertainty/direct/chunk_*.csv",),
    "One direct run: cycle and law of its own inputs on its own surface.",
    (
        integer("run", "number of the run"),
        SEED,
        *INPUT_VALUES,
        *_fitted(empty=True, status=True),
        number("first_contact_nm", "nm", "separation of first contact", empty=True),
        text("curve_status", "ok, unconverged, or failed: why"),
    ),
)

_SAMPLES = Table(
    ("uncertainty/samples.csv",),
    "One sample of the inputs through the exported responses; nan where an output has none.",
    (*INPUT_VALUES, *_fitted(empty=False, status=False)),
)

_LAW = Table(
    ("uncertainty/law.csv",),
    "One gap of one branch: the pressure over the samples of the law.",
    (
        BRANCH,
        number("gap_nm", "nm", "separation"),
        number("pressure_q05_GPa", "GPa", "5 % quantile, positive: repulsive"),
        number("pressure_q50_GPa", "GPa", "median"),
        number("pressure_q95_GPa", "GPa", "95 % quantile"),
    ),
)

TABLES = (_OUTPUTS, _SENSITIVITY, _SAMPLES, _LAW, _VALIDATION, _DIRECT)
