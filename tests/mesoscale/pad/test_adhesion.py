"""Energy and pull-off of pads, and a sphere on a film by Derjaguin's integral."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from mesoscale.contact import ContactInputs, run_cycle
from mesoscale.errors import InputError
from mesoscale.pad.adhesion import (
    Case,
    close_to_loads,
    flats_energy,
    open_from,
    pad_rows,
    plan_cases,
    press_sphere,
    summary_rows,
)
from mesoscale.pad.memory import Flats, PadLaw
from mesoscale.settings import AdhesionSettings, ContactSettings
from mesoscale.settings.inputs import WorkAndRangeSettings

VALUES = {"hamaker": 0.215, "e_star": 91.0, "h_macro": 1.95, "h_prime": 8.375, "q0": 0.025, "hurst": 0.75, "rms": 4.4}
INPUTS = ContactInputs(**VALUES)
SMALL = ContactSettings(pixels=128, q1_per_nm=0.2)
PADS = AdhesionSettings(pads=2, cells=2, loads_MPa=(0.5, 5.0))


def test_flats_that_touch_nowhere_have_hamakers_energy():
    s = np.geomspace(10.0, 200.0, 4000)
    net = -INPUTS.hamaker / (6 * np.pi * s**3)
    opened = open_from(s, net, flats_energy(INPUTS.hamaker, 200.0, 0.0))
    assert opened.zero_nm == 10.0
    assert opened.energy_J_m2 == pytest.approx(INPUTS.hamaker / (12 * np.pi * 100.0), rel=1e-6)
    assert opened.pull_off_GPa == -net[0]


def test_opening_counts_from_the_first_separation_without_force():
    """Repulsion exp(-s) against a constant pull b: zero at -ln b, from there b S - b + exp(-S) to the end S."""
    s, b = np.linspace(0.0, 20.0, 20001), 0.1
    opened = open_from(s, np.exp(-s) - b, 0.0)
    assert opened.zero_nm == pytest.approx(-np.log(b), abs=1e-6)
    assert opened.energy_J_m2 == pytest.approx(b * (20.0 + np.log(b)) - b, rel=1e-6)


@pytest.mark.parametrize(("rms", "load_nN", "stated"), [(2.6, 2000.0, 248), (4.4, 2000.0, 98), (8.5, 2000.0, 74)])
def test_single_cells_of_512_have_the_energies_that_a_prototype_had(rms, load_nN, stated):
    """One surface of an independent code (uJ/m^2) lies among those of ten surfaces."""
    inputs = ContactInputs(**{**VALUES, "rms": rms})
    energies, settings = [], ContactSettings(pixels=512, attraction="clamped")
    for seed in range(10):
        opening = run_cycle(inputs, settings, seed, max_force_nN=load_nN).opening
        beyond = flats_energy(INPUTS.hamaker, opening.separation_nm[-1], 0.0)
        energies.append(open_from(opening.separation_nm, opening.net_nN / 1e6, float(beyond)).energy_J_m2 * 1e6)
    assert abs(stated - np.mean(energies)) < 2.0 * np.std(energies, ddof=1)


def law_without_memory(step: float = 0.05) -> tuple[PadLaw, float]:
    """Repulsion that decays over 1 nm and the attraction of flats; opening is closing."""
    s = np.arange(20.0, 150.0, step)
    push, pull = 2e-3 * np.exp(-(s - 20.0)), -INPUTS.hamaker / (6 * np.pi * s**3)
    curves = np.stack([push, pull])
    depths = np.array([20.0, 22.0, 26.0])
    opening = np.array([np.where(s >= depth - 1e-9, curves, np.nan) for depth in depths])
    return PadLaw(s, curves, depths, opening, Flats(INPUTS.hamaker, 0.0)), float(
        flats_energy(INPUTS.hamaker, s[-1], 0.0)
    )


def test_a_sphere_without_memory_pulls_2_pi_R_times_the_energy_of_the_film():
    law, beyond = law_without_memory()
    sphere = press_sphere(law, 20.0, 250e3, beyond)

    def per_area(s: float) -> float:
        return 2e-3 * np.exp(-(s - 20.0)) - INPUTS.hamaker / (12 * np.pi * s**2)

    deepest = minimize_scalar(per_area, bounds=(20.0, 60.0), method="bounded")
    # linear interpolation between separations 0.05 nm apart: 0.05^2 / 12 of an exponential of 1 nm
    assert sphere.work_J_m2 == pytest.approx(-deepest.fun, rel=1e-3)
    assert sphere.pull_off_nN == pytest.approx(2 * np.pi * 250e3 * sphere.work_J_m2)
    assert sphere.load_nN == pytest.approx(2 * np.pi * 250e3 * per_area(20.0), rel=1e-3)
    energy = open_from(law.separation_nm, law.closing.sum(axis=0), beyond).energy_J_m2
    assert sphere.work_J_m2 == pytest.approx(energy, rel=1e-3)


def test_a_sphere_remembers_ring_by_ring():
    """Opening that drops at once to a pull that falls with the rise: only rings that touched pull so."""
    s = np.arange(20.0, 150.0, 0.05)
    depths = np.linspace(20.0, 30.0, 21)

    def memory(at, depth):
        return -1e-4 * np.exp(-(at - depth) / 2.0) * (30.0 - depth)

    opening = np.array([np.stack([0.0 * s, np.where(s >= d - 1e-9, memory(s, d), np.nan)]) for d in depths])
    opening[:, 0][np.isnan(opening[:, 1])] = np.nan
    law = PadLaw(s, np.stack([np.where(s < 30.0, 1e-3, 0.0), 0.0 * s]), depths, opening, Flats(0.0, 0.0))
    sphere = press_sphere(law, 20.0, 1000.0, 0.0)
    exact = -quad(lambda depth: memory(depth, depth), 20.0, 30.0)[0]
    # interpolated in logarithm between depths 0.5 nm apart
    assert sphere.work_J_m2 == pytest.approx(exact, rel=0.01)


def test_a_sphere_on_a_coarse_film_is_lifted_until_it_pulls_less():
    """Lengths of a known pad times 30: so are the energies per area, while pressures stay."""
    law, beyond = law_without_memory()
    coarse = replace(law, separation_nm=30 * law.separation_nm, depth_nm=30 * law.depth_nm)
    fine, wide = (
        press_sphere(pad, deepest, 1e5, times * beyond) for pad, deepest, times in ((law, 20.0, 1), (coarse, 600.0, 30))
    )
    assert wide.work_J_m2 == pytest.approx(30 * fine.work_J_m2, rel=5e-3)


def test_every_mechanics_has_every_case():
    adhesion = AdhesionSettings(
        pads=2,
        rms_nm=(2.0, 8.0),
        gap_cutoffs_nm=(0.3,),
        retardations_nm=(100.0,),
        works=(WorkAndRangeSettings(work_mJ_m2=46.3, range_nm=5.6),),
    )
    cases = plan_cases(VALUES, SMALL, adhesion)
    assert len(cases) == adhesion.case_count == 12
    assert [case.varied for case in cases[:6]] == ["none", "rms", "rms", "gap_cutoff", "retardation", "work"]
    assert {case.contact.mechanics for case in cases[6:]} == {"coupled"}
    assert cases[5].contact.gap_cutoff_nm == pytest.approx(5.6 / 0.5)


@pytest.mark.parametrize("mechanics", ["asperity", "coupled", "adhesive"])
def test_pads_are_opened_from_their_loads(mechanics):
    case = Case("none", INPUTS, SMALL.model_copy(update={"mechanics": mechanics, "gap_cutoff_nm": 0.3}))
    cells, loaded = close_to_loads(case, [5e-4, 5e-3], 2, 7)
    pressed = cells.closing[:, 0].mean(axis=0)[cells.grid.depths[loaded]]
    # within a step of separation: 0.1 nm; where the first sites touch the load doubles within some 0.3 nm
    np.testing.assert_allclose(pressed, [5e-4, 5e-3], rtol=0.5)
    assert (pressed >= [5e-4, 5e-3]).all()
    rows = [row for number in range(2) for row in pad_rows(case, PADS, number)]
    assert len(rows) == 4
    assert all(row["pull_off_kPa"] > 0 and row["energy_uJ_m2"] > 0.9 * row["flats_uJ_m2"] for row in rows)
    summary = summary_rows(rows)
    assert [line["load_MPa"] for line in summary] == [0.5, 5.0]
    assert all(line["energy_uJ_m2_lowest"] <= line["energy_uJ_m2"] <= line["energy_uJ_m2_highest"] for line in summary)


def test_retardation_and_a_larger_D0_lower_the_energy():
    def energy(**changes) -> float:
        case = Case("none", INPUTS, SMALL.model_copy(update=changes))
        return pad_rows(case, PADS, 0)[-1]["energy_uJ_m2"]

    assert energy() > energy(gap_cutoff_nm=0.3) > energy(gap_cutoff_nm=1.0)
    assert energy() > energy(retardation_nm=100.0) > energy(retardation_nm=10.0)


def test_a_load_out_of_reach_is_refused(monkeypatch):
    monkeypatch.setattr("mesoscale.pad.adhesion.MOST_STEPS", 1000)
    soft = Case("none", ContactInputs(**{**VALUES, "e_star": 1e-6, "hamaker": 0.0}), ContactSettings(pixels=32))
    with pytest.raises(InputError, match="MPa; lower it"):
        close_to_loads(soft, [1.0], 2, 0)
