"""Contact area against constructed geometries of known area."""

import numpy as np
import pytest

from atomistic.hardness.contact_area import contact_area, contact_map
from atomistic.settings import AreaSettings

AREA = AreaSettings()

CELL = (60.0, 60.0)
MIDDLE = (30.0, 30.0)
DENSITY = 0.066  # atoms per Å^3 in silica glass


def random_solid(rng, height=30.0):
    """Atoms of glass density in a CELL x height block, one at a random place of each small box."""
    spacing = DENSITY ** (-1 / 3)
    counts = [int(length / spacing) for length in (*CELL, height)]
    grid = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3)
    box = np.array([*CELL, height])
    return (grid + rng.uniform(0, 1, grid.shape)) * box / counts


def test_one_disc():
    area = contact_area(np.array([[30.0, 30.0]]), CELL, 1.6, 0.1, MIDDLE)
    assert area == pytest.approx(np.pi * 1.6**2, rel=0.02)


def test_nothing_touches():
    assert contact_area(np.empty((0, 2)), CELL, 1.6, 0.5, MIDDLE) == 0


def test_position_in_the_periodic_cell_does_not_matter():
    rng = np.random.default_rng(0)
    cloud = rng.uniform(-8, 8, (60, 2))
    inside = contact_area(cloud + 30, CELL, 1.6, 0.5, MIDDLE)
    corner = contact_area(np.mod(cloud, 60), CELL, 1.6, 0.5, (0.0, 0.0))
    assert corner == pytest.approx(inside, rel=1e-12)


def test_enclosed_holes_are_contact_and_open_bays_are_not():
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    ring = 30 + 10 * np.column_stack([np.cos(angle), np.sin(angle)])
    closed = contact_area(ring, CELL, 1.6, 0.25, MIDDLE)
    opened = contact_area(ring[angle > 0.6], CELL, 1.6, 0.25, MIDDLE)
    assert closed == pytest.approx(np.pi * 11.6**2, rel=0.02)
    assert opened < 0.5 * closed


@pytest.mark.parametrize("radius", [10.0, 15.0, 22.0])
def test_flat_punch_of_glass_density(radius):
    """The end of a cylinder: the discs reach past its rim by less than their radius."""
    atoms = random_solid(np.random.default_rng(1))
    punch = atoms[np.hypot(atoms[:, 0] - 30, atoms[:, 1] - 30) < radius]
    touching = punch[punch[:, 2] > 27.0, :2]
    area = contact_area(touching, CELL, 1.6, 0.5, MIDDLE)
    assert np.pi * radius**2 * 0.9 < area < np.pi * (radius + 1.6) ** 2


@pytest.mark.parametrize(("depth_A", "low", "high"), [(AREA.depth_A, 0.75, 0.86), (1.5, 0.95, 1.03)])
def test_sphere_cut_by_a_plane(depth_A, low, high):
    """Rigid overlap d of a sphere R has the area pi (2 R d - d^2).

    The default depth of 0.5 Å finds 80 % of it, 1.5 Å all of it (docs/hardness.md: the definition of area is the
    largest systematic error of the hardness).
    """
    rng = np.random.default_rng(2)
    sphere, ratios = 25.0, []
    for overlap in (4.0, 6.0):
        for _ in range(8):
            atoms = random_solid(rng, 60.0)
            inside = atoms[np.linalg.norm(atoms - [30, 30, 25], axis=1) < sphere]
            touching = inside[inside[:, 2] > 50 - overlap - depth_A, :2]
            exact = np.pi * (2 * sphere * overlap - overlap**2)
            ratios.append(contact_area(touching, CELL, AREA.disc_A, AREA.grid_A, MIDDLE) / exact)
    assert low < np.mean(ratios) < high


def test_the_map_is_centred():
    marked = contact_map(np.array([[15.0, 15.0]]), CELL, 1.6, 0.5, (15.0, 15.0))
    where = np.argwhere(marked).mean(axis=0)
    np.testing.assert_allclose(where, (np.array(marked.shape) - 1) / 2, atol=1)
