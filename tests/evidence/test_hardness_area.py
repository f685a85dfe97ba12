"""Bodies of known section: the cuts have it."""

import numpy as np
import pytest

from atomistic.hardness.contact_area import Area
from evidence.hardness.area import FLANKS, Layer, cut_bodies, cut_layer


@pytest.mark.parametrize("shape", FLANKS)
def test_flanks_widen_from_the_section(shape):
    """At the plane of contact a flank has the section's area, below it more; of the sphere, pi (R^2
    - z^2).
    """
    at_plane = float(FLANKS[shape](np.zeros(1), 40.0)[0])
    area = np.pi * at_plane**2 if shape == "sphere" else (2 * at_plane) ** 2
    assert area == pytest.approx(1600, rel=1e-9)
    assert FLANKS[shape](np.array([1.0]), 40.0)[0] > at_plane + 1  # slopes of about 0.6
    if shape == "sphere":
        radius = 2 * at_plane
        assert FLANKS[shape](np.array([at_plane * np.sqrt(3)]), 40.0)[0] == pytest.approx(radius)


def test_dense_layer_has_its_known_area():
    """Atoms on a lattice of 1 Å in the plane of contact: what is left is grid and rim, below 5 %
    from 3 nm on.
    """
    places = np.stack(np.meshgrid(np.arange(20.0), np.arange(20.0)), axis=-1).reshape(-1, 2)
    layer = Layer(20.0, places, np.zeros(len(places)), np.zeros(len(places)))
    thin = Area(rim_A=0.5)  # half the lattice's spacing
    rows = list(cut_bodies([layer], thin))
    assert len(rows) == 15
    assert max(abs(row["error"]) for row in rows if row["length_nm"] >= 3) <= 0.05
    cut, _ = cut_layer(layer, "wave", 40.0, np.random.default_rng(0))
    assert len(cut) == pytest.approx(1600, rel=0.06)
