"""A measured map pressed as it is: pressure and gap at each load."""

import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from scipy import ndimage

from asperity.film import Shown
from mesoscale.checks import (
    check_memory,
    check_number,
    check_periodic,
    checked_array,
    checked_heights,
)
from mesoscale.contact.attraction import all_attracting
from mesoscale.contact.compiling import announced
from mesoscale.contact.coupled import one_load, validity
from mesoscale.contact.coupled.base import Alone, Repeated
from mesoscale.contact.coupled.devices import Device, check_device, fetched, placed
from mesoscale.contact.coupled.engine import CoupledContact
from mesoscale.contact.coupled.free import FreeContact
from mesoscale.contact.cycle import (
    LARGEST_FORCE_NN,
    MAX_FORCE_MISS,
    SMALLEST_FORCE_NN,
    check_hardness,
)
from mesoscale.contact.numerics import NUMERICS
from mesoscale.contact.path import trace
from mesoscale.contact.surface import ContactAt
from mesoscale.errors import InputError
from mesoscale.extras import needs
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.topography.description.choice import STEEP_SHARE

PressureOfGaps = Callable[[np.ndarray], Any]

MAP_MB = 16e-6
"""Of a site at a load: its pressure and its gap."""
LEAST_PIXEL_NM = 0.02
"""Of a map whose length is in nm: atoms are 0.2 nm apart."""
FEW_LOADS = 4
"""Loads or approaches that are found one by one on any map; the way past them costs more."""
MORE_LOADS = 150.0
"""Times the share of contact: so many more are found one by one. Ways past ten loads took as long
as 2 to 7 loads one by one at 0.2 % of contact, 10 to 44 at 5 % and 11 to 73 at 20 % (64^2 to
512^2, smooth and rough, elastic and plastic).
"""
STRONGEST_GPA = 1e3
"""Of an attraction: 0.25 aJ across 0.1 nm make 13 GPa, the cohesion of diamond is some 100 GPa."""
ATTRACTION = (
    "accepted is a function of an array of gaps (nm) that gives finite pressures of "
    f"0 .. {STRONGEST_GPA:g} GPa in its shape"
)


@dataclass(frozen=True, repr=False)
class PressedMap(Shown):
    """A map under a flat at some loads, in their order.

    Attributes
    ----------
    loads_nN : repulsive force, shape (k,).
    separation_nm : of the flat from the mean plane; on a free map from the undeformed one.
    approach_nm : how far the flat came down since it first touched.
    attraction_nN : by the law that was given, negative, shape (k,).
    pressure_GPa, gap_nm : maps (k, nx, ny); the surfaces touch where the pressure is positive.
    lengths_nm : sides of the map along x and y.
    converged : whether every step settled and every load was reached.
    """

    loads_nN: np.ndarray
    separation_nm: np.ndarray
    approach_nm: np.ndarray
    attraction_nN: np.ndarray
    pressure_GPa: np.ndarray
    gap_nm: np.ndarray
    lengths_nm: tuple[float, float]
    converged: bool

    @property
    def area_share(self) -> np.ndarray:
        """Share of the sites in contact, shape (k,)."""
        return (self.pressure_GPa > 0.0).mean(axis=(1, 2))

    def lines(self) -> Iterator[str]:
        """One line a load."""
        nx, ny = self.pressure_GPa.shape[1:]
        doubt = "" if self.converged else "; NOT CONVERGED"
        yield f"Map of {nx} x {ny} sites; loads: {len(self.loads_nN)}{doubt}"
        for k, (load, share) in enumerate(zip(self.loads_nN, self.area_share, strict=True)):
            yield (
                f"{load:.4g} nN: {share:.2%} in contact, up to {self.pressure_GPa[k].max():.3g}"
                f" GPa, {self.separation_nm[k]:.4g} nm from the mean plane"
            )

    def to_frame(self) -> Any:
        """A pandas DataFrame with a row a load."""
        with needs("plot"):
            import pandas as pd
        names = ("loads_nN", "separation_nm", "approach_nm", "attraction_nN", "area_share")
        return pd.DataFrame({name: getattr(self, name) for name in names})

    def to_xarray(self) -> Any:
        """An xarray Dataset of the maps, with coordinates load (nN), x and y (nm)."""
        with needs("plot"):
            import xarray as xr
        sites = self.pressure_GPa.shape[1:]
        x, y = (
            (np.arange(count) + 0.5) * length / count
            for count, length in zip(sites, self.lengths_nm, strict=True)
        )
        coordinates = {
            "load": ("load", self.loads_nN, {"units": "nN"}),
            "x": ("x", x, {"units": "nm"}),
            "y": ("y", y, {"units": "nm"}),
        }
        maps = {
            "pressure": (("load", "x", "y"), self.pressure_GPa, {"units": "GPa"}),
            "gap": (("load", "x", "y"), self.gap_nm, {"units": "nm"}),
        }
        return xr.Dataset(maps, coordinates)

    def spot_areas_nm2(self, load: int = -1) -> np.ndarray:
        """Areas of the contact spots at one of the loads, the largest first.

        Sites that touch at an edge or a corner are one spot; spots do not go on across the edges of
        the map.
        """
        spots = np.zeros(self.pressure_GPa.shape[1:], int)  # number of the spot at each site
        ndimage.label(self.pressure_GPa[load] > 0.0, np.ones((3, 3)), spots)
        sizes = np.bincount(spots.ravel())[1:]
        site_nm2 = np.prod(self.lengths_nm) / spots.size
        return np.sort(sizes)[::-1] * site_nm2

    def plot_pressures(self, bins: int = 40) -> Any:
        """How much area carries which pressure, a line a load, as a Matplotlib figure."""
        with needs("plot"):
            import matplotlib.pyplot as plt
        figure, axes = plt.subplots(figsize=(5.0, 3.6), layout="constrained")
        edges = np.linspace(0.0, float(self.pressure_GPa.max()), bins + 1)
        site_nm2 = float(np.prod(self.lengths_nm)) / self.pressure_GPa[0].size
        for load_nN, pressure in zip(self.loads_nN, self.pressure_GPa, strict=True):
            sites, _ = np.histogram(pressure[pressure > 0.0], edges)
            axes.stairs(sites * site_nm2, edges, label=f"{load_nN:.4g} nN")
        axes.set(xlabel="pressure (GPa)", ylabel="area in contact (nm²)")
        axes.legend()
        return figure

    def plot(self, load: int = -1) -> Any:
        """Pressure and gap at one of the loads, by its place in `loads_nN`, as a Matplotlib
        figure.
        """
        with needs("plot"):
            import matplotlib.pyplot as plt
        figure, (left, right) = plt.subplots(
            1, 2, figsize=(9, 3.8), layout="constrained", sharex=True, sharey=True
        )
        x_um, y_um = (length / 1000 for length in self.lengths_nm)
        pressure = self.pressure_GPa[load]
        shown = (
            (left, np.where(pressure > 0.0, pressure, np.nan), "plasma", "pressure (GPa)"),
            (right, self.gap_nm[load], "Greys", "gap (nm)"),
        )
        for axes, field, colours, label in shown:
            image = axes.imshow(field.T, extent=(0, x_um, 0, y_um), origin="lower", cmap=colours)
            figure.colorbar(image, ax=axes, label=label)
            axes.set(xlabel="x (µm)")
        left.set(
            ylabel="y (µm)",
            title=f"{self.loads_nN[load]:.4g} nN, {self.area_share[load]:.2%} in contact",
        )
        return figure


def press(
    heights: Any,
    side_nm: float | tuple[float, float],
    loads_nN: float | Sequence[float] | None,
    e_star: float,
    *,
    approach_nm: float | Sequence[float] | None = None,
    h_macro: float | None = None,
    h_prime: float = 0.0,
    counterface: Any = None,
    periodic: bool = True,
    contact_at: ContactAt = "highest",
    attraction: PressureOfGaps | None = None,
    device: Device = "cpu",
) -> PressedMap:
    """Press a map onto a flat, or onto a second map, and return pressure and gap at each load or
    approach.

    All sites share one elastic half-space (`mechanics: coupled`, docs/contact.md).

    Parameters
    ----------
    heights : (nx, ny) in nm, levelled, without missing values; for instance
        `Film(file).maps[0].heights_nm`.
    side_nm : length of the map, or its lengths along x and y.
    loads_nN : repulsive forces on the whole map (nN), rising; None: `approach_nm` is given.
    e_star : effective modulus of both bodies, GPa.
    approach_nm : how far the flat comes down after it first touches (nm), rising, in place of
        loads.
    h_macro : hardness (GPa), at which the surface yields; None: elastic.
    h_prime : its size effect, GPa nm^0.5.
    counterface : (nx, ny) heights of the second surface as an instrument sees it. It is turned over
        about the y axis: its row -1 meets row 0. Only the sum of both maps matters to the contact.
    periodic : the map repeats without end (square maps only). False: it stands alone on the
        half-space.
    contact_at : which heights touch first: the highest of measured maps, the lowest of
        `random_surface`.
    attraction : pressure (GPa, positive) by which sites attract across their gaps (nm), such as
        ``lambda gap: 0.2 / (6 * np.pi * (gap + 0.3) ** 3)``. It does not deform the surfaces.
    device : where the loads or approaches are found, one by one: ``"cpu"``, or ``"cuda"``, a GPU,
        by CuPy or PyTorch. Maps go there and come back as NumPy's. A load that does not settle
        there is closed to on the processor.

    Raises
    ------
    InputError : no such map, side, load or material; maps beyond memory; a load beyond full
        contact; a tilted map that is periodic; an attraction that is no such function; no such
        device, or a size effect on a GPU.
    MissingExtra : no library for the device (extra `gpu`).
    """
    check_device(device)
    if not isinstance(periodic, (bool, np.bool_)):
        raise InputError(f"periodic = {periodic!r}: accepted are True and False")
    if attraction is not None and not callable(attraction):
        raise InputError(f"attraction = {attraction!r:.60}: {ATTRACTION}")
    model, inputs = material_of_map(e_star, h_macro, h_prime)
    by_load = loads_nN is not None
    steps = _steps(loads_nN, approach_nm)
    if device != "cpu" and not inputs.hardness.constant:
        raise InputError(
            f"h_prime = {h_prime:g} on device = {device!r}: with a size effect the way decides the"
            " contact, which is followed on the processor alone; take device='cpu', or leave out"
            " h_prime"
        )
    few = (steps.size <= FEW_LOADS or device != "cpu") and inputs.hardness.constant
    surface, spacing = surface_of_maps(
        heights, counterface, side_nm, bool(periodic), contact_at, steps.size, few
    )
    settings = ContactSettings(model=model).model_copy(
        update={"pixels": len(surface), "length_nm": spacing * len(surface)}
    )
    check_hardness(inputs, settings)
    offset = float(surface.mean())
    lowest = float(surface.min())
    if few or _one_by_one(surface, steps, by_load, inputs, spacing):
        states = _each(surface, periodic, steps, by_load, inputs, settings, device)
    else:
        states = _way(surface, periodic, steps, by_load, inputs, settings)
    forces, separations, pulls = (np.zeros(steps.size) for _ in range(3))
    pressures = gaps = np.empty(0)
    if steps.size > 1:
        pressures, gaps = (np.empty((steps.size, *surface.shape)) for _ in range(2))
    converged = True
    with announced():
        for number, state in enumerate(states):
            forces[number] = state.force
            separations[number] = state.separation
            if steps.size == 1:  # a large map is not copied
                pressures = state.pressure[None]
                gaps = state.gap[None]
            else:
                pressures[number] = state.pressure
                gaps[number] = state.gap
            converged &= state.settled
            if attraction is not None:
                pulls[number] = _pull(attraction, gaps[number], pressures[number], spacing**2)
    sides = (spacing * surface.shape[0], spacing * surface.shape[1])
    from_mean = separations + offset
    approach = -lowest - separations
    return PressedMap(
        forces,
        from_mean,
        approach,
        pulls,
        pressures,
        gaps,
        lengths_nm=sides,
        converged=bool(converged),
    )


def material_of_map(
    e_star: float, h_macro: float | None, h_prime: float, hamaker: float = 0.0
) -> tuple[Literal["elastic", "plastic"], ContactInputs]:
    """The model of a material, elastic without a hardness, and its inputs; a map has its own
    spectrum.

    Raises
    ------
    InputError : a size effect without a hardness, or a number out of its range.
    """
    if h_macro is None and h_prime != 0.0:
        raise InputError(
            f"h_prime = {h_prime!s:.60} without h_macro: the size effect of a hardness; give"
            " h_macro, too"
        )
    model = "plastic"
    if h_macro is None:
        model = "elastic"
        h_macro = 0.0
    return model, ContactInputs(
        hamaker=hamaker,
        e_star=e_star,
        h_macro=h_macro,
        h_prime=h_prime,
        q0=1.0,
        hurst=0.5,
        rms=0.0,
    )


def map_on_sides(
    heights: Any, side_nm: float | tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """A map (nx, ny) and its lengths along x and y; one length is that along x.

    Raises
    ------
    InputError : no such map or side.
    """
    sides = checked_array("side_nm", side_nm, "nm")
    if sides.shape not in ((1,), (2,)):
        raise InputError(
            f"side_nm = {side_nm!r:.60}: accepted is one length in nm, or the lengths along x and y"
        )
    surface = checked_heights(heights, float(sides.max()), square=False)
    if sides.size == 1:
        sides = np.array([sides[0], sides[0] * surface.shape[1] / surface.shape[0]])
    return surface, sides


def remark_on_sides(surface: np.ndarray, sides: np.ndarray, calls: int) -> None:
    """Warn where a length is most likely in another unit than nm.

    Parameters
    ----------
    calls : between this one and the user's line, which the warning names.
    """
    rms_nm = float(surface.std())
    side_nm = float(sides[0])
    pixel_nm = side_nm / len(surface)
    if 0.0 < pixel_nm < LEAST_PIXEL_NM or rms_nm > STEEP_SHARE * side_nm > 0.0:
        warnings.warn(
            f"side_nm = {side_nm:g}: pixels of {pixel_nm:.2g} nm under an RMS height of"
            f" {rms_nm:.3g} nm; lengths are in nm, is this one in um?",
            stacklevel=2 + calls,
        )


def _one_by_one(
    surface: np.ndarray, steps: np.ndarray, by_load: bool, inputs: ContactInputs, spacing: float
) -> bool:
    """Whether many loads or approaches are found one by one, as few are: the larger the contact,
    the more of them cost less than the way past them.

    With a size effect several contacts can carry a load, and the way decides which one is meant.
    """
    if not inputs.hardness.constant:
        return False
    if by_load:
        slope = math.sqrt(sum(float((np.diff(surface, axis=k) ** 2).mean()) for k in (0, 1)))
        pressure = steps[-1] / (surface.size * spacing**2)
        stiff = float(inputs.e_star) * slope / spacing
        share = validity.KAPPA * pressure / stiff if stiff else 1.0
    else:
        lowest = float(surface.min())
        share = float((surface < lowest + steps[-1]).mean()) / 2.0  # half of it bends away
    return steps.size <= FEW_LOADS + MORE_LOADS * min(share, 1.0)


class _State(NamedTuple):
    """The map at a load or approach; separation from the plane that heights are measured from."""

    force: float
    separation: float
    pressure: np.ndarray
    gap: np.ndarray
    settled: bool


def _each(
    surface: np.ndarray,
    periodic: bool,
    steps: np.ndarray,
    by_load: bool,
    inputs: ContactInputs,
    settings: ContactSettings,
    device: Device,
) -> Iterator[_State]:
    """The map at each load or approach, by itself, found on a device."""
    spacing = settings.length_nm / settings.pixels
    map_kind = Repeated if periodic else Alone
    base = map_kind(surface.shape, spacing, float(inputs.e_star))
    yields = settings.model == "plastic"
    hardness = float(inputs.h_macro) if yields else math.inf
    bearing = CoupledContact.BEARING_SHARE * hardness * surface.size * spacing**2
    if by_load and steps[-1] > bearing:
        raise _beyond("the hardness", bearing)
    lowest = float(surface.min())
    flat = float(surface.mean())
    transformed = surface.size if periodic else (2 * max(surface.shape)) ** 2
    heights = placed(surface, device, transformed)
    for number, step in enumerate(steps.tolist()):
        if by_load and yields:
            pressed = one_load.press_yielding(heights, step, hardness, base)
        elif by_load:
            pressed = one_load.press(heights, step, base)
        elif periodic and not yields and step >= flat - lowest:  # no pressure parts the mean planes
            raise _full_contact(surface, inputs, settings)
        else:
            pressed = one_load.press_to(heights, -lowest - step, base, hardness)
        pressed = pressed._replace(pressure=fetched(pressed.pressure), gap=fetched(pressed.gap))
        closed = periodic and bool(pressed.pressure.all())
        if closed and not yields:
            raise _full_contact(surface, inputs, settings)
        if closed or not pressed.settled:
            yield from _way(surface, periodic, steps[number:], by_load, inputs, settings)
            return
        force = float(pressed.pressure.sum()) * spacing**2
        if force > bearing:
            raise _beyond("the hardness", bearing)
        yield _State(force, pressed.separation, pressed.pressure, pressed.gap, True)


def _way(
    surface: np.ndarray,
    periodic: bool,
    steps: np.ndarray,
    by_load: bool,
    inputs: ContactInputs,
    settings: ContactSettings,
) -> Iterator[_State]:
    """The map at each load or approach, from one to the next in steps of separation."""
    lowest = float(surface.min())
    engine = CoupledContact if periodic else FreeContact
    contact = engine(surface.copy(), inputs, settings)  # which lowers what has flowed
    flows = contact.flows
    force_steps = NUMERICS.force_steps if flows else 1
    if by_load:
        _refuse_beyond(contact, steps[-1])
    row = None
    for step in steps.tolist():
        if by_load:
            path = trace(contact, force_steps, flows, stop_force=step, start=row)
        else:
            path = trace(contact, force_steps, flows, stop_separation=-lowest - step, start=row)
        row = path.rows[-1]
        if not np.isfinite(contact.separation):  # it stays where the highest site just touches
            key = "loads_nN" if by_load else "approach_nm"
            raise InputError(
                f"{key} = {step:g}: too little to press one site of this map; give more, or check"
                " its units"
            )
        settled = path.reached and path.unconverged == 0
        if by_load:
            settled &= abs(row.force / step - 1.0) <= MAX_FORCE_MISS
        else:
            _refuse_beyond(contact, row.force)
        yield _State(row.force, row.separation, *contact.fields(), settled)


def _steps(loads_nN: Any, approach_nm: Any) -> np.ndarray:
    """Loads or approaches, whichever are given, shape (k,)."""
    if (loads_nN is None) == (approach_nm is None):
        raise InputError("press: give either loads_nN or approach_nm, and None for the other")
    if loads_nN is not None:
        return _rising("loads_nN", loads_nN, "nN", SMALLEST_FORCE_NN, LARGEST_FORCE_NN)
    return _rising("approach_nm", approach_nm, "nm", 1e-9, 1e9)


def _rising(name: str, values: Any, unit: str, least: float, most: float) -> np.ndarray:
    steps = checked_array(name, values, unit)
    if steps.ndim != 1 or steps.size == 0 or (np.diff(steps) <= 0.0).any():
        raise InputError(f"{name}: accepted are rising numbers in {unit}, one after the other")
    for step in steps.tolist():
        check_number(name, step, least, most, unit)
    return steps


def surface_of_maps(
    heights: Any,
    counterface: Any,
    side_nm: float | tuple[float, float],
    periodic: bool,
    contact_at: ContactAt,
    loads: int,
    few: bool,
) -> tuple[np.ndarray, float]:
    """Heights of both surfaces together, contact at the lowest, and the spacing of the sites
    (nm).
    """
    surface, sides = map_on_sides(heights, side_nm)
    remark_on_sides(surface, sides, calls=2)
    shape = surface.shape
    spacing = float(sides[0]) / shape[0]
    if not abs(sides[1] / shape[1] / spacing - 1.0) <= 1e-3:
        raise InputError(
            f"side_nm = {side_nm}: sites of {shape} must be squares; interpolate the map on such"
        )
    if periodic and shape[0] != shape[1]:
        raise InputError(
            f"heights: {shape[0]} x {shape[1]} sites; periodic maps are square: cut it, or"
            " periodic=False"
        )
    if contact_at not in get_args(ContactAt):
        raise InputError(
            f"contact_at = {contact_at}: accepted are highest (measured maps) and lowest"
        )
    _check_memory(shape, periodic, loads, few)
    if counterface is not None:
        second = checked_heights(counterface, float(sides.max()), square=False, name="counterface")
        if second.shape != shape:
            raise InputError(
                f"counterface: {second.shape} sites on {shape}; accepted are maps of one shape"
            )
        surface = surface + second[::-1]
    if periodic:
        check_periodic(surface)
    if contact_at == "highest":
        return -surface, spacing
    return surface, spacing


def _check_memory(shape: tuple[int, int], periodic: bool, loads: int, few: bool) -> None:
    """Refuse a map that needs more memory than there is."""
    map_MB = MAP_MB * shape[0] * shape[1]
    square = max(shape) ** 2
    if few and periodic:
        check_memory(square, "one load", (loads - 1) * map_MB)
    elif few:
        check_memory(square, "one load on a map alone", (loads - 1) * map_MB)
    elif periodic:
        check_memory(square, "coupled", loads * map_MB)
    else:
        # a map alone is solved on twice its sides
        check_memory(4 * square, "coupled", loads * map_MB)


def _refuse_beyond(contact: CoupledContact, force: float) -> None:
    """Refuse what the map does not carry."""
    if force > contact.capacity:
        bound = "the hardness" if contact.flows else "full contact"
        raise _beyond(bound, contact.capacity)


def _full_contact(
    surface: np.ndarray, inputs: ContactInputs, settings: ContactSettings
) -> InputError:
    flattening = validity.roughness(surface, settings.length_nm).flattening
    return _beyond("full contact", inputs.e_star * flattening * settings.length_nm**2)


def _beyond(what: str, capacity_nN: float) -> InputError:
    return InputError(f"press: too far, {what} ends contacts of this map at {capacity_nN:.4g} nN")


def _pull(
    attraction: PressureOfGaps, gap: np.ndarray, pressure: np.ndarray, site_area: float
) -> float:
    """Force (nN, negative) of a law on all sites that do not touch, with their gaps."""
    weight = _attracting(pressure)
    try:
        stress = attraction(gap.copy())
    except Exception as error:  # of a function that is not ours
        raise InputError(
            f"attraction(gap): {type(error).__name__}: {error}; {ATTRACTION}"
        ) from error
    stress = checked_array("attraction(gap)", stress, "GPa", missing=True)
    if stress.shape != gap.shape:
        raise InputError(
            f"attraction(gap): shape {stress.shape} for gaps of {gap.shape}; {ATTRACTION}"
        )
    pulled = weight > 0.0
    least, most = (
        float(end) for end in (stress[pulled].min(initial=0.0), stress[pulled].max(initial=0.0))
    )
    if not (least >= 0.0 and most <= STRONGEST_GPA):
        raise InputError(
            f"attraction(gap): {least:.4g} .. {most:.4g} GPa where sites do not touch; {ATTRACTION}"
        )
    return -float(weight[pulled] @ stress[pulled]) * site_area


def _attracting(pressure: np.ndarray) -> np.ndarray:
    """Sites' areas that attract with each gap of a map (nx, ny); pressed ones do not."""
    side = max(pressure.shape) + (len(pressure) != pressure.shape[1])
    square = np.zeros((side, side))
    square[: pressure.shape[0], : pressure.shape[1]] = pressure
    sites = np.flatnonzero(square).astype(np.int32)
    place = np.full(square.size, -1, np.int32)
    place[sites] = np.arange(sites.size, dtype=np.int32)
    weight = all_attracting(square.size, sites, place, square.reshape(-1)[sites], False)
    return weight.reshape(square.shape)[: pressure.shape[0], : pressure.shape[1]]
