"""Copies of a switch with all moduli, stresses and pressures times a number; switches softer than
their pads.
"""

from dataclasses import replace

import pytest

from mesoscale.pad.curves import PadCurves
from mesoscale.studies.answer_stability import SOLVED, made_up_pad, published_beam, solved_beam


def softer(settings, law, times):
    """The same switch and pad with all moduli, stresses and pressures times a number."""
    stress = times * settings.residual_stress_MPa
    update = {
        "youngs_modulus_GPa": times * settings.youngs_modulus_GPa,
        "residual_stress_MPa": stress,
    }
    flats = replace(law.flats, hamaker=times * law.flats.hamaker)
    pad = PadCurves(
        law.separation_nm, times * law.closing, law.depth_nm, times * law.opening, flats
    )
    return settings.model_copy(update=update), pad


@pytest.mark.parametrize(
    "name", ["cooled to 77 K", "on stoppers as high as the dimple", "electrode beside the contact"]
)
@pytest.mark.parametrize("times", [2.0**-14, 1e-4])
def test_the_solver_knows_no_pressure_but_those_of_beam_and_pad(name, times):
    """Voltages go with the root of all pressures; a power of four scales every number exactly."""
    settings, law = published_beam(**{**SOLVED[name], "temperature_C": 20.0}), made_up_pad(2.0)
    hold = {
        "hold_voltage_V": times**0.5 * settings.hold_voltage_V if settings.hold_voltage_V else None
    }
    stiff = solved_beam(settings, law)
    soft_settings, soft_law = softer(settings, law, times)
    soft = solved_beam(soft_settings.model_copy(update=hold), soft_law)
    for way in ("pull_in_V", "hold_V", "release_V"):
        assert getattr(soft, way) / times**0.5 == pytest.approx(getattr(stiff, way), rel=1e-6)
    assert soft.landed_share == pytest.approx(stiff.landed_share, rel=1e-6)
    # a balance is found to a thousandth of a nanometre, of some 50
    assert soft.capacitance_fF == pytest.approx(stiff.capacitance_fF, rel=1e-5)


@pytest.mark.parametrize("adhesion_kPa", [0.0, 2.0, 30.0])
def test_a_long_thin_cantilever_lands_on_an_ordinary_pad(adhesion_kPa):
    """Its spring pulls with 0.4 Pa, that of the default with 15 kPa."""
    settings = published_beam(
        ends="cantilever",
        length_um=766.0,
        width_um=180.0,
        thickness_um=1.04,
        youngs_modulus_GPa=45.0,
    )
    states = solved_beam(settings, made_up_pad(adhesion_kPa))
    assert 0.4 < states.pull_in_V < 0.5  # of a cantilever: sqrt(0.28 E t^3 g^3 / eps L^4) = 0.47
    assert 0.2 < states.landed_share < 0.5
    assert 0.0 <= states.release_V < states.pull_in_V
