"""What measurements say about the inputs: prior and posterior, what each taught, what to measure next."""

from workflow.report.available import Results
from workflow.report.numbers import SYMBOLS, number, show
from workflow.report.page import COMPUTED, Section, Table


def describe(results: Results) -> Section | None:
    """Measurements in, posterior out."""
    if not results.has("calibration/posterior.json", "calibration/summary.csv", "calibration/learned.csv"):
        return None
    posterior = results.json("calibration/posterior.json")
    gate = posterior["gate"]
    section = Section(
        "calibration",
        "Calibration with measurements",
        "What the tables of measurements say about the inputs, by Bayes' rule: the scatter of single surfaces is that "
        "of the model, and its responses count with their own error.",
        COMPUTED,
    )
    section.files += [f"calibration/{name}" for name in ("posterior.json", "samples.csv", "summary.csv", "learned.csv")]
    if not gate["passed"]:
        section.notes.append("The chain has not converged, so there is no posterior.")
        return section
    for row in results.csv("calibration/predictive.csv"):
        if row["quantity"] == "release":
            header = ("release of the next lumped switch (V)", "before, median and 5 to 95 %", "after")
            line = ("below 0: it sticks", _interval(row, "prior"), _interval(row, "posterior"))
            section.blocks.append(Table("What the measurements do to the release voltage", header, [line]))
    rows = results.csv("calibration/summary.csv")
    lines = [
        (
            f"{SYMBOLS.get(row['parameter'], row['parameter'])} ({row['unit']})",
            _interval(row, "prior"),
            _interval(row, "posterior"),
            show(row["bits"], 2),
        )
        for row in rows
    ]
    header = ("input", "prior, median and 5 to 95 %", "posterior", "learned (bits)")
    section.blocks.append(Table("Inputs before and after the measurements", header, lines))
    lines = [
        (
            row["kind"].replace("_", " "),
            row["rows"],
            show(row["alone_bits"], 2),
            show(row["added_bits"], 2),
            show(row["probability"], 2),
            row["verdict"],
            posterior["tables"][row["kind"]]["source"],
        )
        for row in results.csv("calibration/learned.csv")
    ]
    header = ("measurement", "rows", "alone (bits)", "added to the others (bits)", "probability", "verdict", "source")
    section.blocks.append(Table("What each measurement taught", header, lines))
    lines = [
        (
            row["quantity"] + (f" at {show(row['force_nN'])} nN" if row["force_nN"] else "") + f" ({row['unit']})",
            _interval(row, "prior"),
            _interval(row, "posterior"),
        )
        for row in results.csv("calibration/predictive.csv")
    ]
    header = ("quantity", "before, median and 5 to 95 %", "after")
    section.blocks.append(Table("What the next surface and the next switch show", header, lines))
    section.blocks.append(_next(results, "next.csv", "What to measure next, for the lumped switch"))
    on_pad = results.has("calibration/next_on_pad.csv") and results.csv("calibration/next_on_pad.csv")
    if on_pad and number(on_pad[0]["width_now_V"]) > 0:
        section.blocks.append(_next(results, "next_on_pad.csv", "What to measure next, for the switch on the pad"))
        section.files.append("calibration/next_on_pad.csv")
        if refused := int(number(on_pad[0]["refused"])):
            section.notes.append(
                f"What to measure next on the pad stands on {on_pad[0]['solved']} switches; {refused} more press the "
                "pad harder than it was computed and are left out."
            )
    elif on_pad:
        section.notes.append("The switch on the pad sticks throughout its 90 % interval: nothing narrows its release.")
    chain = posterior["chain"]
    section.notes.append(
        "Release here is that of the lumped switch on the compact law, which every measurement of a release voltage is "
        "compared with; the pad's switch has its own interval (From a cell to a pad)."
    )
    section.notes.append(
        f"{show(posterior['information_bits'], 2)} bits in all. Chain ({chain['sampler']}): "
        f"R-hat {chain['r_hat']:.4f}, {chain['independent_draws']:.0f} independent draws. Behind the responses are "
        f"{posterior['cycles']} contact cycles; their error, which is part of the posterior's width, is at most "
        f"{show(posterior['response_error_share'], 2)} of it."
    )
    if posterior["points_left_out"]:
        section.notes.append(
            f"{posterior['points_left_out']} points of curves lie outside the forces of the responses and are left out."
        )
    section.files += [f"calibration/{name}" for name in ("next.csv", "predictive.csv", "responses.csv")]
    return section


def _next(results: Results, name: str, title: str) -> Table:
    """Expected width of the release voltage's interval after one more measurement of each kind."""
    lines = [
        (row["kind"].replace("_", " "), row["measurement"], show(row["width_then_V"]), _percent(row))
        for row in results.csv(f"calibration/{name}")
    ]
    return Table(title, ("measurement", "what", "expected width of the release voltage's 90 % (V)", "reduction"), lines)


def _percent(row: dict[str, str]) -> str:
    """A reduction in whole percent with its standard error."""
    return f"{round(100 * number(row['reduction']))} ± {100 * number(row['standard_error']):.1f} %"


def _interval(row: dict[str, str], state: str) -> str:
    return f"{show(row[f'{state}_q50'])} [{show(row[f'{state}_q05'])}, {show(row[f'{state}_q95'])}]"
