"""What measurements say about the inputs: prior and posterior, what each taught, what to measure next."""

from collections.abc import Callable, Iterator

from workflow.report.available import Results, Row
from workflow.report.numbers import SYMBOLS, cell, number, show, spread
from workflow.report.page import Block, Table, stage, table

FILES = [f"calibration/{name}.csv" for name in ("samples", "next", "predictive", "responses", "next_on_pad")]


@stage(
    "Calibration with measurements",
    *("calibration/posterior.json", "calibration/summary.csv", "calibration/learned.csv"),
    also=FILES,
)
def describe(results: Results) -> Iterator[Block]:
    """Measurements in, posterior out."""
    posterior = results.json("calibration/posterior.json")
    yield (
        "What the tables of measurements say about the inputs, by Bayes' rule: the scatter of single surfaces is that "
        "of the model, and its responses count with their own error."
    )
    if not posterior["gate"]["passed"]:
        yield "The chain has not converged, so there is no posterior."
        return
    predicted = results.csv("calibration/predictive.csv")
    prior, after = _state("prior"), _state("posterior")
    yield table(
        "What the measurements do to the release voltage",
        [row for row in predicted if row["quantity"] == "release"],
        {
            "release of the next lumped switch (V)": lambda row: "below 0: it sticks",
            "before, median and 5 to 95 %": prior,
            "after": after,
        },
    )
    yield table(
        "Inputs before and after the measurements",
        results.csv("calibration/summary.csv"),
        {
            "input": lambda row: f"{SYMBOLS.get(row['parameter'], row['parameter'])} ({row['unit']})",
            "prior, median and 5 to 95 %": prior,
            "posterior": after,
            "learned (bits)": cell("bits", 2),
        },
    )
    yield table(
        "What each measurement taught",
        results.csv("calibration/learned.csv"),
        {
            "measurement": _kind,
            "rows": "rows",
            "alone (bits)": cell("alone_bits", 2),
            "added to the others (bits)": cell("added_bits", 2),
            "probability": cell("probability", 2),
            "verdict": "verdict",
            "source": lambda row: posterior["tables"][row["kind"]]["source"],
        },
    )
    yield table(
        "What the next surface and the next switch show",
        predicted,
        {"quantity": _quantity, "before, median and 5 to 95 %": prior, "after": after},
    )
    yield _next(results, "next.csv", "What to measure next, for the lumped switch")
    on_pad = results.csv("calibration/next_on_pad.csv") if results.has("calibration/next_on_pad.csv") else []
    if on_pad and number(on_pad[0]["width_now_V"]) > 0:
        yield _next(results, "next_on_pad.csv", "What to measure next, for the switch on the pad")
        if refused := int(number(on_pad[0]["refused"])):
            yield (
                f"What to measure next on the pad stands on {on_pad[0]['solved']} switches; {refused} more press the "
                "pad harder than it was computed and are left out."
            )
    elif on_pad:
        yield "The switch on the pad sticks throughout its 90 % interval: nothing narrows its release."
    chain = posterior["chain"]
    yield (
        "Release here is that of the lumped switch on the compact law, which every measurement of a release voltage is "
        "compared with; the pad's switch has its own interval (From a cell to a pad)."
    )
    yield (
        f"{show(posterior['information_bits'], 2)} bits in all. Chain ({chain['sampler']}): "
        f"R-hat {chain['r_hat']:.4f}, {chain['independent_draws']:.0f} independent draws. Behind the responses are "
        f"{posterior['cycles']} contact cycles; their error, which is part of the posterior's width, is at most "
        f"{show(posterior['response_error_share'], 2)} of it."
    )
    if left_out := posterior["points_left_out"]:
        yield f"{left_out} points of curves lie outside the forces of the responses and are left out."


def _next(results: Results, name: str, title: str) -> Table:
    """Expected width of the release voltage's interval after one more measurement of each kind."""
    columns = {
        "measurement": _kind,
        "what": "measurement",
        "expected width of the release voltage's 90 % (V)": cell("width_then_V"),
        "reduction": _percent,
    }
    return table(title, results.csv(f"calibration/{name}"), columns)


def _kind(row: Row) -> str:
    return row["kind"].replace("_", " ")


def _quantity(row: Row) -> str:
    return row["quantity"] + (f" at {show(row['force_nN'])} nN" if row["force_nN"] else "") + f" ({row['unit']})"


def _percent(row: Row) -> str:
    """A reduction in whole percent with its standard error."""
    return f"{round(100 * number(row['reduction']))} ± {100 * number(row['standard_error']):.1f} %"


def _state(name: str) -> Callable[[Row], str]:
    return lambda row: spread(row, f"{name}_q50", f"{name}_q05", f"{name}_q95")
