"""Contact area against constructed geometries of known area."""

from pathlib import Path

import numpy as np
import pytest
from atomistic.hardness.studies.area import FLANKS, Layer, area_rows, cut_layer

from atomistic.errors import InputError
from atomistic.hardness.contact_area import contact_area, contact_map, require_calibration
from atomistic.potentials import load_potential
from atomistic.settings import AreaSettings

POTENTIALS = Path(__file__).parents[3] / "config" / "potentials"

AREA = AreaSettings()
FINE = AreaSettings(grid_A=0.1)

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
    assert area == pytest.approx(np.pi * AREA.rim_A**2, rel=0.05)  # a tenth of an Å of grid on its radius


def test_nothing_touches():
    assert contact_area(np.empty((0, 2)), CELL, AREA, MIDDLE) == 0


def test_everything_touches():
    places = np.stack(np.meshgrid(np.arange(0, 60, 3.0), np.arange(0, 60, 3.0)), axis=-1).reshape(-1, 2)
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
    """Four atoms at the corners of a square of 6 Å: its middle is 4.2 Å from each, so only a larger disc closes it."""
    corners = 30 + np.array([[-3.0, -3.0], [-3.0, 3.0], [3.0, -3.0], [3.0, 3.0]])
    whole = contact_area(corners, CELL, FINE.model_copy(update={"closing_A": 4.5}), MIDDLE)
    assert whole > 36
    apart = contact_area(corners, CELL, FINE.model_copy(update={"closing_A": 2.5}), MIDDLE)
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

    Discs of 1.5 Å found 80 % of it.  A rigid cut has no layer of atoms at the counterface, as a pressed body has
    (docs/hardness.md), so some of its rim stays empty.
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


@pytest.mark.parametrize("shape", FLANKS)
def test_flanks_widen_from_the_section(shape):
    """At the plane of contact a flank has the section's area, below it more; of the sphere, pi (R^2 - z^2)."""
    at_plane = float(FLANKS[shape](np.zeros(1), 40.0)[0])
    area = np.pi * at_plane**2 if shape == "sphere" else (2 * at_plane) ** 2
    assert area == pytest.approx(1600, rel=1e-9)
    assert FLANKS[shape](np.array([1.0]), 40.0)[0] > at_plane + 1  # slopes of about 0.6
    if shape == "sphere":
        radius = 2 * at_plane
        assert FLANKS[shape](np.array([at_plane * np.sqrt(3)]), 40.0)[0] == pytest.approx(radius)


def test_dense_layer_has_its_known_area():
    """Atoms on a lattice of 1 Å in the plane of contact: what is left is grid and rim, below 5 % from 3 nm on."""
    places = np.stack(np.meshgrid(np.arange(20.0), np.arange(20.0)), axis=-1).reshape(-1, 2)
    layer = Layer(20.0, places, np.zeros(len(places)), np.zeros(len(places)))
    thin = AREA.model_copy(update={"rim_A": 0.5})  # half the lattice's spacing
    rows = list(area_rows([layer], thin, {}))
    assert len(rows) == 15
    assert {row["case"] for row in rows if row["value"] >= 3 and not row["passed"]} == set()
    cut, _ = cut_layer(layer, "wave", 40.0, np.random.default_rng(0))
    assert len(cut) == pytest.approx(1600, rel=0.06)


def test_potential_without_calibration(potential):
    assert require_calibration(potential, AREA).error <= 0.06
    with pytest.raises(InputError, match="potential pmmcs: no calibration of the contact area; run target hard"):
        require_calibration(potential.model_copy(update={"contact_area": None}), AREA)
    other = AreaSettings(depth_A=1)
    with pytest.raises(InputError, match=r"hardness.area.depth_A = 1: potential pmmcs is calibrated with 0.5 A"):
        require_calibration(potential, other)


def test_a_counterface_of_other_atoms_has_a_calibration_of_its_own(potential):
    titania = load_potential(POTENTIALS / "matsui_akaogi.yaml")
    calibrated = AREA.model_copy(update={"touch_A": 2.55})
    assert require_calibration(potential, calibrated, titania).error == 0.04
    with pytest.raises(InputError, match=r"touch_A = 2.4: potential pmmcs is calibrated with 2.55 A"):
        require_calibration(potential, AREA, titania)
    with pytest.raises(InputError, match="potential pmmcs: no calibration of the contact area against teter; run"):
        require_calibration(potential, AREA, load_potential(POTENTIALS / "teter.yaml"))
    assert require_calibration(potential, AREA, potential) == require_calibration(potential, AREA)
