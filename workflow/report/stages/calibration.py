"""What measurements say about the inputs: before and after, whether they agree, what comes next."""

from collections.abc import Callable, Iterator

from workflow.report.available import CsvRow, Results
from workflow.report.numbers import SYMBOLS, cell, show, spread
from workflow.report.page import Block, stage, table


@stage(
    "Calibration with measurements",
    *(f"calibration/{name}" for name in ("posterior.json", "summary.csv", "predictive.csv")),
    also=("calibration/samples.csv",),
)
def describe(results: Results) -> Iterator[Block]:
    """Measurements in, posterior out."""
    posterior = results.json("calibration/posterior.json")
    yield (
        "What the tables of measurements say about the inputs, by Bayes' rule: the scatter of"
        " single surfaces is that of the model, and its responses count with their own error."
    )
    if not posterior["gate"]["passed"]:
        yield "The chain has not converged, so there is no posterior."
        return
    states = {"before, median and 5 to 95 %": _state("prior"), "after": _state("posterior")}
    yield table(
        "Inputs before and after the measurements",
        results.csv("calibration/summary.csv"),
        {
            "input": lambda row: (
                f"{SYMBOLS.get(row['parameter'], row['parameter'])} ({row['unit']})"
            ),
            **states,
        },
    )
    yield table(
        "Each table beside what the others predict",
        [{"kind": kind.replace("_", " "), **row} for kind, row in posterior["tables"].items()],
        {
            "measurement": "kind",
            "rows": "rows",
            "probability": cell("probability", 2),
            "verdict": "verdict",
            "source": "source",
        },
    )
    yield table(
        "What the next surface and the next switch show",
        results.csv("calibration/predictive.csv"),
        {"quantity": _quantity, **states},
    )
    chain = posterior["chain"]
    yield (
        f"Chain ({chain['sampler']}): R-hat {chain['r_hat']:.4f}, {chain['independent_draws']:.0f}"
        f" independent draws. Behind the responses are {posterior['cycles']} contact cycles; their"
        " error, which is part of the posterior's width, is at most"
        f" {show(posterior['response_error_share'], 2)} of it. The answer is that of the inputs"
        " after the measurements."
    )
    if left_out := posterior["points_left_out"]:
        yield (
            f"{left_out} points of curves lie outside the forces of the responses and are left out."
        )


def _quantity(row: CsvRow) -> str:
    force = f" at {show(row['force_nN'])} nN" if row["force_nN"] else ""
    return f"{row['quantity'].replace('_', ' ')}{force} ({row['unit']})"


def _state(name: str) -> Callable[[CsvRow], str]:
    return lambda row: spread(row, f"{name}_q50", f"{name}_q05", f"{name}_q95")
