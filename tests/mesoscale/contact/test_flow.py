import numpy as np
import pytest

from evidence.contact import plain_contact
from mesoscale.contact import run_cycle
from mesoscale.contact.asperity.engine import AsperityContact
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.topography.synthesis import synthesize

INPUTS = ContactInputs(
    hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.05, hurst=0.75, rms=4.0
)


def settings_for(**changes) -> ContactSettings:
    return ContactSettings(
        **{"mechanics": "asperity", "pixels": 128, "length_nm": 125.0, **changes}
    )


def surface(seed: int = 3) -> np.ndarray:
    """Rough down to its pixels, so that many asperities flow."""
    return synthesize(128, 125.0, 0.05, 0.75, 4.0, seed, "profile")


def walk_down(contact: AsperityContact, lowest: float, depth: float, steps: int = 25) -> list:
    return [contact.move_to(-lowest - x, True) for x in np.linspace(0.05, depth, steps)]


@pytest.mark.parametrize("flow", ["return", "increment"])
@pytest.mark.parametrize("pair", ["wide", "paper"])
@pytest.mark.parametrize("floor", [0.0, 1.0])
def test_flow_conserves_volume_on_the_grid(flow, pair, floor):
    heights = surface()
    before = heights.copy()
    numerics = Numerics(flow=flow, flow_floor_pixels=floor, max_sweeps=50)
    contact = AsperityContact(heights, INPUTS, settings_for(reading={"flow_pair": pair}), numerics)
    walk_down(contact, before.min(), 3.0)
    moved = np.abs(heights - before)
    assert moved.max() > 0.3
    # round-off of a sum over the changed sites
    assert abs(np.sum(heights - before)) < 1e-13 * moved.sum() * np.sqrt(contact.changed_sites)
    assert np.count_nonzero(moved) <= contact.changed_sites < heights.size


def test_no_asperity_is_left_above_its_hardness():
    heights = surface()
    settings = settings_for()
    contact = AsperityContact(heights, INPUTS, settings, Numerics(max_sweeps=2000))
    for x in np.linspace(0.05, 4.0, 30):
        separation = -surface().min() - x
        settled = contact.move_to(separation, True).settled
        assert settled
    left = plain_contact.asperities(contact.heights.reshape(128, 128), separation, INPUTS, settings)
    assert len(left) > 3
    for asperity in left:
        assert asperity.elastic_force <= asperity.hardness * asperity.area * (
            1 + NUMERICS.flow_tolerance
        ) * (1 + 1e-9)


def test_the_return_mapping_is_the_limit_of_small_increments():
    """At a fixed width of the flow; a site more or less in contact is what the difference consists
    of.
    """
    differences = {}
    for increment in (0.3, 0.01):
        total = 0.0
        for seed in (1, 2, 3):
            ends = []
            for changes in (
                {"flow": "return"},
                {"flow": "increment", "flow_increment_nm": increment},
            ):
                contact = AsperityContact(
                    surface(seed), INPUTS, settings_for(), Numerics(max_sweeps=20000, **changes)
                )
                ends.append([row.force for row in walk_down(contact, surface(seed).min(), 4.0)])
            returned, stepped = np.array(ends)
            total += np.sum(np.abs(returned - stepped)) / np.sum(stepped) / 3
        differences[increment] = total
    assert differences[0.01] < 0.03
    assert differences[0.01] < 0.5 * differences[0.3]


@pytest.mark.parametrize(("floor", "settles"), [(0.0, False), (1.0, True)])
@pytest.mark.parametrize("flow", ["increment", "return"])
def test_a_width_below_the_grid_stalls_and_says_so(floor, settles, flow):
    """Why `flow_floor_pixels` exists: on the grid both sub-pixel Gaussians of the paper are one
    spike.

    R = 1/16 nm gives s1 = 0.14 nm on a 1 nm grid. The return mapping scales the vanishing
    difference of the two up to the wanted peak movement, so it ends, but by moving one site and its
    neighbours.
    """
    heights = np.zeros((64, 64))
    heights[20, 20] = -8.0
    settings = ContactSettings(
        mechanics="asperity", pixels=64, length_nm=64.0, reading={"flow_pair": "paper"}
    )
    numerics = Numerics(flow=flow, flow_floor_pixels=floor, max_sweeps=300)
    settled = AsperityContact(heights, INPUTS, settings, numerics).move_to(7.0, True).settled
    assert settled == (settles or flow == "return")


def test_an_undone_move_leaves_no_trace():
    heights = surface()
    contact = AsperityContact(heights, INPUTS, settings_for())
    walk_down(contact, surface().min(), 1.0)
    kept = heights.copy()
    there = contact.move_to(-surface().min() - 2.0, True)
    assert not np.array_equal(heights, kept)
    contact.back()
    np.testing.assert_array_equal(heights, kept)
    again = contact.move_to(-surface().min() - 2.0, True)
    assert again.force == pytest.approx(there.force, rel=1e-9)
    assert again[1:4] == there[1:4]


def test_a_plateau_comes_down_in_a_few_sweeps():
    """Raising the peak alone takes hundreds: on a flat top the next site carries when one is
    raised.
    """
    x = np.arange(64) - 32.0
    heights = np.maximum(x[:, None] ** 2 + x[None, :] ** 2, 80.0) / 40.0
    soft = ContactInputs(**{**vars(INPUTS), "h_macro": 1.0, "h_prime": 2.0})
    contact = AsperityContact(
        heights,
        soft,
        ContactSettings(mechanics="asperity", pixels=64, length_nm=64.0),
        Numerics(max_sweeps=5000),
    )
    moved = contact.move_to(-2.6, True)
    assert moved.settled
    assert moved.sites > 100
    assert moved.sweeps < 60


def test_closing_ends_before_the_whole_cell_is_one_contact():
    """0.8 H A of the cell is 1250 nN; what was asked for is not reached, and the cycle says so."""
    soft = ContactInputs(**{**vars(INPUTS), "h_macro": 0.1, "h_prime": 0.0})
    cycle = run_cycle(soft, settings_for(), 1, 10000.0)
    assert cycle.closing.repulsive_nN[-1] == pytest.approx(0.08 * 125.0**2, rel=0.02)
    assert not cycle.flags["force_reached"]
    assert not cycle.converged
    assert cycle.flags["unconverged_steps"] == 0


def test_a_plateau_as_wide_as_the_cell_carries_up_to_its_hardness():
    """Flow keeps the volume: where every site touches there is nowhere to flow to, and closing
    ends.
    """
    soft = ContactInputs(**{**vars(INPUTS), "h_macro": 1e-4, "h_prime": 0.0})
    cycle = run_cycle(
        soft, settings_for(), 1, 10.0, heights=np.zeros((128, 128)), contact_at="lowest"
    )
    assert cycle.flags["full_contact"]
    assert cycle.flags["changed_sites"] == 0
    assert cycle.flags["largest_load"] < 1.0 + 1e-3
    assert not cycle.converged


def test_an_undone_flow_counts_no_site_as_changed():
    heights = surface()
    contact = AsperityContact(heights, INPUTS, settings_for())
    contact.move_to(-surface().min() - 2.0, True)
    assert contact.changed_sites > 0
    contact.back()
    assert contact.changed_sites == 0
    assert not contact.changed.any()


def test_turning_a_surface_moves_its_force_by_far_less_than_another_surface_does():
    """Flow goes from contact to contact by the numbers of sites, and each flow moves its neighbours
    (docs/contact.md).

    With contacts and sites ordered by height instead, the forces below agree to 1e-15.
    """
    forces = {"elastic": [], "plastic": []}
    for model, found in forces.items():
        settings = ContactSettings(mechanics="asperity", model=model, pixels=512, length_nm=1000.0)
        for seed in (1, 2, 3, 4):
            heights = synthesize(512, 1000.0, 0.02, 0.75, 8.0, seed, "profile")
            for turned in (heights, np.rot90(heights)):
                contact = AsperityContact(turned.copy(order="C"), INPUTS, settings)
                found.append(
                    [
                        contact.move_to(-heights.min() - x, model == "plastic").force
                        for x in range(1, 13)
                    ]
                )
    elastic, plastic = (np.array(found).reshape(4, 2, 12) for found in forces.values())
    np.testing.assert_allclose(elastic[:, 1], elastic[:, 0], rtol=1e-9)
    moved = np.abs(plastic[:, 1] / plastic[:, 0] - 1.0)
    assert np.sqrt(np.mean(moved**2)) < 0.02  # 0.005 when it was written, at most 0.028
    assert moved[:, -1].max() < 0.02  # 0.007
    assert plastic[:, 0, -1].std() > 0.3 * plastic[:, 0, -1].mean()
