"""Scores of predictions: exact cases, files that are refused, and the stiffness behind the first
one.
"""

import numpy as np
import pytest
from scipy.special import ndtri

from evidence.predictions.indentation import TIP, stiffness_GPa
from evidence.predictions.score import HERE, LEVELS, crps, registered, scored


def test_the_score_is_that_of_exact_cases():
    assert crps([3.0] * len(LEVELS), 5.0) == pytest.approx(2.0)  # no width: the absolute error
    # a standard normal at its median: (sqrt 2 - 1) / sqrt pi (Gneiting and Raftery 2007, eq. 21)
    assert crps(ndtri(LEVELS).tolist(), 0.0) == pytest.approx(
        (np.sqrt(2.0) - 1.0) / np.sqrt(np.pi), rel=0.03
    )
    assert scored([*range(len(LEVELS))], 11)["held"] is False
    assert scored([*range(len(LEVELS))], None)["crps"] is None


def test_a_prediction_without_a_date_or_with_falling_quantiles_is_one_line(tmp_path):
    shipped = (HERE / "indentation.yaml").read_text()
    assert registered(HERE / "indentation.yaml")["values"]
    for change, line in (
        (("date:", "when:"), "date missing"),
        (("0.758, 0.882", "0.882, 0.758"), "quantiles at 50 nm: 11 that rise"),
    ):
        path = tmp_path / "changed.yaml"
        path.write_text(shipped.replace(*change))
        with pytest.raises(ValueError, match=line) as refused:
            registered(path)
        assert "\n" not in str(refused.value)


def test_a_contact_feels_the_film_alone_and_then_both_as_gao_says():
    film, base = ((1.0 - nu**2) / young for young, nu in ((72.0, 0.17), (165.0, 0.22)))
    tip = (1.0 - TIP.poisson**2) / TIP.young_GPa
    small, *both = stiffness_GPa(72.0, 165.0, 500.0, np.array([1.0, 50.0, 500.0, 6000.0]))
    assert small == pytest.approx(1.0 / (film + tip), rel=2e-3)
    # Gao, Chiu and Lee 1992: I0 of t/a, first order
    for found, x in zip(both, (10.0, 1.0, 1 / 12), strict=True):
        sides = 0.6 * x * np.log1p(x**-2) - x / (1 + x**2)
        share = 2 / np.pi * np.arctan(x) + sides / (1.6 * np.pi)
        assert found == pytest.approx(1.0 / (share * film + (1.0 - share) * base + tip), rel=0.02)
