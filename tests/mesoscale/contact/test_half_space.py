"""The elastic half-space beside single asperities: Hertz, and one line where the library is missing."""

import sys

import numpy as np
import pytest

from mesoscale.contact.studies.half_space import compare, solve_half_space
from mesoscale.contact.studies.stability import MIDDLE
from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings, CouplingSettings


def test_half_space_meets_hertz():
    pytest.importorskip("tamaas", reason="optional extra peers is not installed")
    n, length, radius, e_star, load = 256, 200.0, 100.0, 91.0, 1213.3
    x = (np.arange(n) - n / 2) * length / n
    heights = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)
    found = solve_half_space(heights, length, e_star, load, CouplingSettings())
    # contact radius 10 nm; the grid's site is 0.8 nm wide
    assert np.sqrt(found.contact_area_nm2 / np.pi) == pytest.approx(10.0, rel=0.03)
    assert found.error <= CouplingSettings().tolerance


def test_comparison_of_a_rough_surface():
    pytest.importorskip("tamaas", reason="optional extra peers is not installed")
    settings = CouplingSettings(surfaces=1, pixels=64, loads_nN=[1000.0, 7000.0])
    rows = list(compare(MIDDLE, ContactSettings(), settings))
    assert len(rows) == 4
    assert all(row["solved"] for row in rows)
    assert all(np.isfinite(row["force_ratio"]) for row in rows)
    light, heavy = (row for row in rows if row["prefactor"] == "hertz")
    assert heavy["separation_coupled_nm"] < light["separation_coupled_nm"]


def test_a_missing_library_is_one_line(monkeypatch):
    monkeypatch.setitem(sys.modules, "tamaas", None)
    with pytest.raises(InputError, match="--extra peers"):
        solve_half_space(np.zeros((32, 32)), 100.0, 91.0, 1.0, CouplingSettings())


def test_no_surface_is_refused():
    with pytest.raises(InputError, match=r"coupling\.surfaces = 0"):
        next(compare(MIDDLE, ContactSettings(), CouplingSettings()))
