"""A switch whose held electrode has crept: beside a standard linear solid that is stepped in time,
and beside finite differences of a beam with inelastic strain.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from mesoscale.errors import InputError
from mesoscale.studies.answer_stability import made_up_pad, published_beam
from mesoscale.switch import switch_of
from mesoscale.switch.beam import beam_of, crept
from mesoscale.switch.beam_switch import BeamSwitch
from mesoscale.switch.crept import crept_switch, crept_voltages, held_shape
from mesoscale.theory.ageing import relaxed_share
from mesoscale.units import GPA, NM, VACUUM_PERMITTIVITY

PAD = made_up_pad(2.0)
BEAM = published_beam(hold_voltage_V=85.0)
PLATE = published_beam(spring_N_per_m=1000.0, hold_voltage_V=155.0)


def standard_linear_solid(device, pad, most, relaxation_s, end_s):
    """Release (V) of a plate on a spring and dashpot, held and then let go, by Runge and Kutta."""
    area = device.area_um2 * 1e-12
    rest_nm = 1e3 * device.gap_um
    electric_nm = device.dielectric_nm / device.permittivity

    def left_N(separation_nm, flowed_nm, pressure_GPa, squared_V2):
        spring = device.spring_N_per_m * (rest_nm - separation_nm - flowed_nm) * NM
        gap = (separation_nm + electric_nm) * NM
        pull = VACUUM_PERMITTIVITY * area * squared_V2 / (2.0 * gap**2)
        return spring + area * pressure_GPa * GPA - pull

    def held_nm(flowed_nm):
        return brentq(
            lambda s: left_N(s, flowed_nm, float(pad.closing_GPa(s)), device.hold_voltage_V**2),
            16.0,
            40.0,
        )

    def rate(flowed_nm):
        return (most * (rest_nm - held_nm(flowed_nm)) - flowed_nm) / relaxation_s

    flowed_nm = 0.0
    step = end_s / 200.0
    for _ in range(200):
        first = rate(flowed_nm)
        second = rate(flowed_nm + 0.5 * step * first)
        third = rate(flowed_nm + 0.5 * step * second)
        fourth = rate(flowed_nm + step * third)
        flowed_nm += step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)
    deepest_nm = held_nm(flowed_nm)
    places_nm = np.linspace(deepest_nm, 79.0, 20001)
    gaps = (places_nm + electric_nm) * NM
    without_pull = left_N(places_nm, flowed_nm, pad.opening_GPa(places_nm, deepest_nm), 0.0)
    squares = 2.0 * gaps**2 * without_pull / (VACUUM_PERMITTIVITY * area)
    return np.sqrt(max(squares.min(), 0.0))


@pytest.mark.parametrize("relaxations", [0.3, 1.0, 4.0])
def test_a_plate_lets_go_as_the_solid_that_is_stepped_in_time(relaxations):
    most, relaxation_s = 0.4, 250.0
    end_s = relaxations * relaxation_s
    stepped = standard_linear_solid(PLATE, PAD, most, relaxation_s, end_s)
    held = held_shape(PLATE, PAD)
    share = float(relaxed_share(end_s, relaxation_s, most))
    _, release = crept_voltages(PLATE, held, share, PAD)
    # its separation changes by some 0.1 nm of 3.5 um while it is held
    assert release == pytest.approx(stepped, rel=1e-3)


def test_the_pull_in_of_a_plate_is_that_of_its_smaller_gap():
    held = held_shape(PLATE, PAD)
    pull_in, _ = crept_voltages(PLATE, held, 0.3, PAD)
    electric = PLATE.dielectric_nm / PLATE.permittivity
    rest_nm = 3490.0 - 0.3 * (3490.0 - held.separation_nm)
    ratio = ((rest_nm + electric) / (3490.0 + electric)) ** 1.5
    fresh = switch_of(PLATE).states(PAD).pull_in_V
    assert pull_in == pytest.approx(fresh * ratio, rel=1e-3)


@pytest.mark.parametrize("device", [BEAM, PLATE], ids=["beam", "plate"])
def test_without_creep_it_is_the_switch_of_today(device):
    today = switch_of(device).states(PAD)
    solved = crept_voltages(device, held_shape(device, PAD), 0.0, PAD)
    assert solved == (today.pull_in_V, today.release_V)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_a_crept_beam_rests_where_its_inelastic_strain_puts_it(share):
    """Finite differences of bending and stretching with inelastic strain, minimised by Newton."""
    beam = beam_of(BEAM)
    held = held_shape(BEAM, PAD).nodal
    count = 512
    length = beam.length_m
    step = length / count
    places = np.linspace(0.0, length, count + 1)
    nodes = np.concatenate([[0.0], np.cumsum(beam.sizes_m)])
    shape = np.interp(places, nodes, held[:, 0])
    # clamped: height 0 at the ends, and no slope there by a mirrored node
    bend = np.zeros((count + 1, count + 1))
    slope = np.zeros((count, count + 1))
    for row in range(count + 1):
        for offset, weight in ((-1, 1.0), (0, -2.0), (1, 1.0)):
            column = row + offset
            column = abs(column) if column <= count else 2 * count - column
            bend[row, column] += weight / step**2
    for row in range(count):
        slope[row, row : row + 2] = -1.0 / step, 1.0 / step
    ends = np.full(count + 1, step)
    ends[[0, -1]] *= 0.5
    inner = slice(1, count)
    bend, slope = bend[:, inner], slope[:, inner]
    stiff = beam.bending_N_m2 * bend.T @ (ends[:, None] * bend)
    longer = step * slope.T @ slope
    shape = shape[inner]
    solved = share * shape
    for _ in range(30):
        force_N = beam.stretching_N_m * (
            0.5 * solved @ longer @ solved - share * 0.5 * shape @ longer @ shape
        )
        drawn = longer @ solved
        left = stiff @ (solved - share * shape) + force_N * drawn
        tangent = stiff + force_N * longer + beam.stretching_N_m * np.outer(drawn, drawn)
        solved = solved - np.linalg.solve(tangent, left)
    rested = crept(beam, held, share)
    middle_nm = (rested.rest_nodal - beam.rest_nodal)[beam.elements // 2, 0] / NM
    assert middle_nm == pytest.approx(solved[count // 2 - 1] / NM, rel=2e-3)
    assert rested.tension_N == pytest.approx(force_N, rel=2e-2, abs=1e-7)


def test_the_force_that_holds_a_cantilever_falls_with_its_creep():
    """Nothing stretches, so that bending alone is superposed exactly."""
    device = published_beam(ends="cantilever", length_um=250.0, thickness_um=3.0)
    beam = beam_of(device)
    places = np.concatenate([[0.0], np.cumsum(beam.sizes_m)]) / beam.length_m
    held = -1e-6 * np.stack([places**2, 2.0 * places / beam.length_m], 1)
    rested = crept(beam, held, 0.25)
    assert rested.rest_nodal - beam.rest_nodal == pytest.approx(0.25 * held, abs=1e-15)
    assert rested.tension_N == beam.tension_N


def test_release_falls_with_creep_until_it_stays_closed():
    held = held_shape(BEAM, PAD)
    voltages = np.array([crept_voltages(BEAM, held, share, PAD) for share in (0.0, 0.2, 0.6, 1.0)])
    assert (np.diff(voltages, axis=0) < 0.0).all()
    assert (voltages[-1] == 0.0).all()
    with pytest.raises(InputError, match=r"lifetime\.ageing: the plate has crept down to 2"):
        crept_switch(PLATE, held_shape(PLATE, PAD), 1.0, PAD)


def test_a_cantilever_that_has_crept_down_to_its_pad_stays_closed():
    """It rests so near that it touches at 0.1 V, and would let go above that."""
    tip = published_beam(ends="cantilever", length_um=250.0, thickness_um=3.0, hold_voltage_V=40.0)
    held = held_shape(tip, PAD)
    near = crept_switch(tip, held, 0.99, PAD).states(PAD)
    assert near.touches
    assert near.release_V > near.pull_in_V
    assert crept_voltages(tip, held, 0.99, PAD) == (0.0, 0.0)


def test_a_beam_that_creeps_keeps_its_held_shape():
    """Its strain is taken as that of the first second; held again it is nearly the same."""
    switch = BeamSwitch(BEAM)
    first = switch.held(PAD)
    rested = crept(switch.beam, first.nodal, 0.2)
    again = BeamSwitch(BEAM, rested).held(PAD)
    before = switch.beam.rest_nodal + first.nodal
    after = rested.rest_nodal + again.nodal
    moved_nm = np.abs(after - before)[:, 0] / NM
    assert moved_nm.max() < 0.06 * 3490.0


def test_curvature_and_stretch_are_those_of_a_known_shape():
    beam = beam_of(BEAM)
    places = np.concatenate([[0.0], np.cumsum(beam.sizes_m)])
    wave = 2.0 * np.pi / beam.length_m
    height = 1e-6 * (1.0 - np.cos(wave * places))
    nodal = np.stack([height, 1e-6 * wave * np.sin(wave * places)], 1)
    curvature, stretched = beam.strains(nodal)
    assert curvature[0, 0] == pytest.approx(1e-6 * wave**2, rel=1e-3)
    assert curvature[-1, 1] == pytest.approx(1e-6 * wave**2, rel=1e-3)
    assert stretched == pytest.approx(0.25 * (1e-6 * wave) ** 2, rel=1e-4)
