"""A measured film, the contact on it and a switch on its pad: what a scene computes, by the same
calls.
"""

import hashlib
import html
from abc import ABC, abstractmethod
from base64 import b64encode
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from mesoscale.answer.points import central_point, on_pad_grid, plan_points
from mesoscale.answer.release import switch_on_pad
from mesoscale.answer.reserve import central_reserve
from mesoscale.answer.switches import PadModel, solve_point, surfaces_of
from mesoscale.contact import ContactInputs, Cycle, run_cycle
from mesoscale.contact.energy import pull_off
from mesoscale.errors import InputError
from mesoscale.extras import MissingExtra, needs
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import PAPER_ROWS, check_resolved, film_table, input_table
from mesoscale.settings import (
    ContactSettings,
    DeviceSettings,
    InputRow,
    InputsSettings,
    PadSettings,
    TopographySettings,
)
from mesoscale.settings.contact import NOMINAL_SEED
from mesoscale.settings.definitions import definition
from mesoscale.topography.measurements import check_count, files_in
from mesoscale.topography.measurements.cleaning import Scan, clean, without_missing
from mesoscale.topography.measurements.loading import Measurement, load_measurements, with_limits
from mesoscale.topography.pooling import pool
from mesoscale.topography.records import in_order, record
from mesoscale.topography.summary import doubt_lines, measurement_lines, parameters

MaterialInputs = Mapping[str, float | InputRow | Any]
"""Numbers, or distributions as `InputRow`, by the names of a scene's inputs: e_star, h_macro,
h_prime, hamaker, …
"""

PIXELS = {128: 4.0, 256: 4.0, 512: 1.0, 1024: 1.0, 2048: 1.0}
"""Grids, and how far beyond a film's cut-off they must resolve: small ones are for films of long
waves.
"""
TABLE_1 = InputsSettings()
MATERIAL = {
    "e_star": PAPER_ROWS["e_star"],
    "h_macro": TABLE_1.rows()["h_macro"],
    "h_prime": PAPER_ROWS["h_prime"],
    "hamaker": TABLE_1.rows()["hamaker"],
    "gap_cutoff": InputRow(
        values=(0.25, 0.29), source="tops of six glasses of silica (docs/hardness.md)"
    ),
}
"""The material where none is given: the paper's films, and D0 of silica."""


class Shown(ABC):
    """What says itself in lines of text: the first alone in a terminal, all of them in a
    notebook.
    """

    @abstractmethod
    def lines(self) -> Iterator[str]:
        """What it says, a line at a time."""

    def __repr__(self) -> str:
        return next(self.lines())

    def _repr_html_(self) -> str:
        text = f"<pre>{html.escape(chr(10).join(self.lines()))}</pre>"
        return text + self._picture()

    def _picture(self) -> str:
        """Its plot, small, as an HTML image; empty where it has none or nothing draws it."""
        plot = getattr(self, "plot", None)
        if plot is None:
            return ""
        try:
            figure = plot()
        except MissingExtra:
            return ""
        from matplotlib.pyplot import close

        file = BytesIO()
        figure.savefig(file, format="png", dpi=60)
        close(figure)  # a notebook would show it a second time
        content = b64encode(file.getvalue()).decode("ascii")
        return (
            f'<img alt="{html.escape(next(self.lines()))}" src="data:image/png;base64,{content}">'
        )


class Film(Shown):
    """What scans, line profiles and containers say together of one surface.

    Parameters
    ----------
    files : a file, a folder or a list of them, in any format that a scene reads; or a `Scan` of
        heights of your own.
    tip_nm : radius of the AFM tip where no file states it; None: that of a scene, 5 nm.
    settings : further keys of a scene's section `topography`, such as ``line_alignment="none"``.

    Attributes
    ----------
    measurements : what the files hold, before levelling.
    description : as topography/parameters.json of a scene: estimates, doubts, gate and what random
        surfaces follow.

    Raises
    ------
    InputError : nothing to read, or measurements that cannot be used.
    """

    def __init__(
        self,
        files: str | Path | Scan | Iterable[str | Path | Scan],
        tip_nm: float | None = None,
        **settings: Any,
    ) -> None:
        stated = [files] if isinstance(files, (str, Path, Scan)) else list(files)
        if not all(isinstance(item, (str, Path, Scan)) for item in stated):
            raise InputError(
                "Film: heights alone have no side; give Scan(heights_nm, (length_x_nm,"
                " length_y_nm), name), or press them by asp.press(heights, side_nm, loads_nN,"
                " e_star)"
            )
        sources: list[Any] = []
        for item in stated:
            if isinstance(item, Scan):
                sources.append(item)
            else:
                sources += files_in(item)
        if not sources:
            raise InputError(
                f"{', '.join(map(str, stated)) or 'files'}: nothing to read; give scans of a"
                " surface"
            )
        check_count(", ".join(str(item) for item in stated[:3]), sources)
        names = tuple(item.name if isinstance(item, Scan) else item for item in sources)
        tip = {}
        if tip_nm is not None:
            tip["tip_radius_nm"] = tip_nm
        self.settings = TopographySettings(scans=names, **tip, **settings)
        self.measurements: list[Measurement] = []
        arrays = {}
        attributes = {}
        for number, source in enumerate(sources, 1):
            for measured in _load(source, number, self.settings):
                name = measured.data.name
                arrays[name], described = record(measured, self.settings)
                attributes[name] = {**_origin(source), **described}
                self.measurements.append(measured)
        records = in_order(arrays, attributes)
        # cells that grow to hold a film's long waves have the grid of usual ones, so that they cost
        # no more
        pooled = pool(records, attributes, self.settings, cell_nm=None, cut_off=True, pixels=512)
        self._spectra = pooled.spectra
        self.description = parameters(pooled, attributes, self.settings)

    @property
    def maps(self) -> list[Scan]:
        """The maps among the measurements, levelled; `asp.press` presses one as it is."""
        return [
            clean(item.data, self.settings)
            for item in self.measurements
            if isinstance(item.data, Scan)
        ]

    @property
    def doubts(self) -> list[str]:
        """What to take with care, each with its remedy."""
        return list(doubt_lines(self.description))

    def lines(self) -> Iterator[str]:
        """A summary, what each measurement shows, and the doubts."""
        used = self.description["description"]
        doubts = self.description["doubts"]
        surfaces = "one surface"
        if any(doubt["code"] == "several_surfaces" for doubt in doubts):
            surfaces = "SEVERAL SURFACES"
        yield (
            f"Film (measurements: {len(self.measurements)}, doubts: {len(doubts)}): as far as can"
            f" be told of {surfaces}; described by {used['meaning']}"
        )
        yield from measurement_lines(self.description)
        yield from self.doubts

    def plot(self) -> Any:
        """The first map, levelled, and all spectra with their trusted parts, as a Matplotlib
        figure.
        """
        with needs("plot"):
            import matplotlib.pyplot as plt
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
        maps = self.maps
        for first in maps[:1]:
            x_um, y_um = (length / 1000 for length in first.lengths_nm)
            image = left.imshow(
                first.heights_nm.T, extent=(0, x_um, 0, y_um), origin="lower", cmap="Greys_r"
            )
            figure.colorbar(image, ax=left, label="height (nm)")
        left.set(xlabel="x (µm)", ylabel="y (µm)", title=maps[0].name if maps else "no map")
        for number, item in enumerate(self._spectra):
            q, psd = item.spectrum.q, item.spectrum.psd
            trusted = (q >= item.low) & (q <= item.high)
            right.loglog(q, psd, color="0.8", linewidth=0.6, zorder=1)
            right.loglog(
                q[trusted],
                psd[trusted],
                ".-",
                color=f"C{number % 10}",
                markersize=3,
                label=item.name,
            )
        right.set(xlabel="wave vector (1/nm)", ylabel="power spectrum (nm⁴); grey: not trusted")
        figure.legend(fontsize="small", loc="outside lower center", ncols=2)
        return figure

    def inputs(self, material: MaterialInputs | None = None) -> InputTable:
        """The uncertain inputs: roughness of the film, and the material (default: `MATERIAL`).

        Raises
        ------
        InputError : an unknown input, a value out of range, or measurements that no description
            fits.
        """
        stated = {name: _row(value) for name, value in (material or {}).items()}
        laws = ("", stated.get("hardness", "paper"))
        rows = {
            **{name: row for name, row in MATERIAL.items() if definition(name).hardness in laws},
            **stated,
        }
        if "adhesion" in rows:  # states the attraction by work and range
            rows = {
                name: row for name, row in rows.items() if name not in ("hamaker", "gap_cutoff")
            }
        return input_table(self.description, **rows)

    def press(
        self,
        material: MaterialInputs | None = None,
        load_nN: float | None = None,
        pixels: int | None = None,
    ) -> "FilmContact":
        """Close a cell of the film onto a flat up to a load, and open it: at central inputs,
        coupled asperities.

        The surface is the one of a scene's nominal curves: random, with the film's spectrum and
        heights. The cell has a side of 1 um, or a longer one where the measurements are coarse or
        the film has long waves (`description["cell_nm"]`).

        Parameters
        ----------
        load_nN : largest repulsive force (nN); None: 7000 on 1 um^2.
        pixels : a side; None: the fewest of 128, 256, … 2048 that resolve the film's cut-off.

        Raises
        ------
        InputError : as `inputs`, or a grid that does not resolve the cut-off.
        """
        table = self.inputs(material)
        described = self.description
        side = self.description["cell_nm"]
        pixels = pixels or pixels_for(described["inputs"]["q1"], side)
        settings = ContactSettings(pixels=pixels, surface=described["surface"]).on_cell(side)
        check_resolved(table, settings.nyquist_per_nm)
        on_grid, (inputs, settings) = settings, contact_of(table.medians(), settings)
        fields: list[tuple[np.ndarray, np.ndarray]] = []

        def look(contact: Any, _: Any) -> list[Any]:
            fields.append(contact.fields())
            return []

        cycle = run_cycle(inputs, settings, NOMINAL_SEED, load_nN, hold=look)
        pad = partial(film_table, table, described["film"])
        return FilmContact(inputs, settings, cycle, *fields[0], _pad=pad, on_grid=on_grid)


@dataclass(frozen=True, repr=False)
class FilmContact(Shown):
    """A film pressed onto a flat.

    Attributes
    ----------
    inputs, settings : what was computed.
    cycle : force against separation of closing and opening.
    _pad : uncertain inputs of a pad, which holds all places of the film, by their scatter
        (`pad.rms_scatter`).
    on_grid : settings before the inputs were put in.
    pressure_GPa, gap_nm : maps at the largest load, shape (pixels, pixels); walls touch where the
        pressure is positive.
    """

    inputs: ContactInputs
    settings: ContactSettings
    cycle: Cycle
    pressure_GPa: np.ndarray
    gap_nm: np.ndarray
    _pad: Callable[[Any], InputTable]
    on_grid: ContactSettings

    def lines(self) -> Iterator[str]:
        """Where it touches, how much of it, and how hard it pulls."""
        closing = self.cycle.closing
        share = float((self.pressure_GPa > 0).mean())
        doubt = "" if self.cycle.converged else "; NOT CONVERGED"
        yield (
            f"Contact: touches at {self.cycle.first_contact_nm:.4g} nm;"
            f" {closing.repulsive_nN[-1]:.4g} nN press it to {closing.separation_nm[-1]:.4g} nm,"
            f" {share:.2%} in contact; pulls off with {pull_off(self.cycle.opening):.3g} nN{doubt}"
        )

    def plot(self) -> Any:
        """The map of pressure and force against separation, as a Matplotlib figure."""
        with needs("plot"):
            import matplotlib.pyplot as plt
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
        side = self.settings.length_nm / 1000
        touching = np.where(self.pressure_GPa > 0, self.pressure_GPa, np.nan)
        left.imshow(self.gap_nm.T, extent=(0, side, 0, side), origin="lower", cmap="Greys")
        image = left.imshow(touching.T, extent=(0, side, 0, side), origin="lower", cmap="plasma")
        figure.colorbar(image, ax=left, label="pressure (GPa); grey: gap")
        left.set(xlabel="x (µm)", ylabel="y (µm)")
        for name in ("closing", "opening"):
            branch = getattr(self.cycle, name)
            right.plot(branch.separation_nm, branch.net_nN / 1000, label=name)
        edge = self.cycle.first_contact_nm + 0.5 * self.inputs.rms
        right.set(xlim=(None, edge), xlabel="mean separation (nm)", ylabel="net force (µN)")
        right.legend()
        return figure

    def switch(
        self,
        device: DeviceSettings | None = None,
        pad: PadSettings | None = None,
        progress: Callable[[float, str], None] | None = None,
    ) -> "Switch":
        """A switch on a pad of this film: pull-in and release at central inputs.

        Parameters
        ----------
        pad : how many cells are closed and opened, and how; the pad has their mean. None: 64.
        progress : called with the finished share and a word on it.

        Raises
        ------
        InputError : the pad never reaches the pressure that the switch presses with.
        """
        device = device or DeviceSettings()
        pad = pad or PadSettings()
        table = self._pad(pad.rms_scatter)
        central = central_point(table, self.on_grid, device)
        solved = solve_point(
            central, on_pad_grid(self.on_grid, table), pad.cells, surfaces_of(0), progress
        )
        if solved.pad is None:
            raise InputError(solved.refused)
        model = PadModel(solved, plan_points(table, self.on_grid, device, 0), ())
        content = switch_on_pad(model, self.on_grid.length_nm**2)
        return Switch(content | {"reserve": central_reserve(solved)})


@dataclass(frozen=True, repr=False)
class Switch(Shown):
    """A switch on a pad.

    Attributes
    ----------
    content : as answer/pad_switch.json of a scene without points.
    """

    content: dict[str, Any]

    @property
    def states(self) -> dict[str, Any] | None:
        """What the switch does: the bending electrode, or the plate of a given spring; None where
        nothing is known.
        """
        return self.content["central"]

    @property
    def release_V(self) -> float:
        """Voltage at which it lets go; 0 where it sticks, NaN where it is not known."""
        if not self.states:
            return float("nan")
        return self.states["release_V"]

    def lines(self) -> Iterator[str]:
        """Pull-in, release, and why not to trust them."""
        cells = self.content["cells_computed"]
        states = self.states
        reasons = self.content["gate"]["reasons"]
        head = f"Switch on a pad of {cells} cells"
        if not states:
            yield ": ".join([head, "not known", *reasons])
            return
        opens = "sticks"
        if self.release_V > 0:
            opens = f"opens at {self.release_V:.3g} V"
        closes = "touches" if "touches" in states else "closes"
        yield f"{head}: {closes} at {states['pull_in_V']:.3g} V, {opens}"
        if self.release_V == 0.0:
            reserve = self.content["reserve"]
            yield f"It would let go with {reserve['bears_times']:.2g} of its attraction"
            yield from map(_freed_words, reserve["freed_by"])
        for reason in reasons:
            yield f"DOUBT: {reason}"


def _freed_words(row: dict[str, Any]) -> str:
    """Which value of a property frees a switch that sticks."""
    name = row["key"]
    if row["frees"] is None:
        return f"{name} = {row['value']:.3g}: no other value in reach frees it"
    return f"{name} = {row['value']:.3g}: at {row['frees']:.3g} it lets go"


def pixels_for(cutoff: Mapping[str, float] | None, side_nm: float) -> int:
    """The fewest pixels a side that resolve a film's cut-off, uniform or fixed, on a cell; the most
    where none do.
    """
    if not cutoff:
        return max(PIXELS)
    shortest_per_nm = max(cutoff["a"], cutoff.get("b", 0.0))
    for pixels, margin in PIXELS.items():
        if np.pi * pixels / side_nm >= margin * shortest_per_nm:
            return pixels
    return max(PIXELS)


def _load(source: str | Scan, number: int, settings: TopographySettings) -> list[Measurement]:
    if isinstance(source, Scan):
        return [with_limits(without_missing(source), settings)]
    return load_measurements(source, f"{number:02d}_{Path(source).stem}", settings)


def _origin(source: str | Scan) -> dict[str, str]:
    if isinstance(source, Scan):
        return {"file": "", "sha256": ""}
    with Path(source).open("rb") as stream:
        return {"file": source, "sha256": hashlib.file_digest(stream, "sha256").hexdigest()}


def _row(value: Any) -> Any:
    """A number as a distribution."""
    if isinstance(value, (int, float)):
        return InputRow(distribution="fixed", values=(value,))
    return value
