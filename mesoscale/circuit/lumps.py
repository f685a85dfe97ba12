"""The electrode as few lumps: pairs of places, mirrored at mid-span, with the stiffness of the beam
between them.

For each lump, s its separation, A its area, b the width of the electrode, mass per area rho t,

    rho t s'' = p_pad(s, deepest) - eps0 W / 2 [1 / e^2 + fringe / (b e)] + P0 (n / s - 1) - F / A
    W   = (V - V_s)^2 + U^2(s), with V_s and U of charge (docs/charging.md)
    F   = K u + (S / 2) (z.D z - z0.D z0) D z
    n'  = -(P - P0) P s^3 / (P0 mu b^2),    P = P0 n / s,    mu = viscosity / (1 + 9.638 Kn^1.159)
    Q   = (V - V_s) eps0 sum A [1 / e + fringe / b ln(pi b / e)],    e = s + t / eps_r

with u = s - rest, z = z0 + u the height over the anchors, z0 that at rest, z.D z / 2 the elongation
of the beam, and S its stretching stiffness, EA / L where anchors are rigid. The gas of a long
strip: small slow motion feels the incompressible film, mu b^3 / s^3 per length, and fast motion the
spring P0 A / s of trapped gas, the two limits of Blech, J. Lubr. Technol. 105 (1983) 615. Viscosity
in narrow gaps is that of Veijola et al., Sens. Actuators A 48 (1995) 239, Kn the mean free path
over s. A fringe of 2 / pi is that of a thin strip over a plane (Palmer, Trans. AIEE 56 (1937) 363).
Simulators integrate these equations (`mesoscale.circuit.spice`).
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import DeviceSettings
from mesoscale.switch.beam import Beam, assembled, beam_of, lumped_beam
from mesoscale.switch.beam_switch import BeamStates, BeamSwitch
from mesoscale.switch.charge import shift_V, uneven_V2
from mesoscale.units import NM

Array = NDArray[np.float64]

CAPACITANCE_ERROR = 0.03
"""Allowed error of lumps beside the finite elements, of the held capacitance."""

UNEVEN_FROM_NM, UNEVEN_NODES = 0.1, 120
"""First separation, and number, of the nodes of uneven charge, 9 % apart."""


@dataclass(frozen=True)
class Lumps:
    """What moves.

    Attributes
    ----------
    rest_nm, area_m2 : separation at rest and area of the lumps, from the ends to mid-span, shape
        (n,).
    stiffness_N_m : K, forces that hold the lumps at small displacements, but for what they stretch,
        shape (n, n).
    drawn_m : D, twice the elongation of the beam (m) by the squares of heights (m), in 1/m, shape
        (n, n).
    height_nm : z0, height at rest over the anchors, shape (n,).
    stretching_N_m : S.
    width_m, dielectric_nm : of the electrode; thickness of the dielectric over its permittivity.
    mass_kg_m2 : mass per area.
    gas_Pa : pressure of the gas around.
    loss_us : a moving electrode resists as if it were displaced by so much more of its velocity.
    fringe : see above.
    shift_V : V_s of even charge and contact potential, which the electrode does not feel.
    uneven_V2 : separations (nm), and what uneven charge adds to the square of the voltage there,
        shape (2, n); n is 0 without it.
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
    loss_us: float
    fringe: float
    shift_V: float = 0.0
    uneven_V2: Array = field(default_factory=lambda: np.empty((2, 0)))

    @property
    def count(self) -> int:
        """Number of lumps."""
        return self.rest_nm.size


def lumps_of(settings: DeviceSettings, count: int) -> Lumps:
    """So many lumps of the electrode, without its tilt, with the loss of the assumed quality.

    Raises
    ------
    InputError : see `lumped_beam`.
    """
    beam = lumped_beam(settings.level, count)
    area = 2.0 * beam.width_m * beam.weights_m[:count, 0]
    heights_m = beam.rest_nodal[1 : count + 1, 0]
    stiffness, drawn = _paired_stiffness(beam)
    mass = 1e3 * settings.density_g_cm3 * 1e-6 * settings.thickness_um
    at_rest = stiffness + beam.stretching_N_m * np.outer(drawn @ heights_m, drawn @ heights_m)
    slowest = np.linalg.eigvalsh(at_rest / np.sqrt(np.outer(area, area)))[0] / mass
    return Lumps(
        beam.rest_m[:count, 0] / NM,
        area,
        stiffness,
        drawn,
        heights_m / NM,
        beam.stretching_N_m,
        settings.width_um * 1e-6,
        settings.dielectric_gap_nm,
        mass,
        1e3 * settings.gas_kPa,
        1e6 / (CIRCUIT.quality * float(np.sqrt(slowest))),
        settings.fringe,
        shift_V(settings),
        _uneven(settings, float(beam.rest_m.max()) / NM),
    )


def _uneven(settings: DeviceSettings, farthest_nm: float) -> Array:
    """Nodes of U^2 between touch and rest."""
    if settings.uneven is None:
        return np.empty((2, 0))
    separation_nm = np.concatenate([[0.0], np.geomspace(UNEVEN_FROM_NM, farthest_nm, UNEVEN_NODES)])
    return np.stack([separation_nm, uneven_V2(settings, separation_nm)])


def _paired_stiffness(beam: Beam) -> tuple[Array, Array]:
    """Stiffness and D of a lumped beam against equal displacements of its mirrored places, shape
    (n, n) each.

    Slopes follow the displacements as they do at rest, without what stretches the beam.
    """
    drawn = assembled(beam.mechanics.pulled)[2:-2, 2:-2]
    free = assembled(beam.mechanics.bending_N_m)[2:-2, 2:-2]
    free = free + beam.tension_N * drawn
    follow = -np.linalg.solve(free[1::2, 1::2], free[1::2, ::2])
    joined = np.empty((len(free), len(follow)))
    joined[::2] = np.eye(len(follow))
    joined[1::2] = follow
    half = len(follow) // 2
    paired = joined @ np.vstack([np.eye(half), np.eye(half)[::-1]])
    stiffness, folded = (paired.T @ of @ paired for of in (free, drawn))
    return 0.5 * (stiffness + stiffness.T), 0.5 * (folded + folded.T)


@dataclass(frozen=True)
class LumpErrors:
    """How many lumps an electrode needs, their errors beside the finite elements, and what these
    say.

    An error of 1 is that of a release which only one of both has. `reference` is the larger of the
    changes of pull-in and release from half as many finite elements.
    """

    lumps: int
    pull_in: float
    release: float
    capacitance: float
    pull_in_V: float
    release_V: float
    reference: float


def choose_lumps(settings: DeviceSettings, pad: PadCurves) -> LumpErrors:
    """The fewest lumps of a bending electrode within the allowed errors, else the most.

    Raises
    ------
    NotComputed, InputError : see `BeamSwitch.states_on`.
    """
    elements = CIRCUIT.reference_elements
    half = BeamSwitch(settings, beam_of(settings, elements // 2)).states_on(pad)
    exact = BeamSwitch(settings, beam_of(settings, elements)).states_on(pad)
    count = 0
    errors = (1.0, 1.0, 1.0)
    for count in CIRCUIT.lump_counts:
        lumped = BeamSwitch(settings.level, lumped_beam(settings.level, count))
        errors = _errors(lumped.states_on(pad), exact)
        if max(errors[:2]) <= CIRCUIT.release_error and errors[2] <= CAPACITANCE_ERROR:
            break
    return LumpErrors(
        count, *errors, exact.pull_in_V, exact.release_V, max(_errors(half, exact)[:2])
    )


def _errors(made: BeamStates, exact: BeamStates) -> tuple[float, float, float]:
    """Relative errors of pull-in, release and capacitance."""
    return (
        _relative_error(made.pull_in_V, exact.pull_in_V),
        _relative_error(made.release_V, exact.release_V),
        abs(made.capacitance_fF / exact.capacitance_fF - 1.0),
    )


def _relative_error(made_V: float, exact_V: float) -> float:
    """Of a voltage; 1 where one of both has none."""
    if made_V == exact_V:
        return 0.0
    if not made_V or not exact_V:
        return 1.0
    return abs(made_V / exact_V - 1.0)
