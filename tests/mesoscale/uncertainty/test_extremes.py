"""First contact grows with the area, the separation at a share of the force much less."""

import pytest

from mesoscale.contact.studies.stability import MIDDLE
from mesoscale.settings import ContactSettings, LawSettings
from mesoscale.uncertainty.studies import extremes


def test_extremes_of_small_surfaces(monkeypatch):
    monkeypatch.setattr(extremes, "CELLS", 24)
    monkeypatch.setattr(extremes, "DIRECT", {2: 3})
    rows = list(extremes.extreme_rows(MIDDLE, ContactSettings(pixels=64), LawSettings()))
    found = {(row["quantity"], row["area_in_cells"], row["method"]): row["mean_nm"] for row in rows}
    growth = found["first contact", 4, "cells"] - found["first contact", 1, "cells"]
    # Gumbel's ln 4 in units of a scatter of 2 to 4 nm, known to 20 % from 24 cells
    assert 1.0 < growth < 6.0
    assert found["first contact", 4, "gumbel"] == pytest.approx(found["first contact", 4, "cells"], abs=1.5)
    assert abs(found["share of force", 4, "cells"] - found["share of force", 1, "cells"]) < growth
    assert found["first contact", 4, "direct"] > found["share of force", 4, "direct"]
