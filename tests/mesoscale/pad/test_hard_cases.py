"""Stiff and extreme pads: those of a scene around the middle of Table 1."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.contact import ContactInputs
from mesoscale.contact.coupled import dense
from mesoscale.pad.cells import sample_cells
from mesoscale.pad.closing import press_cells
from mesoscale.pad.pilots import plan_grid
from mesoscale.settings import ContactSettings
from mesoscale.studies.pad_stability import ATTRACTIONS, SOFT_FILM, hard_cases, violations

MIDDLE = ContactInputs(
    hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5
)
CASES = {
    mechanics: hard_cases(MIDDLE, ContactSettings(mechanics=mechanics, pixels=64))
    for mechanics in ("asperity", "coupled")
}
ALL = [
    (mechanics, case)
    for mechanics, cases in CASES.items()
    for case in cases
    if case.name != SOFT_FILM
]


@pytest.mark.parametrize(
    ("mechanics", "case"), ALL, ids=[f"{mechanics}: {case.name}" for mechanics, case in ALL]
)
def test_hard_pads_keep_all_invariants(mechanics, case):
    passed, detail = case.judge()
    assert passed, detail
    # none of these needs to be
    assert case.name == "merging asperities" or not detail.startswith("refused")


def test_every_attraction_is_tried_plastic_and_elastic():
    for cases in CASES.values():
        assert len(cases) == 2 * len(ATTRACTIONS) + 16
        assert len({case.name for case in cases}) == len(cases)


def test_soft_cells_are_solved_with_the_blocks_of_their_own_sites(monkeypatch):
    """The sets of one change in a step that has settled: the block at hand is then of other
    sites.
    """
    close_gaps, sizes = dense.close_gaps, []

    def noted(block, around, stencil, gap, goal, share):
        sizes.append({len(block), len(around), len(gap)})
        return close_gaps(block, around, stencil, gap, goal, share)

    monkeypatch.setattr(dense, "close_gaps", noted)
    (soft,) = (case for case in CASES["coupled"] if case.name == SOFT_FILM)
    assert soft.judge()[0]
    assert sizes
    assert all(len(of) == 1 for of in sizes)


def test_a_pad_that_breaks_an_invariant_is_told():
    contact = ContactSettings(mechanics="asperity", pixels=64)
    cells = sample_cells(MIDDLE, 2)
    grid = plan_grid(MIDDLE, contact, cells, 5e-3)
    pad = press_cells(MIDDLE, contact, grid, cells)
    assert violations(pad) == []
    harder = pad.opening.copy()
    harder[:, :, 0] *= 2.0
    broken = violations(replace(pad, opening=harder))
    assert any("does not start where closing ended" in words for words in broken)
    assert any("pushes harder than closing did" in words for words in broken)
    assert violations(replace(pad, closing=np.nan * pad.closing)) == ["not finite"]
    assert violations(replace(pad, settled=~pad.settled)) == ["2 cells did not settle"]
