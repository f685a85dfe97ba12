"""The driver of the accuracy studies: rows of declared knobs, and what a key of a scene states."""

import numpy as np
import pytest

from asperity.guards.settings import key
from mesoscale.studies.driver import Knob, compared, rows_of


def test_every_case_of_every_value_is_a_row():
    """Trapezoids of x^2 and x^4 over 0 to 1 against their finest: errors fall as 1/n^2."""

    def integrals(n):
        x = np.linspace(0.0, 1.0, n + 1)
        return np.array([np.trapezoid(x**power, x) for power in (2, 4)])

    tries = [(n, lambda n=n: integrals(n)) for n in (4, 8)]
    knob = Knob("n", "error", "1024 parts", compared(lambda: integrals(1024), tries), ("square", "fourth power"))
    rows = list(rows_of([knob]))
    assert [(row["case"], row["value"]) for row in rows] == [
        (case, n) for n in (4, 8) for case in ("square", "fourth power")
    ]
    assert rows[0]["error"] == pytest.approx(1 / (6 * 4**2), rel=1e-3)
    assert rows[0]["error"] / rows[2]["error"] == pytest.approx(4, rel=1e-3)
    assert all(row["knob"] == "n" and row["wall_s"] >= 0 for row in rows)


@pytest.mark.parametrize(
    ("accepted", "bounds", "unit"),
    [
        ("(0, 30] nm", {"Gt": 0, "Le": 30}, "nm"),
        ("[-1e5, 0.5)", {"Ge": -1e5, "Lt": 0.5}, None),
        ("[1, inf)", {"Ge": 1}, None),
        ("share of the length", {}, "share of the length"),
    ],
)
def test_a_key_states_interval_and_unit(accepted, bounds, unit):
    field = key(1.0, "meaning", accepted)
    assert {type(item).__name__: getattr(item, type(item).__name__.lower()) for item in field.metadata} == bounds
    assert (field.json_schema_extra or {}).get("unit") == unit
