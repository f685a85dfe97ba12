"""The comparison of assembled pads with large surfaces, on made-up cells whose answer is known."""

import numpy as np
import pytest

from evidence.pad.large_surfaces import SIDE, comparison_rows
from mesoscale.pad.curves import Flats
from mesoscale.pad.grid import PadGrid
from mesoscale.pad.pressed import Pad

SEPARATION = np.linspace(60.0, 20.0, 81)


def made_up(count, well_kPa, press_GPa):
    net = np.broadcast_to(
        -well_kPa * 1e-6 * np.exp(-(((SEPARATION - 35.0) / 4.0) ** 2)), (count, 81)
    )
    noise = 1.0 + 1e-3 * np.arange(count)[:, None]
    forces = np.stack([press_GPa * noise * np.ones_like(net), net * noise], axis=1)
    opening = np.stack([np.stack([np.zeros_like(net), net * noise], axis=1)] * 2, axis=1)
    return Pad(
        PadGrid(SEPARATION, np.array([70, 80])),
        np.full(count, 1 / count),
        np.ones(count),
        np.full(count, 40.0),
        forces,
        opening,
        np.ones(count, bool),
        Flats(0.215, 0.165),
    )


def test_pads_are_set_beside_large_surfaces_in_their_standard_errors():
    rows = list(comparison_rows(made_up(4 * SIDE**2, 10.0, 2e-3), made_up(6, 8.0, 2e-3)))
    closing, well, _, deep = rows
    assert closing["ratio"] == pytest.approx(1.0, rel=0.05)
    assert (well["assembled_from"], well["direct_from"]) == (4, 6)
    assert well["ratio"] == deep["ratio"] == pytest.approx(10.0 / 8.0, rel=0.05)
    assert well["apart_in_errors"] > 3.0
