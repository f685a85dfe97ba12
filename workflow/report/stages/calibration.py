"""What measurements say about the inputs: before and after, whether they agree, what comes next."""

from workflow.report.available import Results
from workflow.report.numbers import SYMBOLS, show
from workflow.report.page import COMPUTED, Section, Table


def describe(results: Results) -> Section | None:
    """Measurements in, posterior out."""
    files = [f"calibration/{name}" for name in ("posterior.json", "summary.csv", "predictive.csv")]
    if not results.has(*files):
        return None
    posterior = results.json(files[0])
    section = Section(
        "calibration",
        "Calibration with measurements",
        "What the tables of measurements say about the inputs, by Bayes' rule: the scatter of single surfaces is that "
        "of the model, and its responses count with their own error.",
        COMPUTED,
    )
    section.files += [*files, "calibration/samples.csv"]
    if not posterior["gate"]["passed"]:
        section.notes.append("The chain has not converged, so there is no posterior.")
        return section
    header = ("before, median and 5 to 95 %", "after")
    inputs = [
        (f"{SYMBOLS.get(row['parameter'], row['parameter'])} ({row['unit']})", *_intervals(row))
        for row in results.csv(files[1])
    ]
    section.blocks.append(Table("Inputs before and after the measurements", ("input", *header), inputs))
    tables = [
        (kind.replace("_", " "), row["rows"], show(row["probability"], 2), row["verdict"], row["source"])
        for kind, row in posterior["tables"].items()
    ]
    columns = ("measurement", "rows", "probability", "verdict", "source")
    section.blocks.append(Table("Each table beside what the others predict", columns, tables))
    predicted = [
        (
            row["quantity"].replace("_", " ")
            + (f" at {show(row['force_nN'])} nN" if row["force_nN"] else "")
            + f" ({row['unit']})",
            *_intervals(row),
        )
        for row in results.csv(files[2])
    ]
    section.blocks.append(Table("What the next surface and the next switch show", ("quantity", *header), predicted))
    chain = posterior["chain"]
    section.notes.append(
        f"Chain ({chain['sampler']}): R-hat {chain['r_hat']:.4f}, {chain['independent_draws']:.0f} independent draws. "
        f"Behind the responses are {posterior['cycles']} contact cycles; their error, which is part of the posterior's "
        f"width, is at most {show(posterior['response_error_share'], 2)} of it. The answer is that of the "
        "inputs after the measurements."
    )
    if posterior["points_left_out"]:
        section.notes.append(
            f"{posterior['points_left_out']} points of curves lie outside the forces of the responses and are left out."
        )
    return section


def _intervals(row: dict[str, str]) -> tuple[str, str]:
    """Median and 90 % interval before and after."""
    before, after = (
        f"{show(row[f'{state}_q50'])} [{show(row[f'{state}_q05'])}, {show(row[f'{state}_q95'])}]"
        for state in ("prior", "posterior")
    )
    return before, after
