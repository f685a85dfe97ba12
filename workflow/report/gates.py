"""Whether the numbers of each stage can be trusted, and which of them the answer rests on."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from mesoscale.scan_checks.judged import disagreeing, testable
from workflow.report.available import Results
from workflow.report.numbers import OUTPUTS, column, number, show
from workflow.report.page import Gate

OTHER_WORK = {"clamped": 1.0 / 3.0, "offset": 3.0}
"""Work of the other law of attraction over that of this one, at touch (docs/contact.md)."""


def gates_of(results: Results) -> list[Gate]:
    """All gates of a scene."""
    return [gate for build in GATES for gate in build(results)]


def accepted_failures(results: Results) -> dict[str, Gate]:
    """Failed gates of stages whose inputs the scene takes all the same, by stage."""
    stages = {**INPUT_GATES, "topography": _topography}
    gates = {stage: next(build(results), None) for stage, build in stages.items()}
    return {stage: gate for stage, gate in gates.items() if gate and gate.used and not gate.passed}


def trust(gates: Sequence[Gate]) -> tuple[str, str]:
    """One light for the answer (pass, warn or fail), and in words what it says."""
    failed = [gate.stage for gate in gates if gate.used and gate.answer and not gate.passed]
    if failed:
        return "fail", f"The answer is not to be trusted: {', '.join(failed)} failed."
    doubted = [gate.stage for gate in gates if gate.used and gate.answer and gate.reasons]
    if doubted:
        return "warn", f"The answer stands, with remarks on {', '.join(doubted)}."
    return "pass", "All that the answer rests on passed."


def faint_outputs(results: Results) -> dict[str, str]:
    """Outputs of the law that are not to be trusted, each with the reason."""
    rows = results.rows("uncertainty/validation.csv")
    return {row["output"]: row["doubt"] for row in rows if row.get("doubt")}


def _of_file(stage: str, name: str, results: Results) -> Iterator[Gate]:
    """The gate that a stage wrote into its JSON file."""
    if results.has(name):
        gate = results.json(name).get("gate", {})
        yield Gate(
            stage, bool(gate.get("passed")), tuple(gate.get("reasons", ())), results.uses(stage)
        )


def _topography(results: Results) -> Iterator[Gate]:
    name = "topography/parameters.json"
    for gate in _of_file("topography", name, results):
        doubts = [
            row["code"]
            for row in results.json(name).get("doubts", [])
            if row["text"] not in gate.reasons
        ]
        reasons = gate.reasons
        if doubts:
            remark = f"Doubts, each beside the numbers it touches: {', '.join(doubts)}."
            reasons = (*reasons, remark)
        yield Gate(gate.stage, gate.passed, reasons, gate.used)
    rows = results.rows("topography/judged.csv")
    reasons = tuple(
        f"{row['scan']} touches first at {show(row['pressed'])} nm, its description says"
        f" {show(row['low'])} to {show(row['high'])} nm"
        for row in disagreeing(rows)
    )
    if reasons or testable(rows):
        yield Gate("pressing the scans", not reasons, reasons, results.uses("topography"))


def _contact(results: Results) -> Iterator[Gate]:
    if results.has("contact/nominal.h5"):
        cycles = results.h5("contact/nominal.h5")[2]
        bad = [
            name
            for name, cycle in cycles.items()
            if "/" not in name and not bool(cycle.get("converged", True))
        ]
        yield Gate(
            "contact", not bad, tuple(f"{name}: some load steps did not converge" for name in bad)
        )


def _law(results: Results) -> Iterator[Gate]:
    """Whether enough curves gave a law."""
    if results.has("law/parameters.csv"):
        rows = results.csv("law/parameters.csv")
        poor = [row for row in rows if row["status"] == "poor_fit"]
        missing = [row for row in rows if row["status"] not in ("ok", "poor_fit")]
        reasons = []
        if poor:
            worst = column(poor, "residual").max()
            reasons.append(
                f"{len(poor)} of {len(rows)} fits miss their curve by up to {worst:.0%} of its"
                " maximum"
            )
        if missing:
            reasons.append(
                f"{len(missing)} of {len(rows)} curves gave no law, which favours those that could"
                " be fitted"
            )
        fair = len(missing) <= 0.05 * len(rows)  # of more, the rest is no fair sample
        yield Gate("law", fair, tuple(reasons), answer=False)


def _uncertainty(results: Results) -> Iterator[Gate]:
    if results.has("uncertainty/validation.csv"):
        faint = faint_outputs(results)
        reasons = tuple(f"{OUTPUTS[name][0]}: {reason}" for name, reason in faint.items())
        yield Gate("uncertainty", not faint, reasons, answer=False)


def _pad(results: Results) -> Iterator[Gate]:
    if results.has("answer/pad_switch.json"):
        gate = results.json("answer/pad_switch.json")["gate"]
        yield Gate("pad", gate["passed"], tuple(gate["reasons"]))


def other_law_V(results: Results) -> tuple[float, float] | None:
    """Release at central inputs by this law of attraction and by the other one; None where not
    computed.
    """
    rows = results.json("answer/pad_switch.json").get("by_attraction", [])
    releases = {round(row["times"], 3): number(row["release_V"]) for row in rows}
    works = (1.0, OTHER_WORK.get(results.contact.get("attraction", ""), 0.0))
    this_law, other = (releases.get(round(times, 3), np.nan) for times in works)
    if not np.isfinite([this_law, other]).all():
        return None
    return this_law, other


def _attraction(results: Results) -> Iterator[Gate]:
    """Nothing here measures the law of attraction: a remark where the other law gives another
    outcome.
    """
    if not results.has("answer/pad_switch.json"):
        return
    both = other_law_V(results)
    if both and (both[0] == 0) != (both[1] == 0):
        reason = "by one of the two laws of attraction the switch sticks, by the other it lets go"
        yield Gate("law of attraction", True, (reason,))


def _calibration(results: Results) -> Iterator[Gate]:
    if results.has("calibration/posterior.json"):
        posterior = results.json("calibration/posterior.json")
        reasons = (*posterior["gate"]["reasons"], *posterior["remarks"])
        yield Gate(
            "calibration",
            bool(posterior["gate"]["passed"]),
            reasons,
            answer=results.uses("calibration"),
        )


INPUT_GATES: dict[str, Callable[[Results], Iterator[Gate]]] = {
    "hardness": lambda results: _of_file("hardness", "hardness/fit.json", results),
    "elastic": lambda results: _of_file("elastic", "elastic/e_star.json", results),
}
GATES: tuple[Callable[[Results], Iterator[Gate]], ...] = (
    *INPUT_GATES.values(),
    _topography,
    _contact,
    _pad,
    _attraction,
    _law,
    _uncertainty,
    _calibration,
)
