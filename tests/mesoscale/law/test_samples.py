"""Total pressure of the law, and its band over many samples."""

import numpy as np
import pytest

from mesoscale.law.parameters import BRANCHES
from mesoscale.law.samples import band_rows

NUMBERS = {"d_c_nm": 31.8, "C_a_GPa_nm": 0.0, "C_r_GPa": 6.4e-4, "rho_r_nm": 3.31}


def test_the_band_is_that_of_the_samples_with_a_law():
    """Samples that differ by a factor on the repulsion: quantiles of the factor, where nothing
    attracts.
    """
    factors = np.linspace(0.5, 1.5, 101)
    columns = {
        f"{branch}_{name}": np.full(103, value)
        for branch in BRANCHES
        for name, value in NUMBERS.items()
    }
    for branch in BRANCHES:
        # two without a law
        columns[f"{branch}_C_r_GPa"] = np.append(factors * 6.4e-4, [np.nan, -1.0])
    rows = list(band_rows(columns | {"hamaker": np.zeros(103)}, points=40))
    assert [row["branch"] for row in rows] == ["closing"] * 40 + ["opening"] * 40
    touching = [row for row in rows if row["gap_nm"] < 31.0]
    for row in touching:
        low, middle, high = (row[f"pressure_q{q}_GPa"] for q in ("05", "50", "95"))
        assert low / middle == pytest.approx(0.55)
        assert high / middle == pytest.approx(1.45)
