"""Contacts that are hard to solve: few sites or all, jumps, extreme stiffness, hardness and grids.

Each is closed in few large steps by both ways of solving, a matrix of the known sites and
transforms of the whole grid. Both must settle, meet the conditions of contact at every site, and
agree.
"""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.contact.coupled import dense, grid
from mesoscale.contact.coupled.engine import CoupledContact
from mesoscale.settings import ContactSettings
from mesoscale.topography.synthesis import synthesize
from tests.mesoscale.contact.test_coupled import INPUTS

N = 48
ROW, COL = np.mgrid[:N, :N]
ROUGH = synthesize(N, 50.0, 0.2, 0.75, 2.0, 4)
NOISE = np.random.default_rng(1).standard_normal((N, N))
SOFT_FILM = [
    [{"young_GPa": 0.1, "poisson": 0.3, "thickness_nm": 2.0}, {"young_GPa": 100, "poisson": 0.3}]
]
HARD_FILM = [
    [{"young_GPa": 1e5, "poisson": 0.3, "thickness_nm": 2.0}, {"young_GPa": 100, "poisson": 0.3}]
]


def spike(*sites: tuple[int, int]) -> np.ndarray:
    """A plane with single sites 3 nm nearer to the flat."""
    heights = np.zeros((N, N))
    for site in sites:
        heights[site] = -3.0
    return heights


def constant(hardness: float):
    """Inputs of one hardness (GPa) for contacts of all sizes."""
    return replace(INPUTS, h_macro=hardness, h_prime=0.0)


# heights (nm), steps in RMS heights from first contact, settings, inputs
CASES = {
    "one site": (spike((5, 7)), (0.5, 2.0), {}, INPUTS),
    "one site that yields": (spike((5, 7)), (0.5, 2.0), {"model": "plastic"}, INPUTS),
    "two sites beside each other": (spike((5, 7), (5, 8)), (0.5, 2.0), {}, INPUTS),
    "two sites across the edge": (spike((0, 7), (N - 1, 7)), (0.5, 2.0), {}, INPUTS),
    "a comb": (np.where(COL % 2, 3.0, 0.0) + 1e-3 * NOISE, (0.05, 0.2), {}, INPUTS),
    "a chessboard": (np.where((ROW + COL) % 2, 3.0, 0.0) + 1e-3 * NOISE, (0.05, 0.2), {}, INPUTS),
    "a step of half the cell": (
        np.where(ROW < N // 2, 2.0, 0.0) + 1e-2 * NOISE,
        (0.05, 0.3),
        {},
        INPUTS,
    ),
    "a wall one site wide": (np.where(ROW == 3, 0.0, 5.0), (0.2, 1.0), {}, INPUTS),
    "a saw tooth": (0.2 * ROW + 1e-3 * NOISE, (0.5, 1.2), {}, INPUTS),
    "one long wave": (
        np.cos(2 * np.pi * ROW / N) * np.cos(2 * np.pi * COL / N),
        (0.5, 1.5),
        {},
        INPUTS,
    ),
    "nearly full contact": (0.05 * np.cos(2 * np.pi * ROW / N), (1.2, 1.40), {}, INPUTS),
    "a plane but for rounding": (1e-9 * NOISE, (0.5, 1.5), {}, INPUTS),
    "white noise": (NOISE, (1.0, 2.5), {}, INPUTS),
    "50 nm rough": (25.0 * ROUGH, (0.5, 1.5), {}, INPUTS),
    "a step of half the RMS": (ROUGH, (0.5,), {}, INPUTS),
    "steps of the RMS": (ROUGH, (1.0, 2.0, 2.5), {}, INPUTS),
    "out again in one step": (ROUGH, (2.0, 0.1), {}, INPUTS),
    "steps of the RMS that yield": (ROUGH, (1.0, 2.0), {"model": "plastic"}, INPUTS),
    "60 % yield": (ROUGH, (1.0, 2.3), {"model": "plastic"}, constant(2.0)),
    "softer than its elasticity": (ROUGH, (0.5, 1.5), {"model": "plastic"}, constant(1e-3)),
    "harder than any stress": (ROUGH, (0.5, 1.5), {"model": "plastic"}, constant(1e3)),
    "hardness of clusters, capped": (ROUGH, (0.5, 1.5), {"model": "nonlinear"}, INPUTS),
    "E* of rubber": (ROUGH, (0.5, 2.0), {}, replace(INPUTS, e_star=1e-3)),
    "E* of 2 TPa": (ROUGH, (0.5, 2.0), {}, replace(INPUTS, e_star=2e3)),
    "a layer a thousandth as stiff": (ROUGH, (0.5, 2.0), {"bodies": SOFT_FILM}, INPUTS),
    "a layer a thousand times as stiff": (ROUGH, (0.5, 2.0), {"bodies": HARD_FILM}, INPUTS),
    "an odd grid": (synthesize(47, 50.0, 0.2, 0.75, 2.0, 4), (0.5, 2.0), {}, INPUTS),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_both_ways_settle_and_agree(case):
    heights, steps, changes, inputs = case
    settings = ContactSettings(
        **{
            "mechanics": "coupled",
            "model": "elastic",
            "pixels": len(heights),
            "length_nm": 50.0,
            **changes,
        }
    )
    few, whole = (CoupledContact(heights.copy(), inputs, settings) for _ in range(2))
    whole.dense = 0
    first = few.touching_separation
    for step in steps:
        for contact in (few, whole):
            assert contact.move_to(first - step * heights.std(), contact.flows).settled
            assert unmet(contact) < 1e-6
        assert whole.force == pytest.approx(few.force, rel=1e-6)
        assert whole.force > 0.0
    np.testing.assert_allclose(whole.heights, few.heights, atol=1e-6 * heights.std())


def unmet(contact: CoupledContact) -> float:
    """Residual of the conditions of contact at all sites, by a transform of its own, over the
    largest pressure.
    """
    pressure = np.zeros(contact.heights.size)
    limit = np.full(
        pressure.size, contact.hardness.pressure(contact.site_area) if contact.bounded else np.inf
    )
    pressure[contact.sites], limit[contact.sites] = contact.pressure, contact.limit
    half_space = grid.Grid(contact.n, contact.length, contact.e_star, contact.bodies)
    gap = contact.heights + contact.separation
    return dense.residual(
        gap, pressure, half_space.displacement(pressure), limit, contact.stiffness, pressure.size
    )
