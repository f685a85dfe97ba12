"""The driver of the studies: rows of declared knobs and of hard cases, and what a key of a scene
states.
"""

from functools import partial

import numpy as np
import pytest

from asperity.guards.settings import key
from mesoscale.studies.driver import (
    Choice,
    HardCase,
    Knob,
    Quantity,
    root_mean_square,
    rows_of,
    stability_rows,
)


def integrals(parts: int, ends: tuple[float, ...] = (1.0, 2.0, 3.0)) -> np.ndarray:
    """Trapezoids of x^2 and x^4 from 0 to each end, shape (ends, 2)."""
    values = []
    for end in ends:
        x = np.linspace(0.0, end, parts + 1)
        values.append([np.trapezoid(x**power, x) for power in (2, 4)])
    return np.array(values)


def knob_of(quantities: list[Quantity], shipped: int = 8) -> Knob:
    choices = [Choice(parts, partial(integrals, parts)) for parts in (4, 8)]
    return Knob(
        "parts", quantities, choices, shipped, "1024 parts", partial(integrals, 1024), "3 intervals"
    )


def test_every_quantity_of_every_value_is_a_row():
    """The error of trapezoids of x^2 over 0 to b is b^3 / 6 n^2."""
    rows = list(rows_of([knob_of([Quantity("square", "m"), Quantity("fourth power", "m")])]))
    assert [(row["case"], row["value"], row["shipped"]) for row in rows] == [
        ("square", 4, False),
        ("fourth power", 4, False),
        ("square", 8, True),
        ("fourth power", 8, True),
    ]
    expected = np.sqrt(np.mean([(end**3 / (6 * 4**2)) ** 2 for end in (1, 2, 3)]))
    assert rows[0]["error"] == pytest.approx(expected, rel=1e-3)
    assert rows[0]["error"] / rows[2]["error"] == pytest.approx(4, rel=1e-3)
    assert all(
        row["knob"] == "parts" and row["wall_s"] >= 0 and row["peak_rss_MB"] > 0 for row in rows
    )
    assert rows[0]["reference"] == "1024 parts; 3 intervals"


def test_errors_in_per_cent_are_of_the_reference_or_of_a_scale_and_volts_follow():
    rows = list(
        rows_of(
            [
                knob_of(
                    [
                        Quantity("square", "%", volts=-0.5),
                        Quantity("fourth power", "% of 10", scale=10.0),
                    ]
                )
            ]
        )
    )
    # x^2 from 0 to b: b^3 / 3, so that the error is 100 / 2 n^2 % at every end
    assert rows[0]["error"] == pytest.approx(100 / (2 * 4**2), rel=1e-3)
    assert rows[0]["own_error"] == pytest.approx(0.0, abs=1e-9)
    assert rows[0]["release_V"] == pytest.approx(0.5 * rows[0]["error"])
    assert rows[1]["release_V"] is None


def test_the_error_of_a_root_mean_square_is_that_of_its_scatter():
    """2,000 sets of 8 normal deviations: their own errors tell how the root mean squares
    scatter.
    """
    sets = np.random.default_rng(1).normal(size=(2000, 8, 1))
    told = np.array([root_mean_square(deviations) for deviations in sets])[:, :, 0]
    assert np.mean(told[:, 1]) == pytest.approx(told[:, 0].std(), rel=0.1)
    errors, own = root_mean_square([[3.0], [np.nan]])
    assert errors[0] == 3.0
    assert np.isnan(own[0])


def test_a_case_that_raises_has_failed_and_the_others_run():
    def lost() -> tuple[bool, str]:
        raise ArithmeticError("lost\nits way")

    cases = [HardCase("one", "", "", lost), HardCase("two", "", "", lambda: (True, "fine"))]
    rows = list(stability_rows(cases))
    assert [(row["case"], row["passed"], row["detail"]) for row in rows] == [
        ("one", False, "ArithmeticError: lost its way"),
        ("two", True, "fine"),
    ]


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
    assert {
        type(item).__name__: getattr(item, type(item).__name__.lower()) for item in field.metadata
    } == bounds
    assert (field.json_schema_extra or {}).get("unit") == unit
