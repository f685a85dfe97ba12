"""A clamped or cantilever beam over a dielectric: bending, tension, stretching and local loads, by
Hermite elements.

The separation s(x) of beam and dielectric is s = rest + u, with z0 its shape at rest and z = z0 +
u. In balance, for every virtual deflection v,

    int EI u'' v'' + N0 u' v' + (N - N0) z' v' dx = int b [p(s) - q(s)] v dx
    N = N0 + EA / (2 L) int (z'^2 - z0'^2) dx

with p the contact pressure (positive: apart) and q the electrostatic pull. N is one number for the
whole beam. Nodal values are exact for uniform loads without tension.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings
from mesoscale.switch.beam_kernels import Mechanics, deflect, elongation, newton_step
from mesoscale.units import GPA, NM, UM

Array = NDArray[np.float64]
ELEMENTS = 128
"""The last places that adhesion holds are some 5 um long. Releases at 24 points of scene `reduced`
are within 0.06 V of those of 512 elements (0.02 V root mean square). The attraction that sticks is
known to 1 to 4 %."""
COARSE_ELEMENTS = 64
"""Where the halves of a pad are compared: 0.08 V root mean square, 0.3 V at most."""
LAST_CONTACT_SHARE = 0.012
"""Of half a lumped beam, whose lumps are finest there: 3 um of the default."""
LANDING_SHARE = 0.56
"""Of half a lumped beam: what lands when the beam pulls in."""
STOPPER_PER_NM = 660.0
"""Stiffness of a stopper, of the pull of the spring: that of the default gives way by 0.1 nm under
1 MPa."""
REST_STEPS = 200
"""Newton steps of a beam that heat or its stress moves to rest."""
RESTS_NM = 1e-6
"""The last of them."""
ROUNDING_NM = 1e-3
"""Steps below this that do not shrink any more are rounding: of 48 lumps they stay at 2e-4 nm."""
Load = Callable[[Array], tuple[Array, Array]]
"""Pressure (Pa, positive: apart) and its derivative (Pa/m) at separations (m), all of shape
(elements, points).
"""


@dataclass(frozen=True)
class Beam:
    """A beam and its shape at rest.

    Attributes
    ----------
    width_m : width of the electrode.
    bending_N_m2 : EI.
    tension_N : axial force at rest.
    stretching_N_m : growth of the axial force with the length of the bent beam; 0 of a cantilever.
    cantilever : whether the last end is free.
    rest_nodal : height of the shape at rest over its ends (m) and slope at the nodes, shape (nodes,
        2).
    rest_m : separation at rest at the integration points, shape (elements, points).
    sizes_m : lengths of the elements, shape (elements,).
    within : places of the integration points in their elements, from 0 to 1, shape (points,).
    weights_m : length that each integration point stands for, shape (elements, points).
    wired, lands : 1 over the electrode, and over the pad; else 0; shape (elements, points).
    dimple_nm, stopper_nm : heights of what lands on the pad, and of what stands elsewhere.
    turning_rad_N_m : how far each anchor turns under a moment.
    """

    width_m: float
    bending_N_m2: float
    tension_N: float
    stretching_N_m: float
    cantilever: bool
    rest_nodal: Array
    rest_m: Array
    sizes_m: Array
    within: Array
    weights_m: Array
    wired: Array
    lands: Array
    dimple_nm: float = 0.0
    stopper_nm: float = 0.0
    turning_rad_N_m: float = 0.0

    @property
    def elements(self) -> int:
        """Number of elements."""
        return len(self.rest_m)

    @property
    def length_m(self) -> float:
        """Length of the beam."""
        return float(self.sizes_m.sum())

    @property
    def contact_m(self) -> float:
        """Length of the part over the pad."""
        return float((self.weights_m * self.lands).sum())

    @property
    def at_m(self) -> Array:
        """Positions of the integration points along the beam, shape (elements, points)."""
        first_m = np.cumsum(self.sizes_m) - self.sizes_m
        return first_m[:, None] + self.sizes_m[:, None] * self.within

    @cached_property
    def mechanics(self) -> Mechanics:
        """The beam for the inner loops."""
        shapes = np.array([_shapes(size, self.within) for size in self.sizes_m])
        bending, pulled = (
            np.array(parts) for parts in zip(*map(_stiffness, self.sizes_m.tolist()), strict=True)
        )
        unknowns = 2 * self.elements - (0 if self.cantilever else 2)
        weights = self.width_m * self.weights_m
        rest = self.rest_nodal.copy()
        for turn in self.turns:
            element = turn.element
            shapes[element] = turn.follows.T @ shapes[element]
            pulled[element] = turn.follows.T @ pulled[element] @ turn.follows
            bending[element] = turn.follows.T @ bending[element] @ turn.follows + turn.spring
            rest[turn.node, 1] -= turn.slope(self.rest_nodal)  # it is at rest already
        return Mechanics(
            shapes,
            self.bending_N_m2 * bending,
            pulled,
            weights,
            shapes[:, :, None] * shapes[:, None] * weights[:, None, None],
            self.tension_N,
            self.stretching_N_m,
            rest,
            unknowns,
        )

    @cached_property
    def turns(self) -> list["Turn"]:
        """The anchors that turn."""
        give_m = self.turning_rad_N_m * self.bending_N_m2
        if give_m == 0.0:
            return []
        first = _turn(float(self.sizes_m[0]), 0, 0, give_m)
        if self.cantilever:
            return [first]
        return [first, _turn(float(self.sizes_m[-1]), self.elements - 1, 1, give_m)]

    @property
    def places(self) -> tuple[Array, Array, float, float, float]:
        """What is over electrode and pad, and the stiffness of stoppers (GPa/nm), for the
        kernels.
        """
        return (
            self.wired,
            self.lands,
            self.dimple_nm,
            self.stopper_nm,
            STOPPER_PER_NM * self.spring_Pa / GPA,
        )

    @property
    def spring_Pa(self) -> float:
        """Uniform pressure that brings the beam down by its separation at rest, in parts that add
        up.

        Bending 384 EI s / b L^4 (cantilever 8 EI s / b L^4), and 8 N s / b L^2 of the axial force
        N, that at rest and that of a parabola of sag s, which is 8 s^2 / 3 L longer. Compression
        counts as no force: a beam about to buckle is not without a scale.
        """
        sag = float(self.rest_m.max())
        length = self.length_m
        stretched_N = self.stretching_N_m * 8.0 * sag**2 / (3.0 * length)
        axial_N = max(self.tension_N, 0.0) + stretched_N
        bent = (8.0 if self.cantilever else 384.0) * self.bending_N_m2 / length**2
        return (bent + 8.0 * axial_N) * sag / (self.width_m * length**2)

    def deflection_m(self, nodal: Array) -> Array:
        """Deflection at the integration points from nodal values (nodes, 2), shape (elements,
        points).
        """
        return deflect(nodal, self.mechanics.shapes)

    def strains(self, nodal: Array) -> tuple[Array, float]:
        """Curvature (1/m) at both ends of the elements, shape (elements, 2), and mean axial strain,
        of nodal values (nodes, 2).
        """
        first, last = nodal[:-1], nodal[1:]
        size = self.sizes_m
        sloping = 6.0 * (last[:, 0] - first[:, 0]) / size**2
        curvature = np.stack(
            [
                sloping - (4.0 * first[:, 1] + 2.0 * last[:, 1]) / size,
                (2.0 * first[:, 1] + 4.0 * last[:, 1]) / size - sloping,
            ],
            1,
        )
        longer_m = elongation(nodal, self.mechanics.pulled, self.mechanics.rest)
        return curvature, longer_m / self.length_m

    def step(
        self, nodal: Array, load: Load, inertia: float = 0.0, other: Array | None = None
    ) -> tuple[Array, Array]:
        """One Newton step towards balance, and the answer to another load on top, both of shape
        (nodes, 2).

        Parameters
        ----------
        inertia : added stiffness per area (Pa/m) that holds the beam back; 0 for a plain step.
        other : pressure (Pa) at the integration points; None: no other load.
        """
        pressure, slope = load(self.rest_m + self.deflection_m(nodal))
        other = np.zeros_like(pressure) if other is None else other
        return newton_step(nodal, pressure, slope, other, inertia, self.mechanics)[:2]


@dataclass(frozen=True)
class Turn:
    """An anchor that turns: the slope of its end follows the node beside it.

    So the kernels know no slope of an end. In balance of moments it follows bending alone; what
    tension and load add within one element vanishes with its size.

    Attributes
    ----------
    element, node : at the anchor.
    slope_by : slope of the end by the nodal values of its element, shape (4,).
    follows : nodal values of the element by those that are free, shape (4, 4).
    spring : energy of the anchor, as bending of the element with EI = 1, shape (4, 4).
    """

    element: int
    node: int
    slope_by: Array
    follows: Array
    spring: Array

    def slope(self, nodal: Array) -> float:
        """Slope of the end by nodal values, shape (nodes, 2)."""
        return float(self.slope_by @ nodal[self.element : self.element + 2].ravel())


def _turn(size_m: float, element: int, end: int, give_m: float) -> Turn:
    """The anchor at an end (0 or 1) of an element.

    Parameters
    ----------
    give_m : its turn under a moment of 1, times EI.
    """
    bending, _ = _stiffness(size_m)
    outer = 1 + 2 * end
    inner = slice(0, 2) if end else slice(2, 4)
    slope_by = np.zeros(4)
    slope_by[inner] = -bending[outer, inner] * give_m / (bending[outer, outer] * give_m + 1.0)
    follows = np.eye(4)
    follows[outer] += slope_by
    return Turn(element, element + end, slope_by, follows, np.outer(slope_by, slope_by) / give_m)


def beam_of(settings: DeviceSettings, elements: int = ELEMENTS) -> Beam:
    """The beam that the settings describe, as it rests at its temperature.

    Raises
    ------
    InputError : it touches the dielectric at rest.
    """
    # nodes at the ends of electrode and pad, so that no element is in part over them
    edges = np.unique([0.0, *settings.electrode, *settings.contact, 1.0])
    counts = np.maximum(np.rint(np.diff(edges) * elements), 1).astype(int)
    sizes_m = np.repeat(settings.length_um * UM * np.diff(edges) / counts, counts)
    # contact ends within elements: with four points releases err three times as much
    places, weights = np.polynomial.legendre.leggauss(6)
    return _beam(settings, sizes_m, 0.5 * (places + 1.0), 0.5 * sizes_m[:, None] * weights)


def lumped_beam(settings: DeviceSettings, lumps: int) -> Beam:
    """The same beam loaded at 2 `lumps` places only: one integration point at the end of each
    element but the last.

    The places are those of Gauss in parts of the beam. Within `LANDING_SHARE` of mid-span, which
    opens last, the density of parts is 1 / (x + LAST_CONTACT_SHARE) + 2 / LANDING_SHARE at a share
    x of half the beam; what remains is one part. Their stiffness is exact without tension.

    Raises
    ------
    InputError : see `beam_of`; the number of lumps is not even, or less than 4; the beam is no
        clamped one, or has parts without electrode or pad.
    """
    if lumps < 4 or lumps % 2:
        raise InputError(
            f"a bending electrode needs an even number of lumps, at least 4, not {lumps}"
        )
    if settings.without_circuit:
        raise InputError(settings.without_circuit)
    half_m = settings.length_um * UM / 2.0
    shares = np.linspace(0.0, LANDING_SHARE, 10001)
    parts_within = np.log1p(shares / LAST_CONTACT_SHARE) + 2.0 * shares / LANDING_SHARE
    landing = np.interp(np.linspace(parts_within[-1], 0.0, lumps // 2), parts_within, shares)
    edges_m = half_m * (1.0 - np.concatenate([[1.0], landing]))
    sizes_m = np.diff(edges_m)[:, None]
    gauss, weights = np.polynomial.legendre.leggauss(2)
    first_m = (edges_m[:-1, None] + 0.5 * sizes_m * (gauss + 1.0)).ravel()
    places_m = np.concatenate([[0.0], first_m, 2.0 * half_m - first_m[::-1], [2.0 * half_m]])
    carried_m = (0.5 * sizes_m * weights).ravel()
    weights_m = np.concatenate([carried_m, carried_m[::-1], [0.0]])[:, None]
    return _beam(settings, np.diff(places_m), np.ones(1), weights_m)


def _beam(settings: DeviceSettings, sizes: Array, within: Array, weights: Array) -> Beam:
    """The beam of the settings on these elements."""
    if touching := settings.touching_at_rest:
        raise InputError(touching)
    width_m = 1e-6 * settings.width_um
    thickness_m = 1e-6 * settings.thickness_um
    length_m = 1e-6 * settings.length_um
    section_m2 = width_m * thickness_m
    tension_N = 0.0
    stretching_N_m = 0.0
    if settings.ends != "cantilever":
        stress_Pa = 1e6 * settings.residual_stress_MPa * (1.0 - settings.poisson_ratio)
        tension_N = stress_Pa * section_m2
        # edges of the beam are free, so that it stretches with E, however wide it is
        beam_m_N = length_m / (1e9 * settings.youngs_modulus_GPa * section_m2)
        stretching_N_m = 1.0 / (beam_m_N + 1e-6 * settings.anchor_um_per_N)
    node_share = np.concatenate([[0.0], np.cumsum(sizes)]) / length_m
    height_nm = settings.shape_at_rest_nm(node_share)
    slope_nm_m = settings.slope_at_rest_nm(node_share) / length_m
    nowhere = np.zeros(weights.shape)
    flat = Beam(
        width_m=width_m,
        bending_N_m2=1e9 * settings.bending_GPa * section_m2 * thickness_m**2 / 12.0,
        tension_N=tension_N,
        stretching_N_m=stretching_N_m,
        cantilever=settings.ends == "cantilever",
        rest_nodal=NM * np.stack([height_nm, slope_nm_m], 1),
        rest_m=nowhere,
        sizes_m=sizes,
        within=within,
        weights_m=weights,
        wired=nowhere,
        lands=nowhere,
        dimple_nm=settings.dimple_nm,
        stopper_nm=settings.stopper_nm,
        turning_rad_N_m=1e6 * settings.anchor_rad_per_uN_m,
    )
    share = flat.at_m / length_m
    stated = replace(
        flat,
        rest_m=settings.gap_um * 1e-6 + NM * settings.shape_at_rest_nm(share),
        wired=_between(share, *settings.electrode),
        lands=_between(share, *settings.contact),
    )
    return _at_rest(stated, settings)


def _between(share: Array, first: float, last: float) -> Array:
    """1 where a share of the length lies in a part of the beam, else 0."""
    return ((first <= share) & (share <= last)).astype(float)


def euler_MPa(settings: DeviceSettings) -> float:
    """Compression under which a flat clamped beam buckles (positive), pi^2 E t^2 / (3 L^2)."""
    slender = settings.thickness_um / settings.length_um
    return float(1e3 * np.pi**2 * settings.bending_GPa * slender**2 / 3.0)


def rests_as_stated(settings: DeviceSettings) -> bool:
    """Whether neither heat nor buckling moves the beam away from its stated shape."""
    axial = settings.residual_stress_MPa * (1.0 - settings.poisson_ratio)
    return settings.ends == "cantilever" or (
        settings.heating_MPa == 0.0 and axial > -euler_MPa(settings)
    )


def _at_rest(stated: Beam, settings: DeviceSettings) -> Beam:
    """The beam where it comes to rest: heat moves it, and a compression beyond Euler's buckles it
    to its side.

    The shape that is stated balances the stated stress; it need not be stable.

    Raises
    ------
    InputError : it does not come to rest, or stands on the dielectric.
    """
    if rests_as_stated(settings):
        return stated
    newton_MPa = settings.width_um * settings.thickness_um * 1e-6
    heat = settings.heating_MPa * newton_MPa
    share = np.concatenate([[0.0], np.cumsum(stated.sizes_m)]) / stated.length_m
    excess_N = -(stated.tension_N + heat) - euler_MPa(settings) * newton_MPa
    start = np.zeros((stated.elements + 1, 2))
    if excess_N > 0.0:  # on the side of the height that a flat beam would have
        length_m = stated.length_m
        strain = excess_N / (stated.stretching_N_m * length_m)
        height = 2.0 / np.pi * length_m * np.sqrt(strain)
        side = 1.0 if settings.buckled == "up" else -1.0
        mode = 0.5 * (1.0 - np.cos(2.0 * np.pi * share))
        slope = np.pi / length_m * np.sin(2 * np.pi * share)
        start = side * height * np.stack([mode, slope], 1) - stated.mechanics.rest
    moved = _come_to_rest(stated, heat, np.zeros_like(start), start)
    if moved is None:
        raise InputError(
            f"device.residual_stress_MPa = {settings.residual_stress_MPa:.4g}: the beam does not"
            f" come to rest at {settings.temperature_C:.4g} C; state its bow_nm at rest, or a"
            " stress that does not buckle it"
        )
    rested = _rested(stated, *moved)
    if _lowest_nm(rested) <= 0.0:
        raise InputError(
            f"device.residual_stress_MPa = {settings.residual_stress_MPa:.4g} at temperature_C ="
            f" {settings.temperature_C:.4g}: the beam stands on the dielectric at rest; lower the"
            " compression, take buckled: up, or raise gap_um"
        )
    return rested


def crept(beam: Beam, held: Array, share: float) -> Beam:
    """The beam at rest after its stress in a held shape has lost a share: that share of bending and
    stretching needs no stress any more.

    Parameters
    ----------
    held : nodal values of the held shape over that at rest (m), shape (nodes, 2).

    Raises
    ------
    InputError : it does not come to rest, or stands on the dielectric.
    """
    mechanics = beam.mechanics
    longer_m = elongation(held, mechanics.pulled, mechanics.rest)
    slack_N = -share * mechanics.stretching_N_m * longer_m
    moved = _come_to_rest(beam, slack_N, share * held, share * held)
    if moved is None:
        raise InputError("lifetime.ageing: the beam that has crept does not come to rest")
    rested = _rested(beam, *moved)
    if _lowest_nm(rested) <= 0.0:
        raise InputError("lifetime.ageing: the beam has crept until it stands on the dielectric")
    return rested


def _come_to_rest(
    stated: Beam, axial_N: float, bent: Array, start: Array
) -> tuple[Array, float] | None:
    """Nodal values over the stated shape (m) in balance without loads, and the axial force that is
    more there; None where no balance is found.

    Parameters
    ----------
    axial_N : axial force that is more in the stated shape.
    bent : nodal values that need no bending, shape (nodes, 2).
    start : nodal values to start from.
    """
    mechanics = stated.mechanics
    stretching = mechanics.stretching_N_m
    unknowns = mechanics.unknowns
    freedoms = slice(2, 2 + unknowns)
    bends = assembled(mechanics.bending_N_m)[freedoms, freedoms]
    all_pulls = assembled(mechanics.pulled)
    pulls = all_pulls[freedoms, freedoms]
    # the ends of a tilted beam are not at the height of its middle
    pulled_at_rest = (all_pulls @ mechanics.rest.ravel())[freedoms]
    without_stress = bent.ravel()[freedoms]
    u = start.ravel()[freedoms]
    moved_nm = np.inf
    for _ in range(REST_STEPS):
        gradient = pulls @ u + pulled_at_rest
        more = axial_N + stretching * (0.5 * u @ pulls @ u + pulled_at_rest @ u)
        left = bends @ (u - without_stress) + stated.tension_N * (pulls @ u) + more * gradient
        stiffness = (
            bends + (stated.tension_N + more) * pulls + stretching * np.outer(gradient, gradient)
        )
        change = -np.linalg.solve(stiffness, left)
        u = u + change
        before_nm = moved_nm
        moved_nm = float(abs(change[::2]).max()) / NM
        # steps shrink until they are rounding, which is large where elements are short
        rounding = moved_nm < ROUNDING_NM and moved_nm > 0.5 * before_nm
        if moved_nm < RESTS_NM or rounding:
            moved = np.zeros((stated.elements + 1, 2))
            moved.ravel()[freedoms] = u
            return moved, float(more)
    return None


def _rested(stated: Beam, moved: Array, more_N: float) -> Beam:
    """The beam at rest where it has moved to, with so much more axial force."""
    deflection_m = stated.deflection_m(moved)
    nodal = moved.copy()
    for turn in stated.turns:
        nodal[turn.node, 1] = turn.slope(nodal)
    return replace(
        stated,
        rest_nodal=stated.rest_nodal + nodal,
        rest_m=stated.rest_m + deflection_m,
        tension_N=stated.tension_N + more_N,
    )


def _lowest_nm(beam: Beam) -> float:
    """Least height of the beam at rest over what it lands on."""
    above_nm = beam.rest_m / NM - np.where(beam.lands > 0, beam.dimple_nm, beam.stopper_nm)
    return float(above_nm.min())


def assembled(parts: Array) -> Array:
    """The matrix of all nodes from those of the elements, shape (2 nodes, 2 nodes)."""
    matrix = np.zeros((2 * len(parts) + 2, 2 * len(parts) + 2))
    for place, part in enumerate(parts):
        matrix[2 * place : 2 * place + 4, 2 * place : 2 * place + 4] += part
    return matrix


def _shapes(size: float, x: Array) -> Array:
    """Hermite's shapes on an element of this size at places from 0 to 1, shape (4, points)."""
    shapes = [
        1 - 3 * x**2 + 2 * x**3,
        size * (x - 2 * x**2 + x**3),
        3 * x**2 - 2 * x**3,
        size * (x**3 - x**2),
    ]
    return np.stack(shapes)


def _stiffness(size: float) -> tuple[Array, Array]:
    """An element against bending (EI = 1) and under a tension of 1, shape (4, 4) each."""
    h = size
    bend = np.array([[12, 6 * h], [6 * h, 4 * h**2]])
    pull = np.array([[36, 3 * h], [3 * h, 4 * h**2]])
    # the other end: forces opposed, slopes alike
    across = np.array([[-12, 6 * h], [-6 * h, 2 * h**2]])
    drawn = np.array([[-36, 3 * h], [-3 * h, -(h**2)]])
    turned = np.array([[1, -1], [-1, 1]])
    bend = np.block([[bend, across], [across.T, turned * bend]])
    pull = np.block([[pull, drawn], [drawn.T, turned * pull]])
    return bend / h**3, pull / (30.0 * h)
