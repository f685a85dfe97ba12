"""The switch in motion: ngspice at exact limits, ngspice and the compiled Verilog-A beside the
equations in Python.
"""

import re
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from mesoscale.circuit.lumps import LumpErrors, Lumps, choose_lumps, lumps_of
from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.circuit.spice import LUMP, spice_switch
from mesoscale.circuit.verilog import verilog_lump
from mesoscale.errors import InputError
from mesoscale.pad.curves import attracting
from mesoscale.pad.local import LocalPad
from mesoscale.studies.answer_stability import made_up_pad, published_beam
from mesoscale.switch.beam import lumped_beam
from mesoscale.switch.beam_switch import BeamSwitch
from mesoscale.switch.charge import PER_CM2
from mesoscale.switch.plate import PlateSwitch
from mesoscale.theory.charging import charge_shift
from mesoscale.units import GPA, NM, VACUUM_PERMITTIVITY
from tests.mesoscale.circuit.motion import capacitance_F, gas_flow, held_Pa, move, pull_Pa, rates
from tests.mesoscale.circuit.simulators import (
    by_ngspice,
    compile_for_ngspice,
    needs_ngspice,
    needs_openvaf,
)
from tests.mesoscale.circuit.test_tables import pad

BEAM = published_beam()
SPRING = PlateSwitch(published_beam(spring_N_per_m=10.0)).plate
NONE = np.zeros((1, 1))
PLATE = Lumps(
    np.array([SPRING.gap_nm]),
    np.array([SPRING.area_m2]),
    np.array([[SPRING.spring_N_per_m]]),
    NONE,
    NONE[0],
    0.0,
    BEAM.width_um * 1e-6,
    SPRING.dielectric_nm,
    1e3 * BEAM.density_g_cm3 * 1e-6 * BEAM.thickness_um,
    1e3 * BEAM.gas_kPa,
    0.0,
    0.0,
)
"""A plate on a spring as one lump."""
EXACT = LumpErrors(4, 0.0, 0.0, 0.0, 70.0, 6.0, 0.0)
LAW = pad()
PAD = LocalPad(LAW)


def test_lumps_vibrate_as_a_clamped_beam():
    """f = 4.730^2 / (2 pi L^2) sqrt(E t^2 / 12 rho)."""
    lumps = lumps_of(BEAM, 12)
    exact = 4.730041**2 / (510e-6) ** 2 * np.sqrt(BEAM.bending_GPa * 1e9 * (4e-6) ** 2 / 12 / 8900)
    assert 1e6 / (CIRCUIT.quality * lumps.loss_us) == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize(
    "law", [LAW, made_up_pad(0.0), made_up_pad(30.0)], ids=["tails", "no adhesion", "adhesion"]
)
def test_few_lumps_pull_in_and_release_as_the_finite_elements(law):
    errors = choose_lumps(BEAM, law)
    assert max(errors.pull_in, errors.release) <= 0.01
    assert errors.capacitance <= 0.03
    assert errors.lumps <= 28


def test_tilt_hardly_changes_what_the_lumps_leave_out():
    """At a tilt of one standard deviation; it grows with its square, as the half that is higher
    stretches more.
    """
    flat, tilted = (
        BeamSwitch(BEAM.model_copy(update={"tilt_nm": tilt})).states_on(LAW)
        for tilt in (0.0, 200.0)
    )
    assert tilted.release_V == pytest.approx(flat.release_V, rel=1e-2)
    assert tilted.pull_in_V == pytest.approx(flat.pull_in_V, rel=2e-3)


def test_an_odd_number_of_lumps_is_refused():
    with pytest.raises(InputError, match="even number of lumps, at least 4, not 3"):
        lumps_of(BEAM, 3)


@pytest.mark.parametrize("fringe", [0.0, 2.0 / np.pi])
def test_the_pull_is_the_slope_of_the_capacitance(fringe):
    lumps = replace(lumps_of(BEAM, 4), fringe=fringe)
    s = np.array([30.0, 90.0, 800.0, 3000.0])
    for k in range(4):
        step = 1e-3 * np.eye(4)[k]
        slope = (capacitance_F(lumps, s + step) - capacitance_F(lumps, s - step)) / (2e-3 * NM)
        assert pull_Pa(lumps, s)[k] * lumps.area_m2[k] == pytest.approx(-0.5 * slope, rel=1e-5)


@pytest.mark.parametrize("s", [30.0, 300.0, 3000.0])
def test_the_gas_is_a_damper_when_slow_and_a_spring_when_fast(s):
    thin = 1.0 + 9.638 * (67.3 / s) ** 1.159
    # Pa per nm/us
    slow = CIRCUIT.viscosity_Pa_s / thin * PLATE.width_m**2 / (s * NM) ** 3 * NM * 1e6
    excess = 1e-7
    pressure, flow = gas_flow(PLATE, s, s * (1.0 + excess))
    assert pressure == pytest.approx(PLATE.gas_Pa * excess, rel=1e-6)
    # in balance the gas flows as fast as the walls come
    assert pressure == pytest.approx(slow * flow, rel=1e-6)


def compiled(lumps, tmp_path):
    """Changes as `rates` gives them, and charge (C), by the module that OpenVAF compiles for one
    pair of lumps.
    """
    import openvaf_py

    path = tmp_path / "rough_lump.va"
    path.write_text(verilog_lump(lumps, LAW, 256))
    (module,) = openvaf_py.compile_va(str(path))
    same = {"fringe": lumps.fringe, "gas": lumps.gas_Pa, "viscosity": CIRCUIT.viscosity_Pa_s}
    same |= {"follow": CIRCUIT.follow_s, "mfactor": 1.0, "V(drawn)": 0.0, **vars(LAW.flats)}

    def of_one(k, s, closed, amount, volts):
        values = same | {"rest": lumps.rest_nm[k], "area": lumps.area_m2[k], "V(top,bottom)": volts}
        values |= {
            "V(moved)": lumps.rest_nm[k] - s,
            "V(closed)": closed,
            "V(lost)": lumps.rest_nm[k] - amount,
        }
        resistive = [pair[0] for pair in module.run_init_eval(values)[0]]
        # terminals, of which the last takes the charge; the states; what draws the lump down
        return (
            -resistive[5] / (1e3 * CIRCUIT.follow_s * 1e6),
            resistive[6],
            -resistive[4],
            resistive[7],
        )

    def changes(state, volts):
        s, v, closed, amount = state.reshape(4, -1)
        each = [of_one(k, s[k], closed[k], amount[k], volts) for k in range(lumps.count)]
        closing, gained, charge, drawn = np.array(each).T
        held = held_Pa(lumps, s - lumps.rest_nm + lumps.loss_us * v)
        return (
            np.concatenate([v, -1e-3 * (drawn + held) / lumps.mass_kg_m2, closing, gained]),
            1e-15 * charge.sum(),
        )

    return changes


@needs_openvaf
@pytest.mark.parametrize(
    "lumps", [PLATE, replace(lumps_of(BEAM, 4), fringe=0.6)], ids=["plate", "beam"]
)
def test_the_compiled_switch_has_the_same_rates_and_charge(tmp_path, lumps):
    changes = compiled(lumps, tmp_path)
    rng = np.random.default_rng(0)
    for volts, low, high in ((40.0, 22.0, 60.0), (7.0, 30.0, 500.0), (70.0, 1000.0, 3490.0)):
        s = rng.uniform(low, high, lumps.count)
        # opened from where its curves are
        deepest = np.minimum(s, rng.uniform(20.0, 28.0, lumps.count))
        gas = s * rng.uniform(0.5, 3.0, lumps.count)
        state = np.concatenate(
            [s, 100.0 * rng.normal(size=lumps.count), CIRCUIT.start_nm - deepest, gas]
        )
        found, charge = changes(state, volts)
        wanted = rates(lumps, state, volts, PAD)
        # the tables hold the pad's curves to a part of its pressure; the spring and the voltage are
        # alike to the digit
        pressed = abs(PAD(s[:, None], deepest[:, None])[0]).max() * GPA + 1e3
        scale = np.repeat([1.0, 1e-3 * pressed / lumps.mass_kg_m2, 1e3, 1.0], lumps.count)
        np.testing.assert_allclose(found / scale, wanted / scale, rtol=1e-6, atol=0.01)
        assert charge == pytest.approx(volts * capacitance_F(lumps, s), rel=1e-8)


def with_compiled_lump(netlist, folder, lumps):
    """The netlist with the module that OpenVAF compiles for ngspice in the place of the subcircuit
    `rough_lump`.
    """
    (folder / "rough_lump.va").write_text(verilog_lump(lumps, LAW, 256))
    compile_for_ngspice(folder / "rough_lump.va")
    names = ("rest", "area", "gas", "viscosity", "fringe", "follow")
    head, _, rest = netlist.partition(".subckt rough_lump")
    nodes = rest.partition("params:")[0]
    unset = " ".join(f"{name}=1" for name in names)
    passed = " ".join(f"{name}={{{name}}}" for name in names)
    return f"""{head}.subckt rough_lump{nodes}params: {unset}
Nlump {LUMP} lump
.model lump rough_lump {passed}
.ends rough_lump
"""


def stepped(folder, lumps, volts, end_us, compiled_lump=False, **parameters):
    """Time (us) after a step of the voltage, way of mid-span (nm) and charge (fC), by ngspice."""
    netlist = spice_switch(lumps, EXACT, LAW, 256, EXACT.pull_in_V)
    (folder / "central.sub").write_text(
        with_compiled_lump(netlist, folder, lumps) if compiled_lump else netlist
    )
    time_s, middle, charge = by_ngspice(
        folder,
        f"""* a step
.include central.sub
Vdrive drive 0 PULSE(0 {volts} 1u 10n 10n 1)
X1 drive 0 middle rough_switch {" ".join(f"{name}={value:g}" for name, value in parameters.items())}
.options method=gear reltol=1e-4 abstol=1e-3 vntol=1e-3
.tran 10n {end_us + 1.0}u 0 5n
.control
{"pre_osdi rough_lump.osdi" if compiled_lump else ""}
set wr_singlescale
set numdgt=12
run
wrdata out.txt v(middle) v(x1.charge)
quit
.endc
.end
""",
    )
    return 1e6 * time_s - 1.005, middle, charge  # from the middle of the rise


@needs_ngspice
def test_a_step_closes_an_undamped_plate_above_the_dynamic_pull_in(tmp_path):
    """V = sqrt(k g^3 / 4 eps A), 0.9186 of the static one."""
    dynamic = np.sqrt(27.0 / 32.0) * SPRING.pull_in_V
    for share, closes in ((0.995, False), (1.005, True)):
        way = stepped(tmp_path, PLATE, share * dynamic, 100.0, gas=1e-3)[1].max()
        assert (way > 2000.0) == closes  # half of the electric gap, 1758 nm, is the top


@needs_ngspice
def test_an_undamped_plate_takes_the_time_of_the_energy_integral(tmp_path):
    volts = 80.0
    electric = SPRING.gap_nm + SPRING.dielectric_nm

    def speed(x):  # nm/us, x the way in nm
        work = 0.5 * volts**2 * VACUUM_PERMITTIVITY / NM * (1.0 / (electric - x) - 1.0 / electric)
        elastic = 0.5 * SPRING.spring_N_per_m / SPRING.area_m2 * (x * NM) ** 2
        return np.sqrt(2.0 * (work - elastic) / PLATE.mass_kg_m2) * 1e3

    way = SPRING.gap_nm - 300.0
    # x = root^2: 1/v has a root at rest
    exact = quad(lambda root: 2.0 * root / speed(root**2), 0.0, np.sqrt(way))[0]
    time_us, moved, _ = stepped(tmp_path, PLATE, volts, 1.005 * exact, gas=1e-3)
    assert np.interp(way, moved, time_us) == pytest.approx(exact, rel=2e-3)


@needs_ngspice
@pytest.mark.parametrize("compiled_lump", [False, True], ids=["SPICE", "OSDI"])
def test_ngspice_closes_the_switch_as_fast_and_as_deep(tmp_path, compiled_lump):
    """A step of 82 V on four pairs of lumps, through the impact; 15 s in ngspice."""
    lumps = lumps_of(BEAM, 4)
    time, middle, charge = stepped(tmp_path, lumps, 82, 34.4, compiled_lump)
    assert time[-1] == pytest.approx(34.395, abs=1e-6)
    moved_us, separation_nm = move(lumps, PAD, 82.0, 34.4)
    wanted = lumps.rest_nm[-1] - separation_nm[-1]
    for way in (1000.0, 2000.0, 3000.0, 3400.0, 3450.0):
        found, known = (
            np.interp(way, y[: np.argmax(y > way) + 1], t[: np.argmax(y > way) + 1])
            for t, y in ((time, middle), (moved_us, wanted))
        )
        assert found == pytest.approx(known, rel=5e-3)
    assert middle.max() == pytest.approx(wanted.max(), abs=1.0)
    far = np.interp(20.0, time, charge)
    assert far == pytest.approx(
        82e15 * np.interp(20.0, moved_us, capacitance_F(lumps, separation_nm.T)), rel=5e-3
    )


@needs_ngspice
def test_the_example_of_the_docs_runs_in_batch(tmp_path):
    example = re.search(r"```\n(\* a step.*?)```", Path("docs/circuit.md").read_text(), re.DOTALL)[
        1
    ]
    lumps, closes_V = lumps_of(BEAM, 12), BeamSwitch(BEAM).states_on(LAW).pull_in_V
    (tmp_path / "central.sub").write_text(spice_switch(lumps, EXACT, LAW, 256, closes_V))
    assert "reltol=1e-5" in example  # 1e-3 allows 3 nm in the depth that the pad remembers
    (tmp_path / "step.cir").write_text(example)
    subprocess.run(
        ["ngspice", "-b", "step.cir"], cwd=tmp_path, check=True, capture_output=True, timeout=300
    )
    time_s, middle_nm, _, _ = np.loadtxt(tmp_path / "step.txt").T
    assert time_s[-1] == pytest.approx(250e-6)
    assert middle_nm.max() > lumps.rest_nm[-1] - PAD.at_nm[-1]  # on the pad
    assert abs(middle_nm[-1]) < 0.5 * lumps.rest_nm[-1]  # and off it after the step


@needs_ngspice
def test_the_slow_loop_of_the_docs_lets_go_as_the_beam_in_balance(tmp_path):
    """On a pad that tears off in jerks. A share of 0.2 % is what a delay of 4 ms adds."""
    example = re.search(r"```\n(\* up in 3 s.*?)```", Path("docs/circuit.md").read_text(), re.S)[1]
    law = attracting(pad(waves=0.2), 0.3)
    closes_V = BeamSwitch(BEAM).states_on(law).pull_in_V
    held = published_beam(hold_voltage_V=1.02 * closes_V)
    in_balance = BeamSwitch(held, lumped_beam(held, 8)).states_on(law)
    lumps = lumps_of(BEAM, 8)
    (tmp_path / "central.sub").write_text(spice_switch(lumps, EXACT, law, 256, closes_V))
    (tmp_path / "loop.cir").write_text(example)
    subprocess.run(
        ["ngspice", "-b", "loop.cir"], cwd=tmp_path, check=True, capture_output=True, timeout=300
    )
    time_s, middle_nm, _, volts = np.loadtxt(tmp_path / "loop.txt").T
    assert time_s[-1] == pytest.approx(14.0)
    falling = time_s > 3.0
    opened = middle_nm[falling] < 0.5 * lumps.rest_nm[-1]
    assert volts[falling][opened.argmax()] == pytest.approx(in_balance.release_V, rel=5e-3)
    assert abs(middle_nm[-1]) < 1.0  # back at rest


def test_elements_join_neighbours_alone():
    """So that a simulator's matrix is sparse."""
    lumps = lumps_of(BEAM, 16)
    for k, row in enumerate(lumps.springs[:16]):
        joined = set((np.flatnonzero(row) % 16).tolist())
        assert joined == {place for place in (k - 1, k, k + 1) if 0 <= place < 16}


@needs_ngspice
def test_charged_lumps_move_as_felt(tmp_path):
    """First swings after a step: 42 V less a shift of 12 V is 30 V; 20 V of coarse charge add their
    square.
    """

    def swing_nm(volts, **changes):
        folder = tmp_path / f"{volts:g}{''.join(changes)}"
        folder.mkdir()
        return stepped(folder, lumps_of(published_beam(**changes), 4), volts, 15.0)[1].max()

    volt = charge_shift(PER_CM2, BEAM.dielectric_nm, BEAM.permittivity)
    coarse = {"waves": [(1e9, 20.0 / volt)]}
    plain = swing_nm(30.0)
    # the simulator begins at rest, and has moved a little in the microsecond before the step
    assert swing_nm(42.0, shift_V=12.0) == pytest.approx(plain, rel=0.1)
    assert swing_nm(30.0, uneven=coarse) == pytest.approx(swing_nm(np.sqrt(1300.0)), rel=0.1)
    assert swing_nm(42.0) > 1.5 * plain


def test_netlists_without_charge_have_no_trace_of_it():
    text = spice_switch(lumps_of(BEAM, 4), EXACT, LAW, 256, EXACT.pull_in_V)
    assert "felt" not in text
    assert "uneven" not in verilog_lump(lumps_of(BEAM, 4), LAW, 256)
    charged = lumps_of(published_beam(uneven={"patch_nm": 50.0, "e_cm2": 1e11}), 4)
    assert "(volts * volts + uneven(s))" in verilog_lump(charged, LAW, 256)
