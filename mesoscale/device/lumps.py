"""A switch in motion: its electrode as few lumps with mass, squeezed gas, charge, and a place of the pad each.

The lumps of a bending electrode are pairs of places, mirrored at mid-span, with the exact stiffness of the beam between
them; a plate is one lump. For each lump, s its separation, A its area, b the width of the electrode,

    rho t s'' = p_pad(s, deepest) - eps0 V^2 / 2 [1 / e^2 + fringe / (b e)] + P0 (n / s - 1) - F / A
    F   = K u + (S / 2) (z.D z - z0.D z0) D z
    n'  = -(P - P0) P s^3 / (P0 mu b^2),    P = P0 n / s,    mu = viscosity / (1 + 9.638 Kn^1.159)
    Q   = V eps0 sum A [1 / e + fringe / b ln(pi b / e)],    e = s + t / eps_r

with u = s - rest, z = z0 + u the height over the anchors, z0 that at rest, z.D z / 2 the elongation of the beam, and S
its stretching stiffness, EA / L where anchors are rigid.
The gas of a long strip: small slow motion feels the incompressible film, mu b^3 / s^3 per length, and fast motion the
spring P0 A / s of trapped gas, the two limits of Blech, J. Lubr. Technol. 105 (1983) 615. Viscosity in narrow gaps is
that of Veijola et al., Sens. Actuators A 48 (1995) 239, Kn the mean free path over s. A fringe of 2 / pi is that of a
thin strip over a plane (Palmer, Trans. AIEE 56 (1937) 363).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from mesoscale.device.beam import Beam, assembled, lumped_beam
from mesoscale.device.beam_kernels import NM, least_gap_nm
from mesoscale.device.beam_switch import BeamStates, solve_beam, solve_bent
from mesoscale.device.pad_export import FOLLOW_S, LEAK, START_NM
from mesoscale.device.switch import GPA, VACUUM_PERMITTIVITY, switch_from_settings
from mesoscale.errors import InputError
from mesoscale.pad.local import LocalPad
from mesoscale.pad.memory import PadLaw
from mesoscale.settings import DeviceSettings

Array = NDArray[np.float64]

VISCOSITY = 1.83e-5
"""Of air at 23 C (Pa s); Jennings, J. Aerosol Sci. 19 (1988) 159."""
FREE_PATH_nm_Pa = 67.3 * 101325.0
"""Mean free path in air times the pressure; the same source."""
RELEASE, CAPACITANCE = 0.01, 0.03
"""Allowed errors of lumps beside the finite elements: of release and pull-in, and of the held capacitance."""
REFERENCE = 1024
"""Finite elements that judge lumps. On a pad of few cells, which tears off in jerks, 512 release up to 0.8 % off."""
COUNTS = (8, 12, 16, 20, 24, 28, 32, 40, 48)
LEAST_NM, LEAST_GAS = 1.0, 1e-6
"""Thickness of the gas, and its density over that around: no less, or a step into nothing would not come back."""
STEP = 1e-5
"""For derivatives (nm, nm/us)."""
QUALITY = 1e3
"""Of the first mode by losses in the electrode, an assumption. They grow with frequency: what rings fast dies."""
PRECISION = 1e-4


@dataclass(frozen=True)
class Lumps:
    """What moves.

    Attributes
    ----------
    rest_nm, area_m2 : separation at rest and area of the lumps, from the ends to mid-span, shape (n,).
    stiffness_N_m : forces that hold the lumps at small displacements, but for what they stretch, shape (n, n).
    drawn_m : D, twice the elongation of the beam (m) by the squares of heights (m), in 1/m, shape (n, n).
    height_nm : z0, height at rest over the anchors, shape (n,).
    stretching_N_m : S; 0 of a plate.
    width_m, dielectric_nm : of the electrode; thickness of the dielectric over its permittivity.
    mass_kg_m2 : mass per area.
    gas_Pa : pressure of the gas around.
    loss_us : a moving electrode resists as if it were displaced by so much more of its velocity.
    drag_Pa_us_nm : pressure against a velocity, none in a switch. A large one lands the electrode softly and stops what
        rings, so that a slow loop is that of `device/loop.csv`.
    fringe : see above.
    """

    rest_nm: Array
    area_m2: Array
    stiffness_N_m: Array
    drawn_m: Array
    height_nm: Array
    stretching_N_m: float
    width_m: float
    dielectric_nm: float
    mass_kg_m2: float
    gas_Pa: float
    loss_us: float = 0.0
    drag_Pa_us_nm: float = 0.0
    fringe: float = 0.0

    @property
    def count(self) -> int:
        """Number of lumps."""
        return self.rest_nm.size

    @cached_property
    def spring_Pa_nm(self) -> Array:
        """Pressure on the lumps by displacements, shape (n, n)."""
        return self.stiffness_N_m * NM / self.area_m2[:, None]

    @cached_property
    def sloped(self) -> Array:
        """D in 1/nm times the stretching stiffness in Pa/nm of each lump, shape (n, n)."""
        return self.stretching_N_m * NM**2 * self.drawn_m / self.area_m2[:, None]

    def held_Pa(self, bent_nm: Array) -> tuple[Array, Array]:
        """Pressure of the bent electrode on its lumps, shape (n,), and its derivatives (Pa/nm), shape (n, n)."""
        z = self.height_nm + bent_nm
        drawn = self.drawn_m @ z
        longer_nm = 0.5 * NM * (z @ drawn - self.height_nm @ self.drawn_m @ self.height_nm)
        pull = self.sloped @ z
        slopes = self.spring_Pa_nm + longer_nm * self.sloped + np.outer(pull, NM * drawn)
        return self.spring_Pa_nm @ bent_nm + longer_nm * pull, slopes

    @cached_property
    def modes(self) -> tuple[Array, Array]:
        """Stiffness (Pa/nm) of the modes of vibration, (n,), and their shapes of mean square 1, (lumps, modes)."""
        root = np.sqrt(self.area_m2)
        at_rest = self.held_Pa(np.zeros(self.count))[1] * self.area_m2[:, None]
        stiffness, vectors = np.linalg.eigh(0.5 * (at_rest + at_rest.T) / np.outer(root, root))
        return stiffness, vectors * np.sqrt(self.area_m2.sum()) / root[:, None]

    def electric(self, separation_nm: Array) -> tuple[Array, Array]:
        """Capacitance (F, shape (...,)) and pull of 1 V (Pa, shape (..., n)) at separations of shape (..., n)."""
        gap = np.maximum(separation_nm + self.dielectric_nm, least_gap_nm(self.dielectric_nm)) * NM
        edge = self.fringe / self.width_m
        capacitance = VACUUM_PERMITTIVITY * (1.0 / gap + edge * np.log(np.pi * self.width_m / gap)) @ self.area_m2
        return capacitance, 0.5 * VACUUM_PERMITTIVITY * (1.0 / gap**2 + edge / gap)

    def gas(self, separation_nm: Array, amount_nm: Array) -> tuple[Array, Array]:
        """Pressure above that around (Pa), and the flow out (nm/us), of gas n; any shape."""
        s = np.maximum(separation_nm, LEAST_NM)
        excess = amount_nm / s - 1.0
        dense = np.maximum(1.0 + excess, LEAST_GAS)
        thinner = 1.0 + 9.638 * (FREE_PATH_nm_Pa / (self.gas_Pa * dense * s)) ** 1.159
        flow = self.gas_Pa * dense * excess * (s * NM) ** 3 * thinner / (VISCOSITY * self.width_m**2)
        return self.gas_Pa * excess, 1e3 * flow

    def rates(self, state: Array, voltage: float, pad: LocalPad) -> Array:
        """Changes per us of separations (nm), velocities (nm/us), depths closed (nm) and gas (nm), shape (4 n,)."""
        s, v, closed, amount = state.reshape(4, -1)
        deepest = np.minimum(START_NM - closed, s)
        pressure = pad(s[:, None], deepest[:, None])[0][:, 0] * GPA - voltage**2 * self.electric(s)[1]
        excess, flow = self.gas(s, amount)
        pressure += excess - self.drag_Pa_us_nm * v - self.held_Pa(s - self.rest_nm + self.loss_us * v)[0]
        follow = (np.maximum(START_NM - s - closed, 0.0) - LEAK * closed) / (1e6 * FOLLOW_S)
        return np.concatenate([v, 1e-3 * pressure / self.mass_kg_m2, follow, -flow])

    def slopes(self, state: Array, voltage: float, pad: LocalPad) -> Array:
        """Derivatives of the rates, shape (4 n, 4 n): by differences, as but for the spring all is local to a lump."""
        n, here = self.count, self.rates(state, voltage, pad)
        s, v = state.reshape(4, -1)[:2]
        held = self.held_Pa(s - self.rest_nm + self.loss_us * v)[1]
        slopes, spring = np.zeros((4, n, 4, n)), -1e-3 * held / self.mass_kg_m2
        for k, elastic in enumerate((1.0, self.loss_us, 0.0, 0.0)):
            step = STEP * np.eye(4)[k].repeat(n)
            change = ((self.rates(state + step, voltage, pad) - here) / STEP).reshape(4, n)
            change[1] -= elastic * spring.sum(axis=1)
            for row in range(4):
                slopes[row, :, k] = np.diag(change[row])
            slopes[1, :, k] += elastic * spring
        return slopes.reshape(4 * n, 4 * n)


@dataclass(frozen=True)
class Motion:
    """A motion of lumps.

    Attributes
    ----------
    time_us, voltage_V, capacitance_F : shape (times,).
    separation_nm, velocity_nm_us, closed_nm, gas_nm : of the lumps, shape (n, times).
    """

    time_us: Array
    voltage_V: Array
    capacitance_F: Array
    separation_nm: Array
    velocity_nm_us: Array
    closed_nm: Array
    gas_nm: Array


def move(
    lumps: Lumps,
    pad: LocalPad,
    voltage: Callable[[float], float],
    end_us: float,
    breaks_us: tuple[float, ...] = (),
    precision: float = PRECISION,
) -> Motion:
    """The motion from rest under a voltage in time (V of us).

    Parameters
    ----------
    breaks_us : times at which the voltage has a kink or a jump.
    precision : relative error of a step.

    Raises
    ------
    InputError : the integration fails.
    """
    nothing = np.zeros(lumps.count)
    state = np.concatenate([lumps.rest_nm, nothing, nothing, lumps.rest_nm])
    absolute = precision * np.repeat([1e2, 1e3, 1e2, 1e2], lumps.count)
    times, states = [], []
    for start, end in zip((0.0, *breaks_us), (*breaks_us, end_us), strict=True):
        middle = 0.5 * (start + end)
        inside = 1e-9 * (end - start)  # a jump belongs to what follows it
        solved = solve_ivp(
            lambda t, y, a=start + inside, b=end - inside: lumps.rates(y, voltage(min(max(t, a), b)), pad),
            (start, end),
            state,
            method="Radau",
            jac=lambda t, y, a=start + inside, b=end - inside: lumps.slopes(y, voltage(min(max(t, a), b)), pad),
            rtol=precision,
            atol=absolute,
            first_step=min(1e-3, middle - start),
        )
        if not solved.success:
            raise InputError(f"device: the motion of the switch cannot be followed beyond {solved.t[-1]:.6g} us")
        times.append(solved.t)
        states.append(solved.y)
        state = solved.y[:, -1]
    time, all_states = np.concatenate(times), np.concatenate(states, axis=1).reshape(4, lumps.count, -1)
    capacitance = lumps.electric(all_states[0].T)[0]
    return Motion(time, np.array([voltage(t) for t in time]), capacitance, *all_states)


def lumps_of(settings: DeviceSettings, lumps: int = 0) -> Lumps:
    """The moving parts of the settings: `lumps` of a bending electrode, without its tilt; one of a plate.

    Raises
    ------
    InputError : see `lumped_beam`.
    """
    switch = switch_from_settings(settings)
    common = {
        "width_m": settings.width_um * 1e-6,
        "dielectric_nm": switch.dielectric_nm,
        "mass_kg_m2": 1e3 * settings.density_g_cm3 * 1e-6 * settings.thickness_um,
        "gas_Pa": 1e3 * settings.gas_kPa,
        "fringe": settings.fringe if settings.bends else 0.0,
    }
    if not settings.bends:
        one, nothing = np.array([[switch.spring_N_per_m]]), np.zeros((1, 1))
        plate = np.array([switch.gap_nm]), np.array([switch.area_m2]), one, nothing, nothing[0], 0.0
        return _with_loss(Lumps(*plate, **common))
    beam = lumped_beam(settings.model_copy(update={"tilt_nm": 0.0}), lumps)
    area = 2.0 * beam.width_m * beam.weights_m[:lumps, 0]
    rest_nm, height_nm = beam.rest_m[:lumps, 0] / NM, beam.rest_nodal[1 : lumps + 1, 0] / NM
    elastic = *_paired_stiffness(beam), height_nm, beam.stretching_N_m
    return _with_loss(Lumps(rest_nm, area, *elastic, **common))


def _with_loss(lumps: Lumps) -> Lumps:
    """The same with the loss of `QUALITY`."""
    slowest = np.sqrt(lumps.modes[0][0] / NM / lumps.mass_kg_m2)
    return replace(lumps, loss_us=1e6 / (QUALITY * float(slowest)))


def _paired_stiffness(beam: Beam) -> tuple[Array, Array]:
    """Stiffness and D of a lumped beam against equal displacements of its mirrored places, shape (n, n) each.

    Slopes follow the displacements as they do at rest, without what stretches the beam.
    """
    _, bends, pulled, *_ = beam.mechanics
    drawn, free = assembled(pulled)[2:-2, 2:-2], assembled(bends)[2:-2, 2:-2]
    free = free + beam.tension_N * drawn
    follow = -np.linalg.solve(free[1::2, 1::2], free[1::2, ::2])
    whole = np.empty((len(free), len(follow)))
    whole[::2], whole[1::2] = np.eye(len(follow)), follow
    half = len(follow) // 2
    paired = whole @ np.vstack([np.eye(half), np.eye(half)[::-1]])
    stiffness, folded = (paired.T @ of @ paired for of in (free, drawn))
    return 0.5 * (stiffness + stiffness.T), 0.5 * (folded + folded.T)


@dataclass(frozen=True)
class Study:
    """How many lumps an electrode needs, their errors beside the finite elements, and what these say.

    An error of 1 is that of a release which only one of both has. `reference` is the larger of the changes of pull-in
    and release from half as many finite elements.
    """

    lumps: int
    pull_in: float
    release: float
    capacitance: float
    pull_in_V: float
    release_V: float
    reference: float


def study_lumps(settings: DeviceSettings, law: PadLaw) -> Study:
    """The fewest lumps of a bending electrode within the allowed errors, else the most.

    Raises
    ------
    NotComputed, InputError : see `solve_beam`.
    """
    half, wanted = (solve_beam(settings, law, elements) for elements in (REFERENCE // 2, REFERENCE))
    said = wanted.pull_in_V, wanted.release_V, max(_errors(half, wanted)[:2])
    symmetric = settings.model_copy(update={"tilt_nm": 0.0})
    study = Study(0, 1.0, 1.0, 1.0, *said)
    for count in COUNTS:
        errors = _errors(solve_bent(lumped_beam(symmetric, count), symmetric, law), wanted)
        study = Study(count, *errors, *said)
        if max(study.pull_in, study.release) <= RELEASE and study.capacitance <= CAPACITANCE:
            break
    return study


def _errors(made: BeamStates, wanted: BeamStates) -> tuple[float, float, float]:
    pairs = ((made.pull_in_V, wanted.pull_in_V), (made.release_V, wanted.release_V))
    pull_in, release = (0.0 if a == b else abs(a / b - 1.0) if a and b else 1.0 for a, b in pairs)
    return pull_in, release, abs(made.capacitance_fF / wanted.capacitance_fF - 1.0)
