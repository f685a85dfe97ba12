"""The detector of yield keeps its bounds at the noise of most runs of scene reduced."""

from argparse import Namespace

import pytest

from evidence.hardness.detection import rows


@pytest.mark.parametrize(
    ("noise", "correlation", "background"),
    [(0.01, 0.2, 2.0), (0.057, 0.2, 36.0), (0.057, 0.4, 36.0)],
)
def test_rates_keep_their_bounds(noise, correlation, background):
    given = Namespace(noise=[noise], correlation=[correlation], background=background, trials=100)
    made = list(rows(given))
    assert [row["case"] for row in made if row["rate"] > row["bound"]] == []
    [stopped] = [row["rate"] for row in made if row["case"] == "stopped_by_its_rule"]
    # the nominal interval is of 68 %: neither too narrow nor too wide
    assert stopped == pytest.approx(0.32, abs=0.1)
