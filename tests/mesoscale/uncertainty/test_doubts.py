"""What makes an output doubtful: a response that explains too little, or that contradicts
physics.
"""

import numpy as np
import pytest

from mesoscale.inputs.table import input_table
from mesoscale.uncertainty.doubts import against_physics, explained
from mesoscale.uncertainty.surrogate import Surrogate

TABLE = input_table()
MOST_GPA = 0.007


def _pairs(count, inputs, surfaces, error):
    """An output on two surfaces at equal inputs, and a prediction, with these standard
    deviations.
    """
    rng = np.random.default_rng(4)
    truth = inputs * rng.normal(size=count)
    first, second = (truth + surfaces * rng.normal(size=count) for _ in range(2))
    return first, second, truth + error * rng.normal(size=count)


def _row(*args):
    return explained(*_pairs(*args), np.random.default_rng(1))


@pytest.mark.parametrize("surfaces", [0.1, 1.0, 2.0])
def test_scatter_between_surfaces_is_not_held_against_a_response(surfaces):
    """A response that is right has 1, whatever the surfaces do; Q² would be 0.99, 0.5 and 0.2."""
    row = _row(4000, 1.0, surfaces, 0.0)
    # standard error of a covariance of 4000 pairs: at most (1 + surfaces²)/sqrt(4000) = 0.08
    assert row["explained"] == pytest.approx(1.0, abs=0.16)
    assert row["surface_share"] == pytest.approx(surfaces**2 / (1.0 + surfaces**2), abs=0.05)
    assert row["doubt"] == ""


def test_a_response_with_an_error_fails():
    row = _row(400, 1.0, 1.0, 0.7)
    assert row["explained"] == pytest.approx(1.0 - 0.7**2, abs=0.2)
    assert "of what the inputs explain" in row["doubt"]


def test_nothing_but_scatter_is_no_success():
    row = _row(100, 0.0, 1.0, 0.0)
    assert np.isnan(row["explained"])
    assert row["doubt"].startswith("nothing but scatter between surfaces")


def _responses(**slopes):
    """d_c, C_a, C_r and ρ_r of closing and opening; `slopes` are of a logarithm along an input's
    scaled range.
    """
    inputs = len(TABLE.names)
    responses = []
    for branch, values in (
        ("closing", (30.0, 1.5e-4, 6e-4, 3.3)),
        ("opening", (29.0, 2e-4, 6e-4, 3.0)),
    ):
        for name, value in zip(("d_c", "C_a", "C_r", "rho_r"), values, strict=True):
            coefficients = np.zeros(inputs + 1)
            coefficients[0] = np.log(value) if name != "d_c" else value
            if name == "C_a":
                low, high = TABLE.ranges()[TABLE.names.index("hamaker")]
                coefficients[1 + TABLE.names.index("hamaker")] = 0.5 * np.log(high / low)
            for key, slope in slopes.items():
                place, _, moved = key.partition("__")
                if place == f"{branch}_{name}":
                    coefficients[1 + TABLE.names.index(moved)] += slope
            degrees = np.vstack([np.zeros(inputs, int), np.eye(inputs, dtype=int)])
            transform = "identity" if name == "d_c" else "log"
            responses.append(Surrogate(TABLE.ranges(), degrees, coefficients, transform))
    return responses


def test_a_law_that_obeys_physics_raises_no_doubt():
    assert against_physics(_responses(), TABLE, MOST_GPA) == {}
    assert (
        against_physics(
            _responses(closing_C_r__e_star=0.1, closing_C_r__h_macro=0.1), TABLE, MOST_GPA
        )
        == {}
    )


@pytest.mark.parametrize(
    ("moved", "symbol"), [("e_star", "E*"), ("h_macro", "H_macro"), ("h_prime", "H′")]
)
def test_a_pressure_that_falls_where_the_material_stiffens_is_doubted(moved, symbol):
    found = against_physics(_responses(**{f"closing_C_r__{moved}": -0.1}), TABLE, MOST_GPA)
    assert set(found) == {"C_r_GPa", "rho_r_nm"}
    assert f"falls by 20% where {symbol} rises" in found["C_r_GPa"]  # exp(0.1) - exp(-0.1)


def test_attraction_goes_with_the_hamaker_constant():
    found = against_physics(_responses(closing_C_a__hamaker=0.2), TABLE, MOST_GPA)
    assert set(found) == {"C_a_GPa_nm"}
    assert "where the Hamaker constant rises by 39%" in found["C_a_GPa_nm"]


def test_opening_presses_no_harder_than_closing_at_equal_separation():
    found = against_physics(_responses(opening_d_c__rms=3.0), TABLE, MOST_GPA)
    assert set(found) == {"delta_C_r_GPa", "delta_rho_r_nm"}
    assert "opening presses harder" in found["delta_C_r_GPa"]
