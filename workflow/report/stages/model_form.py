"""Asperities on their own beside coupled ones: what the choice of the mechanics changes."""

from collections.abc import Iterator

from workflow.report.available import Results, Row
from workflow.report.numbers import OUTPUTS, cell, number, show, spread
from workflow.report.page import Block, stage, table

SWITCH = {
    "pull_off_nN": ("pull-off", "nN", 1.0),
    "opening_stiffness_nN_nm": ("opening stiffness", "nN/nm", 1.0),
}


@stage("What coupling changes", "uq/model_form.csv")
def describe(results: Results) -> Iterator[Block]:
    """The shift of every output."""
    rows = results.csv("uq/model_form.csv")
    yield (
        f"{max(int(row['pairs']) for row in rows)} surfaces, each with its own draw of the inputs, closed and opened "
        "twice: every asperity on its own (eq. 3), and all on one elastic half-space with the same hardness."
    )
    yield table(
        "Mean ± deviation over the inputs, and the shift with its 90 % interval",
        rows,
        {
            "quantity": lambda row: " ".join(_shown(row)[:1] + tuple(f"({unit})" for unit in _shown(row)[1:2] if unit)),
            "on their own": lambda row: _mean(row, "asperity"),
            "coupled": lambda row: _mean(row, "coupled"),
            "shift": lambda row: spread(row, "shift", "shift_low", "shift_high", factor=_shown(row)[2]),
            "in deviations": cell("shift_over_dev", 2),
            "median ratio": lambda row: spread(row, "ratio", "ratio_low", "ratio_high"),
        },
    )
    yield (
        "First contact, the default d_c, is the same by both: the surface touches before it deforms. A coupled cycle "
        f"costs {show(number(rows[0]['cost_ratio']), 2)} times as much."
    )


def _shown(row: Row) -> tuple[str, str, float]:
    return {**OUTPUTS, **SWITCH}[row["quantity"]]


def _mean(row: Row, name: str) -> str:
    factor = _shown(row)[2]
    return f"{show(number(row[f'{name}_mean']) * factor)} ± {show(number(row[f'{name}_dev']) * factor, 2)}"
