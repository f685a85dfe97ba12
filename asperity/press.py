"""A measured map pressed as it is: pressure and gap at each load."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np

from asperity.film import Shown
from mesoscale.checks import check_memory, check_number, checked_array, checked_heights
from mesoscale.contact.attraction import attracting
from mesoscale.contact.coupled.engine import CoupledContact
from mesoscale.contact.coupled.free import FreeContact
from mesoscale.contact.cycle import LARGEST_FORCE_NN, MAX_FORCE_MISS, SMALLEST_FORCE_NN
from mesoscale.contact.numerics import NUMERICS
from mesoscale.contact.path import trace
from mesoscale.contact.surface import ContactAt
from mesoscale.errors import InputError
from mesoscale.extras import needs
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings

PressureOfGaps = Callable[[np.ndarray], Any]


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
        yield f"Map of {nx} x {ny} sites; loads: {len(self.loads_nN)}{'' if self.converged else '; NOT CONVERGED'}"
        for k, (load, share) in enumerate(zip(self.loads_nN, self.area_share, strict=True)):
            yield (
                f"{load:.4g} nN: {share:.2%} in contact, up to {self.pressure_GPa[k].max():.3g} GPa, "
                f"{self.separation_nm[k]:.4g} nm from the mean plane"
            )

    def plot(self, load: int = -1) -> Any:
        """Pressure and gap at one of the loads, by its place in `loads_nN`, as a Matplotlib figure."""
        with needs("run"):
            import matplotlib.pyplot as plt
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained", sharex=True, sharey=True)
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
        left.set(ylabel="y (µm)", title=f"{self.loads_nN[load]:.4g} nN, {self.area_share[load]:.2%} in contact")
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
) -> PressedMap:
    """Press a map onto a flat, or onto a second map, and return pressure and gap at each load or approach.

    All sites share one elastic half-space (`mechanics: coupled`, docs/contact.md).

    Parameters
    ----------
    heights : (nx, ny) in nm, levelled, without missing values; for instance `Film(file).maps[0].heights_nm`.
    side_nm : length of the map, or its lengths along x and y.
    loads_nN : repulsive forces on the whole map (nN), rising; None: `approach_nm` is given.
    e_star : effective modulus of both bodies, GPa.
    approach_nm : how far the flat comes down after it first touches (nm), rising, in place of loads.
    h_macro : hardness (GPa), at which the surface yields; None: elastic.
    h_prime : its size effect, GPa nm^0.5.
    counterface : (nx, ny) heights of the second surface as an instrument sees it. It is turned over about the y axis:
        its row -1 meets row 0. Only the sum of both maps matters to the contact.
    periodic : the map repeats without end (square maps only). False: it stands alone on the half-space.
    contact_at : which heights touch first: the highest of measured maps, the lowest of `random_surface`.
    attraction : pressure (GPa, positive) by which sites attract across their gaps (nm), such as
        ``lambda gap: 0.2 / (6 * np.pi * (gap + 0.3) ** 3)``. It does not deform the surfaces.

    Raises
    ------
    InputError : no such map, side, load or material; a map beyond memory; a load beyond full contact.
    """
    surface, spacing = _surface(heights, counterface, side_nm, periodic, contact_at)
    if (loads_nN is None) == (approach_nm is None):
        raise InputError("press: give either loads_nN or approach_nm, and None for the other")
    by_load = loads_nN is not None
    name, unit, least, most = "approach_nm", "nm", 1e-9, 1e9
    if by_load:
        name, unit, least, most = "loads_nN", "nN", SMALLEST_FORCE_NN, LARGEST_FORCE_NN
    steps = checked_array(name, np.atleast_1d(np.asarray(loads_nN if by_load else approach_nm)), unit)
    for step in steps:
        check_number(name, float(step), least, most, unit)
    if steps.ndim != 1 or steps.size == 0 or (np.diff(steps) <= 0.0).any():
        raise InputError(f"{name}: accepted are rising numbers in {unit}")
    hardness = {"h_macro": 0.0 if h_macro is None else h_macro, "h_prime": h_prime}
    inputs = ContactInputs(hamaker=0.0, e_star=e_star, **hardness, q0=1.0, hurst=0.5, rms=0.0)
    settings = ContactSettings(model="elastic" if h_macro is None else "plastic").model_copy(
        update={"pixels": len(surface), "length_nm": spacing * len(surface)}
    )
    offset, lowest = float(surface.mean()), float(surface.min())
    contact = CoupledContact(surface, inputs, settings) if periodic else FreeContact(surface, inputs, settings)
    if by_load:
        _refuse_beyond(contact, steps[-1])
    row, converged, at_loads = None, True, []
    for step in steps:
        ends = {"stop_force": step} if by_load else {"stop_separation": -lowest - step}
        path = trace(contact, NUMERICS.force_steps if h_macro else 1, h_macro is not None, **ends, start=row)
        row = path.rows[-1]
        if by_load:
            converged &= abs(row.force / step - 1.0) <= MAX_FORCE_MISS
        else:
            _refuse_beyond(contact, row.force)
        converged &= path.reached and path.unconverged == 0
        pressure, gap = contact.fields()
        pull = 0.0 if attraction is None else _pull(attraction, gap, contact)
        at_loads.append((row.force, row.separation + offset, -lowest - row.separation, pull, pressure, gap))
    sides = (spacing * surface.shape[0], spacing * surface.shape[1])
    columns = (np.array(column) for column in zip(*at_loads, strict=True))
    return PressedMap(*columns, lengths_nm=sides, converged=bool(converged))


def _surface(
    heights: Any, counterface: Any, side_nm: float | tuple[float, float], periodic: bool, contact_at: ContactAt
) -> tuple[np.ndarray, float]:
    """Heights of both surfaces together, contact at the lowest, and the spacing of the sites (nm)."""
    length = side_nm if isinstance(side_nm, (int, float)) else max(side_nm)
    maps = [checked_heights(values, length, square=False) for values in (heights, counterface) if values is not None]
    shape = maps[0].shape
    if maps[-1].shape != shape:
        raise InputError(f"counterface: {maps[-1].shape} sites on {shape}; accepted are maps of one shape")
    lengths = (side_nm, side_nm * shape[1] / shape[0]) if isinstance(side_nm, (int, float)) else tuple(side_nm)
    spacing = lengths[0] / shape[0]
    if len(lengths) != 2 or abs(lengths[1] / shape[1] / spacing - 1.0) > 1e-3:
        raise InputError(f"side_nm = {side_nm}: sites of {shape} must be squares; interpolate the map on such")
    if periodic and shape[0] != shape[1]:
        raise InputError(f"heights: {shape[0]} x {shape[1]} sites; periodic maps are square: cut it, or periodic=False")
    if contact_at not in get_args(ContactAt):
        raise InputError(f"contact_at = {contact_at}: accepted are highest (measured maps) and lowest")
    check_memory(shape[0] ** 2 if periodic else 4 * max(shape) ** 2, "coupled")
    together = maps[0] + maps[1][::-1] if counterface is not None else maps[0]
    return (-together if contact_at == "highest" else together.copy()), spacing


def _refuse_beyond(contact: CoupledContact, force: float) -> None:
    """Refuse what the map does not carry."""
    if force > contact.capacity:
        what = "the hardness" if contact.flows else "full contact"
        raise InputError(f"press: too far, {what} ends contacts of this map at {contact.capacity:.4g} nN")


def _pull(attraction: PressureOfGaps, gap: np.ndarray, contact: CoupledContact) -> float:
    """Force (nN, negative) of a law on all sites that do not touch, with their gaps."""
    sites = np.arange(contact.heights.size, dtype=np.int32)
    weight = attracting(sites, contact.place, contact.pressure, contact.n, False)
    weight = weight.reshape(contact.n, contact.n)[: gap.shape[0], : gap.shape[1]]
    stress = checked_array("attraction(gap)", attraction(gap), "GPa", missing=True)
    if stress.shape != gap.shape or not np.isfinite(stress[weight > 0.0]).all():
        raise InputError("attraction: accepted is a function of an array of gaps (nm) with finite pressures (GPa)")
    return -float(weight[weight > 0.0] @ stress[weight > 0.0]) * contact.site_area
