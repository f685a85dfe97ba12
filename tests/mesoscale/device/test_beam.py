"""The bending electrode: analytic limits of the beam, and a switch that lands on a made-up pad."""

import numpy as np
import pytest

from mesoscale.device.beam import beam_of
from mesoscale.device.beam_switch import free_pull_in_V, solve_beam
from mesoscale.device.switch import VACUUM_PERMITTIVITY, beam_stiffness_N_per_m
from mesoscale.errors import InputError, NotComputed
from mesoscale.pad.local import LocalPad
from mesoscale.pad.memory import Flats, PadLaw
from mesoscale.settings import DeviceSettings

DEFAULT = DeviceSettings(gap_um=2.3)
DEPTHS = (16.0, 18.0, 20.0, 22.0, 24.0, 26.0, 28.0, 30.0, 32.0)


def made_up_law(adhesion_kPa=0.0):
    """Closing 7 MPa at 24 nm, e-fold 2 nm; opening loses contact 4 nm above the depth, with a well 1 nm wide there."""
    s = np.arange(15.0, 80.0, 0.05)
    closing = np.stack([7e-3 * np.exp((24.0 - s) / 2.0) * (s < 40.0), np.full(s.size, -1e-12)])
    opening = np.full((len(DEPTHS), 2, s.size), np.nan)
    for k, depth in enumerate(DEPTHS):
        above = s >= depth - 1e-9
        risen = s[above] - depth
        opening[k, 0, above] = 7e-3 * np.exp((24.0 - depth) / 2.0) * np.maximum(1.0 - risen / 4.0, 0.0)
        opening[k, 1, above] = -1e-12 - adhesion_kPa * 1e-6 * np.exp(-((risen - 5.0) ** 2) / 0.5)
    return PadLaw(s, closing, np.array(DEPTHS), opening, Flats(1e-6, 0.0))


def deflection_of(settings, pressure_Pa):
    beam = beam_of(settings, 32)
    change, _ = beam.step(np.zeros((33, 2)), lambda s: (np.full_like(s, pressure_Pa), np.zeros_like(s)))
    return beam, change[16, 0]


def test_uniform_load_bends_by_the_stiffness_of_the_lumped_switch():
    beam, middle = deflection_of(DEFAULT, -1e3)
    force = 1e3 * beam.length_m * beam.width_m
    assert -middle == pytest.approx(force / beam_stiffness_N_per_m(DEFAULT), rel=1e-6)


def test_a_tense_beam_bends_as_the_exact_solution():
    """q L^2 / 8 T - q L / (2 T k) tanh(k L / 4) with k^2 = T / EI, clamped ends."""
    beam, middle = deflection_of(DEFAULT.model_copy(update={"residual_stress_MPa": 20.0}), -1e3)
    load, tension, length = 1e3 * beam.width_m, beam.tension_N, beam.length_m
    k = np.sqrt(tension / beam.bending_N_m2)
    exact = load * length**2 / (8 * tension) - load * length / (2 * tension * k) * np.tanh(k * length / 4)
    assert -middle == pytest.approx(exact, rel=1e-6)


def test_local_pressure_is_that_of_the_pad_with_its_memory():
    law = made_up_law(5.0)
    local = LocalPad(law)
    at = np.array([[24.0, 25.5, 30.0, 90.0]])
    np.testing.assert_allclose(local(at, np.full(at.shape, np.inf))[0], law.closing_GPa(at), rtol=1e-12)
    pressure, slope = local(at, np.full(at.shape, 23.0))
    np.testing.assert_allclose(pressure[0, :3], law.opening_GPa(at[0, :3], 23.0), rtol=2e-2)
    assert slope[0, 0] < 0


@pytest.fixture(scope="module")
def landed():
    return solve_beam(DEFAULT, made_up_law(), 32)


def test_pull_in_is_the_exact_number():
    """eps0 b V^2 L^4 / (2 EI g^3) of a beam without stretching over a gap, by shooting: 70.0950 clamped, 1.68084 free."""
    for ends, exact in (("clamped", 70.095048), ("cantilever", 1.680841)):
        settings = DeviceSettings(ends=ends, anchor_um_per_N=1e9, fringe=0.0)
        beam = beam_of(settings, 64)
        gap = settings.gap_um * 1e-6 + settings.dielectric_nm / settings.permittivity * 1e-9
        number = VACUUM_PERMITTIVITY * beam.width_m * free_pull_in_V(settings) ** 2 * beam.length_m**4
        assert number / (2 * beam.bending_N_m2 * gap**3) == pytest.approx(exact, rel=2e-4)


def test_the_landed_area_is_a_result_that_grows_with_the_voltage_and_shrinks_before_release(landed):
    harder = solve_beam(DEFAULT.model_copy(update={"hold_voltage_V": 1.1 * landed.pull_in_V}), made_up_law(), 32)
    assert 0.1 < landed.landed_share < harder.landed_share < 1.0
    assert landed.landed_at_release < 0.3 * landed.landed_share
    assert 0 < landed.release_V < landed.hold_V
    assert not landed.stuck


def test_a_bow_away_from_the_dielectric_raises_pull_in_and_release(landed):
    bowed = solve_beam(DEFAULT.model_copy(update={"bow_nm": 500.0}), made_up_law(), 32)
    assert bowed.pull_in_V > landed.pull_in_V
    assert bowed.release_V > landed.release_V


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"hold_voltage_V": 1.0}, "hold_voltage_V = 1: never closes this switch, which pulls in at"),
        ({"hold_voltage_V": 80.0}, "where its curves end"),
        ({"bow_nm": -2280.0}, "touches the dielectric before it pulls in"),
        ({"bow_nm": -3500.0}, "at rest the electrode is -.* nm above what it lands on at its lowest"),
        ({"tilt_nm": 8000.0}, "lower bow_nm, tilt_nm, dimple_nm or stopper_nm, or raise gap_um"),
        ({"contact": (0.0, 0.1)}, "the beam does not land on the pad"),
        ({"residual_stress_MPa": -60.0, "buckled": "down"}, "the beam stands on the dielectric at rest"),
        ({"dimple_nm": 2400.0, "contact": (0.4, 0.6)}, "at rest the electrode is -100 nm above what it lands on"),
        ({"stopper_nm": 2400.0, "contact": (0.4, 0.6)}, "lower bow_nm, tilt_nm, dimple_nm or stopper_nm"),
        ({"stopper_nm": 1000.0, "contact": (0.45, 0.55), "electrode": (0.2, 0.4)}, "the beam does not land on the pad"),
    ],
)
def test_a_beam_that_cannot_be_solved_is_refused_in_one_line(change, words):
    law = made_up_law()
    # closed to 24 nm only
    law = PadLaw(law.separation_nm[180:], law.closing[:, 180:], law.depth_nm[4:], law.opening[4:, :, 180:], law.flats)
    with pytest.raises(InputError, match=words) as caught:
        solve_beam(DEFAULT.model_copy(update=change), law, 32)
    assert "\n" not in str(caught.value)


def test_a_pad_that_was_hardly_closed_is_refused_with_what_helps():
    law = made_up_law()
    law = PadLaw(law.separation_nm, law.closing * np.array([[1e-9], [1.0]]), law.depth_nm, law.opening, law.flats)
    with pytest.raises(NotComputed, match=r"carries 6.3e-07 MPa at 15 nm, where its curves end; raise pad\.cells"):
        solve_beam(DEFAULT, law)
