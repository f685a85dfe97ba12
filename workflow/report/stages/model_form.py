"""Asperities on their own beside coupled ones: what the choice of the mechanics changes."""

import numpy as np

from workflow.report.available import Results
from workflow.report.numbers import OUTPUTS, number, show
from workflow.report.page import COMPUTED, Section, Table

SWITCH = {
    "pull_off_nN": ("pull-off", "nN", 1.0),
    "opening_stiffness_nN_nm": ("opening stiffness", "nN/nm", 1.0),
}


def describe(results: Results) -> Section | None:
    """The shift of every output."""
    if not results.has("uq/model_form.csv"):
        return None
    rows = results.csv("uq/model_form.csv")
    section = Section(
        "model-form",
        "What coupling changes",
        f"{max(int(row['pairs']) for row in rows)} surfaces, each with its own draw of the inputs, closed and opened "
        "twice: every asperity on its own (eq. 3), and all on one elastic half-space with the same hardness.",
        COMPUTED,
    )
    lines = []
    for row in rows:
        symbol, unit, factor = {**OUTPUTS, **SWITCH}[row["quantity"]]
        label = f"{symbol} ({unit})" if unit else symbol
        means = [
            f"{show(number(row[f'{name}_mean']) * factor)} ± {show(number(row[f'{name}_dev']) * factor, 2)}"
            for name in ("asperity", "coupled")
        ]
        shift = _interval([number(row[f"shift{end}"]) * factor for end in ("", "_low", "_high")])
        ratio = _interval([number(row[f"ratio{end}"]) for end in ("", "_low", "_high")])
        lines.append((label, *means, shift, show(row["shift_over_dev"], 2), ratio))
    section.blocks.append(
        Table(
            "Mean ± deviation over the inputs, and the shift with its 90 % interval",
            ("quantity", "on their own", "coupled", "shift", "in deviations", "median ratio"),
            lines,
        )
    )
    section.notes.append(
        "First contact, the default d_c, is the same by both: the surface touches before it deforms. A coupled cycle "
        f"costs {show(number(rows[0]['cost_ratio']), 2)} times as much."
    )
    section.files.append("uq/model_form.csv")
    return section


def _interval(values: list[float]) -> str:
    value, low, high = values
    if not np.isfinite(value):
        return "–"
    return f"{show(value)} [{show(low)}, {show(high)}]"
