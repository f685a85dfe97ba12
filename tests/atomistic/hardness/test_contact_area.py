"""Contact area against constructed geometries of known area."""

import numpy as np
import pytest

from asperity.guards.errors import InputError
from atomistic.hardness.contact_area import Area, calibrated, contact_area, contact_map

AREA = Area()
FINE = Area(grid_A=0.1)

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


def test_one_atom_is_a_disc_of_the_rim():
    area = contact_area(np.array([[30.0, 30.0]]), CELL, FINE, MIDDLE)
    # a tenth of an Å of grid on its radius
    assert area == pytest.approx(np.pi * AREA.rim_A**2, rel=0.05)


def test_nothing_touches():
    assert contact_area(np.empty((0, 2)), CELL, AREA, MIDDLE) == 0


def test_everything_touches():
    places = np.stack(np.meshgrid(np.arange(0, 60, 3.0), np.arange(0, 60, 3.0)), axis=-1).reshape(
        -1, 2
    )
    assert contact_area(places, CELL, AREA, MIDDLE) == pytest.approx(3600)


def test_position_in_the_periodic_cell_does_not_matter():
    rng = np.random.default_rng(0)
    cloud = rng.uniform(-8, 8, (60, 2))
    inside = contact_area(cloud + 30, CELL, AREA, MIDDLE)
    corner = contact_area(np.mod(cloud, 60), CELL, AREA, (0.0, 0.0))
    assert corner == pytest.approx(inside, rel=1e-12)


def test_enclosed_holes_are_contact_and_wide_bays_are_not():
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    ring = 30 + 10 * np.column_stack([np.cos(angle), np.sin(angle)])
    closed = contact_area(ring, CELL, FINE, MIDDLE)
    opened = contact_area(ring[angle > 1.2], CELL, FINE, MIDDLE)
    assert closed == pytest.approx(np.pi * (10 + AREA.rim_A) ** 2, rel=0.02)
    assert opened < 0.5 * closed


def test_space_between_atoms_counts_where_the_closing_disc_does_not_fit():
    """Four atoms at the corners of a square of 6 Å: its middle is 4.2 Å from each, so only a larger
    disc closes it.
    """
    corners = 30 + np.array([[-3.0, -3.0], [-3.0, 3.0], [3.0, -3.0], [3.0, 3.0]])
    whole = contact_area(corners, CELL, Area(grid_A=0.1, closing_A=4.5), MIDDLE)
    assert whole > 36
    apart = contact_area(corners, CELL, Area(grid_A=0.1, closing_A=2.5), MIDDLE)
    assert apart == pytest.approx(4 * np.pi * AREA.rim_A**2, rel=0.08)


@pytest.mark.parametrize("radius", [10.0, 15.0, 22.0])
def test_flat_punch_of_glass_density(radius):
    """The end of a cylinder: the rim reaches past it by less than its radius."""
    atoms = random_solid(np.random.default_rng(1))
    punch = atoms[np.hypot(atoms[:, 0] - 30, atoms[:, 1] - 30) < radius]
    touching = punch[punch[:, 2] > 27.0, :2]
    area = contact_area(touching, CELL, AREA, MIDDLE)
    assert np.pi * radius**2 * 0.95 < area < np.pi * (radius + 1.6) ** 2


def test_sphere_cut_by_a_plane():
    """Rigid overlap d of a sphere R has the area pi (2 R d - d^2).

    Discs of 1.5 Å found 80 % of it.  A rigid cut has no layer of atoms at the counterface, as a
    pressed body has (docs/hardness.md), so some of its rim stays empty.
    """
    rng = np.random.default_rng(2)
    sphere, ratios = 25.0, []
    for overlap in (4.0, 6.0):
        for _ in range(8):
            atoms = random_solid(rng, 60.0)
            inside = atoms[np.linalg.norm(atoms - [30, 30, 25], axis=1) < sphere]
            touching = inside[inside[:, 2] > 50 - overlap - AREA.depth_A, :2]
            exact = np.pi * (2 * sphere * overlap - overlap**2)
            ratios.append(contact_area(touching, CELL, AREA, MIDDLE) / exact)
    assert 0.9 < np.mean(ratios) < 1.0


def test_the_map_is_centred():
    marked = contact_map(np.array([[15.0, 15.0]]), CELL, AREA, (15.0, 15.0))
    where = np.argwhere(marked).mean(axis=0)
    np.testing.assert_allclose(where, (np.array(marked.shape) - 1) / 2, atol=1)


def test_potential_without_calibration(potential):
    assert calibrated(potential) == 0.05
    with pytest.raises(
        InputError, match="potential pmmcs: no calibration of the contact area; measure it"
    ):
        calibrated(potential.model_copy(update={"contact_area": None}))
