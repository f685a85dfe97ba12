"""The exported pad with its memory, over two closings of different depth."""

import re

import numpy as np
import pytest

from evidence.pad.closed_form import ClosedForm
from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.circuit.spice import spice_pad
from mesoscale.circuit.tables import tables_of
from mesoscale.circuit.verilog import verilog_pad
from mesoscale.pad.curves import Flats, PadCurves
from mesoscale.studies.answer_stability import published_beam
from mesoscale.switch import switch_of
from tests.mesoscale.circuit.simulators import by_ngspice, needs_ngspice, needs_openvaf

AREA = 1e12
HISTORY_NM = (60.0, 30.0, 26.0, 28.0, 33.0, 60.0, 30.0, 27.0, 22.0, 25.0, 30.0, 60.0)
"""Closed to 26 nm, opened, closed past it to 22 nm, opened again."""


def pad(hamaker=0.215, waves=0.0):
    """A pad whose last contacts tear off in jerks, as those of few cells do."""
    form = ClosedForm(-2.9, 0.25, 0.003, -0.35, 0.04, 0.02, 0.078, 0.97, 0.5, 2.0, hamaker, 0.3)
    s = np.arange(19.0, 80.0, 0.1)
    depths = np.array([20.0, 22.0, 24.0, 26.0, 28.0])
    law = form.curves(s, depths)
    law.opening[:, 1] *= 1.0 + waves * np.sin(5.0 * (s - depths[:, None]))
    return law


def pressures(law):
    """Separation, deepest closing so far and pressure (GPa) of every step of the history, by the
    curves.
    """
    deepest = np.minimum.accumulate(HISTORY_NM)
    pressed = [
        float(law.closing_GPa(s) if s == deep else law.opening_GPa(s, deep))
        for s, deep in zip(HISTORY_NM, deepest, strict=True)
    ]
    return np.array(HISTORY_NM), deepest, np.array(pressed)


def well(law):
    return -min(np.nanmin(opened.sum(axis=0)) for opened in law.opening)


def compiled(law, tmp_path):
    """Pressure (GPa) of the Verilog-A module at a separation and a deepest closing, by another
    compiler.
    """
    import openvaf_py

    path = tmp_path / "rough_pad.va"
    path.write_text(verilog_pad(law, 256))
    (module,) = openvaf_py.compile_va(str(path))
    values = {"area_nm2": AREA, "follow": 1e-9, "mfactor": 1.0, **vars(law.flats)}

    def pressed(separation, deepest):
        state = CIRCUIT.start_nm - deepest
        residuals, _ = module.run_init_eval(
            {**values, "V(s,ref)": separation * 1e-9, "V(closed)": state}
        )
        # the state is at rest: it does not want to follow further, and hardly leaks
        assert abs(residuals[2][0]) <= 1e-9
        return -residuals[0][0] * 1e9 / AREA

    return pressed


@needs_openvaf
@pytest.mark.parametrize("waves", [0.0, 0.2])
def test_openvaf_follows_a_history_of_two_closings(tmp_path, waves):
    law = pad(waves=waves)
    pressed = compiled(law, tmp_path)
    for separation, deepest, wanted in zip(*pressures(law), strict=True):
        found = pressed(separation, deepest)
        assert found == pytest.approx(
            wanted, abs=2.0 * (CIRCUIT.of_well * well(law) + CIRCUIT.of_net * abs(wanted))
        )


@needs_openvaf
def test_the_table_is_as_near_to_the_curves_as_its_header_says(tmp_path):
    law = pad(waves=0.2)
    pressed = compiled(law, tmp_path)
    said = tables_of(law, cubic=True)
    assert said.of_well <= 0.02
    assert f"{said.of_well:.1%} of the well" in verilog_pad(law, 256)
    for depth, opened in zip(law.depth_nm, law.opening, strict=True):
        net = opened.sum(axis=0)
        deepest = -np.nanmin(net)
        near = np.flatnonzero((law.separation_nm >= depth) & (abs(net) < deepest))[::7]
        missed = [pressed(law.separation_nm[k], depth) - net[k] for k in near]
        assert np.abs(missed).max() <= (said.of_well + 0.002) * deepest


@needs_openvaf
def test_slopes_do_not_jump(tmp_path):
    """On both sides of each node of an opening, and of the closing curve."""
    law = pad()
    pressed = compiled(law, tmp_path)
    tables = tables_of(law, cubic=True)
    step = 1e-4

    def jump(curve, at):
        before, here, after = (curve(at + k * step) for k in (-1, 0, 1))
        return abs(after - 2.0 * here + before) / max(abs(after - before), 1e-12)

    for node in tables.opening[1][0].x[1:-1]:
        assert jump(lambda s: pressed(s, law.depth_nm[1]), law.depth_nm[1] + node) < 0.02
    inside = tables.closing[0].x
    for node in inside[(inside > 22.0) & (inside < 27.0)]:
        assert jump(lambda s: pressed(s, s), node) < 0.02


@needs_openvaf
def test_the_switch_releases_on_the_table_as_on_the_curves(tmp_path):
    law = pad()
    pressed = compiled(law, tmp_path)
    s = law.separation_nm
    depths = s[(s >= law.depth_nm[0] - 1e-9) & (s <= law.depth_nm[-1] + 1e-9)][::4]
    opening = np.full((depths.size, 2, s.size), np.nan)
    for k, depth in enumerate(depths):
        above = s >= depth - 1e-9
        opening[k][:, above] = apart([pressed(at, depth) for at in s[above]], 20.0 * well(law))
    made = PadCurves(
        s, apart([pressed(at, at) for at in s], 20.0 * well(law)), depths, opening, law.flats
    )
    by_curves = switch_of(published_beam()).states(law)
    by_table = switch_of(published_beam()).states(made)
    for name in ("pull_in_V", "release_V"):
        assert getattr(by_table, name) == pytest.approx(getattr(by_curves, name), rel=0.01)


def apart(net, pull):
    """Net pressure as push and pull, whose logarithms are smooth where the net pressure changes its
    sign.
    """
    return np.stack([np.array(net) + pull, np.full(len(net), -pull)])


def by_spice(text, separation, deepest):
    """Pressure (GPa) of the SPICE subcircuit, by its tables alone."""
    (depth,) = set(re.findall(r"pwl\((\S+ - V\(near\)),", text))
    at = {depth: deepest, "V(risen)": separation - deepest, "V(s) + {rest}": separation}

    def logarithm(name):
        (sums,) = re.findall(rf"^B{name} 0 {name} I = (.*?)^R", text, re.M | re.S)
        nodes = [(of, [float(value) for value in row.replace("\n+", "").split(",")])
                 for of, row in re.findall(r"pwl\(([^,]*),(.*?)\)", sums, re.S)]  # fmt: skip
        read = [float(np.interp(at[of], row[::2], row[1::2])) for of, row in nodes]
        closing, *opening, back, here, there = read
        risen = sum(weight * rise for weight, rise in zip(opening[::2], opening[1::2], strict=True))
        return closing + risen + back * (here - there)

    ((*far, faint),) = re.findall(r"\+ (\S+), \S+\)\) - (\S+)\n", text)
    far += re.findall(r"\+ (\S+), \S+\)\)\)\n.ends", text)
    push, pull = (
        logarithm(name) + float(away) for name, away in zip(("push", "pull"), far, strict=True)
    )
    (hamaker,), (offset,) = re.findall(r"hamaker=(\S+)", text), re.findall(r"offset_nm=(\S+)", text)
    (least,) = re.findall(r"pow\(max\(V\(s\) \+ {rest}, (\S+)\)", text)
    flats = Flats(float(hamaker), float(offset)).pull_GPa(max(separation, float(least)))
    return np.exp(push) - float(faint) - np.exp(pull) * flats


@pytest.mark.parametrize("waves", [0.0, 0.2])
def test_the_tables_for_spice_hold_the_curves(waves):
    law = pad(waves=waves)
    text = spice_pad(law, 256)
    for separation, deepest, wanted in zip(*pressures(law), strict=True):
        found = by_spice(text, separation, deepest)
        assert found == pytest.approx(
            wanted, abs=2.0 * (CIRCUIT.of_well * well(law) + CIRCUIT.of_net * abs(wanted))
        )


HARDLY_NM = (33.5, 45.0)
"""Deepest closings above all that were computed, and above the way over which openings fade."""


@pytest.mark.parametrize("deepest", HARDLY_NM)
def test_a_pad_that_was_hardly_closed_opens_as_it_closed(deepest):
    """It kept what it was pushed with at its deepest closing, however far it rose."""
    law = pad()
    text = spice_pad(law, 256)
    for separation in (deepest, 60.0, 75.0, 3000.0):
        wanted = float(law.closing_GPa(separation))
        assert by_spice(text, separation, deepest) == pytest.approx(
            wanted, abs=CIRCUIT.of_well * well(law)
        )


@needs_openvaf
@pytest.mark.parametrize("deepest", HARDLY_NM)
def test_openvaf_opens_a_pad_that_was_hardly_closed_as_it_closed(tmp_path, deepest):
    law = pad()
    pressed = compiled(law, tmp_path)
    for separation in (deepest, 60.0, 75.0):
        wanted = float(law.closing_GPa(separation))
        assert pressed(separation, deepest) == pytest.approx(
            wanted, abs=CIRCUIT.of_well * well(law)
        )


def test_attraction_does_not_grow_below_the_deepest_closing():
    """There a wild step of ngspice found a balance that no pad has, and the switch stuck."""
    text = spice_pad(pad(), 256)
    without = re.sub(r"hamaker=\S+", "hamaker=0", text)
    last = pad().separation_nm[0]
    attraction = [
        by_spice(without, place, place) - by_spice(text, place, place)
        for place in (last, last - 5.0, last - 10.0)
    ]
    assert attraction == pytest.approx([attraction[0]] * 3, rel=1e-6)


@needs_ngspice
def test_ngspice_follows_a_history_of_two_closings(tmp_path):
    law = pad()
    (tmp_path / "pad.sub").write_text(spice_pad(law, 256))
    # a millisecond of motion and one of rest for every step; backward Euler, as what overshoots
    # would be remembered
    points = " ".join(f"{2 * k + at}m {s:g}" for k, s in enumerate(HISTORY_NM) for at in (0.0, 1.0))
    time, force = by_ngspice(
        tmp_path,
        f"""* two closings
.include pad.sub
.options reltol=1e-11 vntol=1e-12 abstol=1e-15 method=gear maxord=1
Vs s 0 PWL({points})
X s force rough_pad params: follow=1e-6 area={AREA:g}
.tran 2u {2 * len(HISTORY_NM) - 1}m 0 2u
.control
set wr_singlescale
set numdgt=16
run
wrdata out.txt v(force)
quit
.endc
.end
""",
    )
    at_rest = np.interp((2 * np.arange(len(HISTORY_NM)) + 0.99) * 1e-3, time, force) / AREA
    wanted = pressures(law)[2]
    np.testing.assert_allclose(
        at_rest, wanted, rtol=2.0 * CIRCUIT.of_net, atol=2.0 * CIRCUIT.of_well * well(law)
    )


def test_the_exports_name_what_they_were_made_of():
    law = pad()
    for text in (verilog_pad(law, 256), spice_pad(law, 256)):
        assert "from 256 cells, closed to 20 .. 28 nm" in text


def test_a_pad_that_is_closed_deeper_than_its_table_says_so_at_run_time():
    assert (
        '$strobe("rough_pad: closed to %g nm, the table ends at 20 nm", deepest);'
        in verilog_pad(pad(), 256)
    )


@pytest.mark.parametrize("depths", [1, 2])
@pytest.mark.parametrize("hamaker", [0.0, 0.215])
def test_pads_of_few_depths_and_without_attraction_have_tables(depths, hamaker):
    law = pad(hamaker)
    if hamaker == 0.0:
        law.closing[1], law.opening[:, 1] = 0.0, 0.0 * law.opening[:, 1]
    few = PadCurves(
        law.separation_nm, law.closing, law.depth_nm[:depths], law.opening[:depths], law.flats
    )
    tables = tables_of(few, cubic=True)
    assert len(tables.opening) == depths
    assert "nan" not in verilog_pad(few, 8) + spice_pad(few, 8)
    net = few.opening[0].sum(axis=0)[200]
    assert by_spice(spice_pad(few, 8), few.separation_nm[200], few.depth_nm[0]) == pytest.approx(
        net, rel=0.01, abs=1e-9
    )
