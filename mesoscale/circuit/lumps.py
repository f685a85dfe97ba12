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

from dataclasses import dataclass, field, replace
from functools import cached_property

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
    springs : forces (N) and moments (N m) at the lumps by their heights (m) and slopes, but for
        what these stretch. Those of heights stand first, then those of slopes; shape (n + m, n + m).
        A beam has m = n, a plate no slopes.
    pulled : twice the elongation of the beam (m) by the squares of heights and slopes, as `springs`.
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
    springs: Array
    pulled: Array
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

    @cached_property
    def stiffness_N_m(self) -> Array:
        """K, forces that hold the lumps at small displacements, but for what they stretch, shape
        (n, n).
        """
        return self._folded(self.springs)

    @cached_property
    def drawn_m(self) -> Array:
        """D, twice the elongation of the beam (m) by the squares of heights (m), in 1/m, shape
        (n, n).
        """
        return self._folded(self.pulled)

    @cached_property
    def slowest_Pa_m(self) -> float:
        """Pressure over way of the softest motion from rest."""
        pulled = self.drawn_m @ self.height_nm * NM
        at_rest = self.stiffness_N_m + self.stretching_N_m * np.outer(pulled, pulled)
        per_area = at_rest / np.sqrt(np.outer(self.area_m2, self.area_m2))
        return float(np.linalg.eigvalsh(per_area)[0])

    def _folded(self, quadratic: Array) -> Array:
        """Of heights alone. Slopes follow them as they do at rest, without what stretches."""
        n = self.count
        follow = -np.linalg.solve(self.springs[n:, n:], self.springs[n:, :n])
        joined = np.vstack([np.eye(n), follow])
        folded = joined.T @ quadratic @ joined
        return 0.5 * (folded + folded.T)


def lumps_of(settings: DeviceSettings, count: int) -> Lumps:
    """So many lumps of the electrode, without its tilt, with the loss of the assumed quality.

    Raises
    ------
    InputError : see `lumped_beam`.
    """
    beam = lumped_beam(settings.level, count)
    area = 2.0 * beam.width_m * beam.weights_m[:count, 0]
    heights_m = beam.rest_nodal[1 : count + 1, 0]
    springs, pulled = _mirrored(beam)
    lossless = Lumps(
        rest_nm=beam.rest_m[:count, 0] / NM,
        area_m2=area,
        springs=springs,
        pulled=pulled,
        height_nm=heights_m / NM,
        stretching_N_m=beam.stretching_N_m,
        width_m=settings.width_um * 1e-6,
        dielectric_nm=settings.dielectric_gap_nm,
        mass_kg_m2=1e3 * settings.density_g_cm3 * 1e-6 * settings.thickness_um,
        gas_Pa=1e3 * settings.gas_kPa,
        loss_us=0.0,
        fringe=settings.fringe,
        shift_V=shift_V(settings),
        uneven_V2=_uneven(settings, float(beam.rest_m.max()) / NM),
    )
    slowest_rad_s = np.sqrt(lossless.slowest_Pa_m / lossless.mass_kg_m2)
    return replace(lossless, loss_us=1e6 / (CIRCUIT.quality * slowest_rad_s))


def _uneven(settings: DeviceSettings, farthest_nm: float) -> Array:
    """Nodes of U^2 between touch and rest."""
    if settings.uneven is None:
        return np.empty((2, 0))
    separation_nm = np.concatenate([[0.0], np.geomspace(UNEVEN_FROM_NM, farthest_nm, UNEVEN_NODES)])
    return np.stack([separation_nm, uneven_V2(settings, separation_nm)])


def _mirrored(beam: Beam) -> tuple[Array, Array]:
    """`springs` and `pulled` of a lumped beam whose mirrored places move alike, shape (2 n, 2 n)
    each.

    An element joins neighbours alone, so that few entries are not zero.
    """
    pulled = assembled(beam.mechanics.pulled)[2:-2, 2:-2]
    bending = assembled(beam.mechanics.bending_N_m)[2:-2, 2:-2]
    places = len(pulled) // 2
    half = places // 2
    mirrored = np.zeros((2 * places, 2 * half))
    for k in range(half):
        across = places - 1 - k
        mirrored[2 * k, k] = 1.0
        mirrored[2 * across, k] = 1.0
        mirrored[2 * k + 1, half + k] = 1.0
        mirrored[2 * across + 1, half + k] = -1.0
    springs = bending + beam.tension_N * pulled
    return mirrored.T @ springs @ mirrored, mirrored.T @ pulled @ mirrored


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
