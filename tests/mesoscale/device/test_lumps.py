"""The switch in motion: exact limits, energy, and the compiled Verilog-A beside the same equations in Python."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from mesoscale.device.beam_switch import solve_beam
from mesoscale.device.lumps import VISCOSITY, Study, lumps_of, move, study_lumps
from mesoscale.device.pad_export import FOLLOW_S, START_NM
from mesoscale.device.statistics import analytic_pull_in_V
from mesoscale.device.switch import GPA, NM, switch_from_settings
from mesoscale.device.switch_export import LUMP, spice_switch, verilog_lump
from mesoscale.errors import InputError
from mesoscale.pad.local import LocalPad
from mesoscale.settings import DeviceSettings
from tests.mesoscale.device.simulators import by_ngspice, compile_for_ngspice, needs_ngspice, needs_openvaf
from tests.mesoscale.device.test_beam import made_up_law
from tests.mesoscale.device.test_pad_export import pad

BEAM = DeviceSettings()
PLATE = DeviceSettings(spring_N_per_m=10.0)
VACUUM = {"gas_Pa": 1e-3, "loss_us": 0.0}
LAW = pad()
PAD = LocalPad(LAW)


def test_lumps_vibrate_as_a_clamped_beam():
    """f = 4.730^2 / (2 pi L^2) sqrt(E t^2 / 12 rho)."""
    lumps = lumps_of(BEAM, 12)
    exact = 4.730041**2 / (510e-6) ** 2 * np.sqrt(BEAM.bending_GPa * 1e9 * (4e-6) ** 2 / 12 / 8900)
    assert np.sqrt(lumps.modes[0][0] / NM / lumps.mass_kg_m2) == pytest.approx(exact, rel=2e-3)
    gram = lumps.modes[1].T @ np.diag(lumps.area_m2) @ lumps.modes[1]
    np.testing.assert_allclose(gram, lumps.area_m2.sum() * np.eye(12), atol=1e-6 * lumps.area_m2.sum())


@pytest.mark.parametrize("law", [LAW, made_up_law(0.0), made_up_law(30.0)], ids=["tails", "no adhesion", "adhesion"])
def test_few_lumps_pull_in_and_release_as_the_finite_elements(law):
    study = study_lumps(BEAM, law)
    assert max(study.pull_in, study.release) <= 0.01
    assert study.capacitance <= 0.03
    assert study.lumps <= 28


def test_tilt_hardly_changes_what_the_lumps_leave_out():
    """At a tilt of one standard deviation; it grows with its square, as the half that is higher stretches more."""
    flat, tilted = (solve_beam(BEAM.model_copy(update={"tilt_nm": tilt}), LAW) for tilt in (0.0, 200.0))
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
        slope = (lumps.electric(s + step)[0] - lumps.electric(s - step)[0]) / (2e-3 * NM)
        assert lumps.electric(s)[1][k] * lumps.area_m2[k] == pytest.approx(-0.5 * slope, rel=1e-5)


@pytest.mark.parametrize("s", [30.0, 300.0, 3000.0])
def test_the_gas_is_a_damper_when_slow_and_a_spring_when_fast(s):
    lumps = lumps_of(PLATE)
    thin = 1.0 + 9.638 * (67.3 / s) ** 1.159
    slow = VISCOSITY / thin * lumps.width_m**2 / (s * NM) ** 3 * NM * 1e6  # Pa per nm/us
    excess = 1e-7
    pressure, flow = lumps.gas(np.array(s), np.array(s * (1.0 + excess)))
    assert pressure == pytest.approx(lumps.gas_Pa * excess, rel=1e-6)
    assert pressure == pytest.approx(slow * flow, rel=1e-6)  # in balance the gas flows as fast as the walls come


def flight(volts, lumps, end_us, precision=1e-6):
    return move(lumps, PAD, lambda t: volts, end_us, precision=precision)


def bare_plate():
    return replace(lumps_of(PLATE), **VACUUM)


def test_a_step_closes_an_undamped_plate_above_the_dynamic_pull_in():
    """V = sqrt(k g^3 / 4 eps A), 0.9186 of the static one."""
    static = analytic_pull_in_V(switch_from_settings(PLATE))
    dynamic = np.sqrt(27.0 / 32.0) * static
    for share, closes in ((0.998, False), (1.002, True)):
        lowest = flight(share * dynamic, bare_plate(), 120.0).separation_nm.min()
        assert (lowest < 1500.0) == closes  # half of the electric gap, 1758 nm, is the top


def test_an_undamped_plate_takes_the_time_of_the_energy_integral():
    lumps, volts, switch = bare_plate(), 80.0, switch_from_settings(PLATE)
    electric, mass = switch.gap_nm + switch.dielectric_nm, lumps.mass_kg_m2

    def speed(x):  # nm/us, x the way in nm
        work = 0.5 * volts**2 * 8.8541878128e-12 / NM * (1.0 / (electric - x) - 1.0 / electric)
        return np.sqrt(2.0 * (work - 0.5 * lumps.spring_Pa_nm[0, 0] / NM * (x * NM) ** 2) / mass) * 1e3

    way = switch.gap_nm - 300.0
    exact = quad(lambda root: 2.0 * root / speed(root**2), 0.0, np.sqrt(way))[0]  # x = root^2: 1/v has a root at rest
    motion = flight(volts, lumps, 1.005 * exact)
    found = np.interp(-300.0, -motion.separation_nm[0], motion.time_us)
    assert found == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("times", [10.0, 30.0])
def test_far_above_pull_in_an_undamped_plate_closes_as_if_free(times):
    """t = sqrt(27/8) [sqrt(x (1 - x)) + asin sqrt(x)] V_pi / (V omega), x the way over the gap: a free plate.

    The force at the start, kept, would take sqrt(27/2) sqrt(x) instead: the estimate of Castaner and Senturia, J.
    Microelectromech. Syst. 8 (1999) 290, with x = 1, from above. The spring delays by some 1 / times^2.
    """
    lumps, switch = bare_plate(), switch_from_settings(PLATE)
    omega = np.sqrt(lumps.spring_Pa_nm[0, 0] / NM / lumps.mass_kg_m2) * 1e-6  # 1/us
    x = (switch.gap_nm - 300.0) / (switch.gap_nm + switch.dielectric_nm)
    unit = np.sqrt(27.0 / 8.0) / (times * omega)
    free, constant = unit * (np.sqrt(x * (1.0 - x)) + np.arcsin(np.sqrt(x))), 2.0 * unit
    motion = flight(times * analytic_pull_in_V(switch), lumps, 1.01 * free)
    found = np.interp(-300.0, -motion.separation_nm[0], motion.time_us)
    assert found == pytest.approx(free, rel=0.01)
    assert found < constant


def energies(lumps, motion, volts):
    """Kinetic and elastic energy, and the work of the source less what the field holds (J); shape (times,) each."""
    moving = 0.5 * lumps.mass_kg_m2 * lumps.area_m2 @ (1e-3 * motion.velocity_nm_us) ** 2
    bent = (motion.separation_nm - lumps.rest_nm[:, None]) * NM
    elastic = 0.5 * np.einsum("it,ij,jt->t", bent, lumps.stiffness_N_m, bent)
    longer = 0.5 * np.einsum("it,ij,jt->t", bent, lumps.drawn_m, bent)
    elastic += 0.5 * lumps.stretching_N_m * longer**2
    return moving, elastic, 0.5 * volts**2 * (motion.capacitance_F - motion.capacitance_F[0])


def test_a_beam_in_flight_keeps_its_energy():
    lumps = replace(lumps_of(BEAM, 8), **VACUUM)
    motion = flight(80.0, lumps, 9.8)
    moving, elastic, given = energies(lumps, motion, 80.0)
    assert 250.0 < motion.separation_nm.min() < 1000.0  # before it lands
    assert abs(moving + elastic - given).max() < 2e-3 * given.max()


def test_landing_takes_energy_and_gives_none():
    lumps = replace(lumps_of(BEAM, 8), gas_Pa=1e-3)
    motion = flight(85.0, lumps, 12.0, precision=1e-3)
    moving, elastic, given = energies(lumps, motion, 85.0)
    # what is neither moving nor bent has gone into the pad; its attraction gives back less than it pushes
    lost = given - moving - elastic
    assert motion.separation_nm.min() < 35.0
    assert lost.min() > -0.01 * given.max()
    assert lost[-1] > 0.0


def compiled(lumps, tmp_path):
    """Rates of change of `Lumps.rates`, and charge (C), by the module that OpenVAF compiles for one pair of lumps."""
    import openvaf_py

    path = tmp_path / "rough_lump.va"
    path.write_text(verilog_lump(lumps, LAW, 256))
    (module,) = openvaf_py.compile_va(str(path))
    same = {"fringe": lumps.fringe, "gas": lumps.gas_Pa, "viscosity": VISCOSITY, "follow": FOLLOW_S, "mfactor": 1.0}
    same |= {"V(drawn)": 0.0, **vars(LAW.flats)}

    def of_one(k, s, closed, amount, volts):
        values = same | {"rest": lumps.rest_nm[k], "area": lumps.area_m2[k], "V(top,bottom)": volts}
        values |= {"V(moved)": lumps.rest_nm[k] - s, "V(closed)": closed, "V(lost)": lumps.rest_nm[k] - amount}
        resistive = [pair[0] for pair in module.run_init_eval(values)[0]]
        # terminals, of which the last takes the charge; the states; what draws the lump down
        return -resistive[5] / (1e3 * FOLLOW_S * 1e6), resistive[6], -resistive[4], resistive[7]

    def rates(state, volts):
        s, v, closed, amount = state.reshape(4, -1)
        each = [of_one(k, s[k], closed[k], amount[k], volts) for k in range(lumps.count)]
        closing, gained, charge, drawn = np.array(each).T
        held = lumps.held_Pa(s - lumps.rest_nm + lumps.loss_us * v)[0]
        return np.concatenate([v, -1e-3 * (drawn + held) / lumps.mass_kg_m2, closing, gained]), 1e-15 * charge.sum()

    return rates


@needs_openvaf
@pytest.mark.parametrize("lumps", [lumps_of(PLATE), replace(lumps_of(BEAM, 4), fringe=0.6)], ids=["plate", "beam"])
def test_the_compiled_switch_has_the_same_rates_and_charge(tmp_path, lumps):
    rates = compiled(lumps, tmp_path)
    rng = np.random.default_rng(0)
    for volts, low, high in ((40.0, 22.0, 60.0), (7.0, 30.0, 500.0), (70.0, 1000.0, 3490.0)):
        s = rng.uniform(low, high, lumps.count)
        deepest = np.minimum(s, rng.uniform(20.0, 28.0, lumps.count))  # opened from where its curves are
        gas = s * rng.uniform(0.5, 3.0, lumps.count)
        state = np.concatenate([s, 100.0 * rng.normal(size=lumps.count), START_NM - deepest, gas])
        found, charge = rates(state, volts)
        wanted = lumps.rates(state, volts, PAD)
        # the tables hold the pad's curves to a part of its pressure; the spring and the voltage are alike to the digit
        pressed = abs(PAD(s[:, None], deepest[:, None])[0]).max() * GPA + 1e3
        scale = np.repeat([1.0, 1e-3 * pressed / lumps.mass_kg_m2, 1e3, 1.0], lumps.count)
        np.testing.assert_allclose(found / scale, wanted / scale, rtol=1e-6, atol=0.01)
        assert charge == pytest.approx(volts * lumps.electric(s)[0], rel=1e-8)


@needs_openvaf
def test_the_compiled_plate_closes_as_fast(tmp_path):
    lumps = lumps_of(PLATE)
    rates, start = compiled(lumps, tmp_path), np.array([lumps.rest_nm[0], 0.0, 0.0, lumps.rest_nm[0]])
    solved = solve_ivp(
        lambda t, y: rates(y, 75.0)[0], (0.0, 17.6), start, method="Radau", rtol=1e-3, atol=0.1, first_step=1e-3
    )
    motion = move(lumps, PAD, lambda t: 75.0, 17.6)
    times = [
        np.interp(-100.0, -s[: int(np.argmax(s < 90.0)) + 1], t[: int(np.argmax(s < 90.0)) + 1])
        for s, t in ((solved.y[0], solved.t), (motion.separation_nm[0], motion.time_us))
    ]
    assert times[0] == pytest.approx(times[1], rel=0.01)


def with_compiled_lump(netlist, folder, lumps):
    """The netlist with the module that OpenVAF compiles for ngspice in the place of the subcircuit `rough_lump`."""
    (folder / "rough_lump.va").write_text(verilog_lump(lumps, LAW, 256))
    compile_for_ngspice(folder / "rough_lump.va")
    names = ("rest", "area", "gas", "viscosity", "fringe", "follow")
    head, _, rest = netlist.partition(".subckt rough_lump")
    return f"""{head}.subckt rough_lump{rest.partition("params:")[0]}params: {" ".join(f"{name}=1" for name in names)}
Nlump {LUMP} lump
.model lump rough_lump {" ".join(f"{name}={{{name}}}" for name in names)}
.ends rough_lump
"""


@needs_ngspice
@pytest.mark.parametrize("compiled_lump", [False, True], ids=["SPICE", "OSDI"])
def test_ngspice_closes_the_switch_as_fast_and_as_deep(tmp_path, compiled_lump):
    """A step of 82 V on four pairs of lumps, through the impact; 15 s in ngspice."""
    lumps = lumps_of(BEAM, 4)
    netlist = spice_switch(lumps, Study(4, 0.0, 0.0, 0.0, 70.0, 6.0, 0.0), LAW, 256)
    (tmp_path / "central.sub").write_text(with_compiled_lump(netlist, tmp_path, lumps) if compiled_lump else netlist)
    time, middle, charge = by_ngspice(
        tmp_path,
        f"""* a step
.include central.sub
Vdrive drive 0 PULSE(0 82 1u 10n 10n 150u)
X1 drive 0 middle rough_switch
.options method=gear reltol=1e-4 abstol=1e-3 vntol=1e-3
.tran 10n 35.4u 0 5n
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
    assert time[-1] == pytest.approx(35.4e-6, rel=1e-6)
    motion = move(lumps, PAD, lambda t: 82.0, 34.4)
    wanted = lumps.rest_nm[-1] - motion.separation_nm[-1]
    for way in (1000.0, 2000.0, 3000.0, 3400.0, 3450.0):
        found, known = (
            np.interp(way, y[: np.argmax(y > way) + 1], t[: np.argmax(y > way) + 1])
            for t, y in ((1e6 * time - 1.0, middle), (motion.time_us, wanted))
        )
        assert found == pytest.approx(known, rel=5e-3)
    assert middle.max() == pytest.approx(wanted.max(), abs=1.0)
    far = np.interp(21.0, 1e6 * time, charge)
    assert far == pytest.approx(82e15 * np.interp(20.0, motion.time_us, motion.capacitance_F), rel=5e-3)


HARD = {
    "gap of 10 nm": (PLATE.model_copy(update={"gap_um": 0.0101, "spring_N_per_m": 1e5}), 1.0),
    "gap of 100 um": (PLATE.model_copy(update={"gap_um": 100.0}), 500.0),
    "never lands": (PLATE, 5.0),
    "no voltage": (PLATE, 0.0),
    "just below pull-in": (BEAM, 75.0),
    "just above pull-in": (BEAM, 76.5),
    "vacuum": (BEAM.model_copy(update={"gas_kPa": 1e-6}), 78.0),
    "pressed gas": (BEAM.model_copy(update={"gas_kPa": 1e3}), 78.0),
    "light": (BEAM.model_copy(update={"density_g_cm3": 0.01}), 78.0),
    "heavy": (BEAM.model_copy(update={"density_g_cm3": 30.0}), 78.0),
    "soft spring": (PLATE.model_copy(update={"spring_N_per_m": 1e-3}), 5.0),
    "stiff spring": (PLATE.model_copy(update={"spring_N_per_m": 1e6}), 50.0),
    "no dielectric": (PLATE.model_copy(update={"dielectric_nm": 0.0}), 30.0),
    "thick dielectric": (PLATE.model_copy(update={"dielectric_nm": 1e4}), 70.0),
    "tension": (BEAM.model_copy(update={"residual_stress_MPa": 500.0}), 100.0),
    "bow": (BEAM.model_copy(update={"bow_nm": 1000.0}), 78.0),
}


@pytest.mark.parametrize("name", HARD)
def test_hard_cases_are_followed(name):
    settings, volts = HARD[name]
    lumps, end = lumps_of(settings, 4), 1.0 if settings.spring_N_per_m else 15.0  # a plate in contact rings for long
    motion = move(lumps, PAD, lambda t: volts, end, precision=1e-3)
    assert np.isfinite(motion.separation_nm).all()
    assert motion.time_us[-1] == end
    assert (motion.closed_nm >= -1e-6).all()
    assert (motion.gas_nm > 0.0).all()
    if volts == 0.0:
        np.testing.assert_allclose(
            motion.separation_nm, lumps.rest_nm[:, None] * np.ones(motion.time_us.size), rtol=1e-3
        )
