"""The detector of yield keeps its bounds where the noise is that of the median run, or less."""

from argparse import Namespace

import pytest

from evidence.hardness.detection import rows


@pytest.mark.parametrize(("noise", "correlation", "background"), [(0.01, 0.0, 2.0), (0.042, 0.0, 36.0)])
def test_rates_keep_their_bounds(noise, correlation, background):
    given = Namespace(noise=[noise], correlation=[correlation], background=background, trials=100)
    assert [row["case"] for row in rows(given) if row["rate"] > row["bound"]] == []
