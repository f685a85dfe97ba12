"""Surface topography: figures 9 and 10, and the parameters."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from workflow.report.available import Results
from workflow.report.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, RED, SKY, SOFT, draw
from workflow.report.measured_surface import (
    chosen_description,
    described_surface,
    doubts,
    short_names,
)
from workflow.report.numbers import SYMBOLS, cell, show, shown_unit
from workflow.report.page import Block, Figure, PageTable, stage, table


@stage(
    "Surface topography",
    *("topography/spectra.h5", "topography/parameters.json"),
    also=("topography/judged.csv",),
)
def describe(results: Results) -> Iterator[Block]:
    """Figures 9 and 10, and the roughness parameters."""
    parameters = results.json("topography/parameters.json")
    scans = "Spectra of the measured scans."
    if parameters.get("synthetic"):
        scans = (
            "The scans are synthetic: made by the workflow with known parameters, passed through a"
            " simulated microscope and read back from a real file format. They check the method;"
            " they are no measurement."
        )
    yield (
        f"{scans} The Hurst exponent follows the {parameters['convention']} convention."
        f"{chosen_description(parameters)}"
    )
    caption = "Height maps and line profiles after levelling, in nm about their mean."
    yield Figure(maps(results), caption, "Figure 9", wide=True)
    yield Figure(
        spectra(results),
        "Power spectra of all scans, pooled, with the fits behind q₀, Hurst exponent and RMS. The"
        " fits use the trusted part; grey is what levelling, tip, noise or pixels disturb.",
        "Figure 10",
    )
    if parameters.get("estimates"):
        yield _estimates(parameters, results.beside_paper)
    yield from doubts(parameters, "q0", "slope")
    yield from described_surface(results, parameters)


def _estimates(parameters: Mapping[str, Any], beside_paper: bool) -> PageTable:
    paper = {
        "q0": "≈ 0.02",
        "hurst": "≈ 0.92 (0.46 to 1.20) by 2H + 1",
        "rms": "1.82 to 14.17",
        "slope": "2.84",
    }
    truth = parameters.get("truth") or {}
    title = "Roughness parameters"
    if parameters.get("description", {}).get("name", "power_law") != "power_law":
        title = "Eq. 9 fitted for comparison; random surfaces do not follow it"
    columns: dict[str, Any] = {
        "parameter": lambda row: SYMBOLS.get(row["name"], row["name"]),
        "unit": lambda row: shown_unit(str(row.get("unit", ""))),
        "estimate": cell("value"),
        "interval": lambda row: _pair(row.get("interval")),
        "scatter of scans": lambda row: _pair(row.get("scatter")),
    }
    if truth:
        columns["truth"] = lambda row: show(truth.get(row["name"], truth.get(f"{row['name']}_nm")))
    if beside_paper:
        columns["paper"] = lambda row: paper.get(row["name"], "")
    rows = [{"name": name, **estimate} for name, estimate in parameters["estimates"].items()]
    return table(title, rows, columns)


def maps(results: Results) -> str | None:
    """Figure 9: height maps of the scans, and heights along line profiles."""
    groups, _, scan_attributes = results.h5("topography/spectra.h5")
    names = [
        name
        for name in sorted(groups)
        if name.startswith("scans/") and {"heights", "line"} & set(groups[name])
    ]
    if not names:
        return None
    short = short_names([name.removeprefix("scans/") for name in names])
    # one of each size first, then more up to six
    names.sort(key=lambda name: (float(scan_attributes[name].get("length_x_nm", 0)), name))
    named = names
    if len(names) > 6:
        named = names[:3] + names[-3:]
    columns = min(3, len(named))
    rows = -(-len(named) // columns)
    last_map = next((name for name in reversed(named) if "heights" in groups[name]), "")

    def plot(*axes):
        for axis, name in zip(axes, named, strict=False):
            size, unit = _size(scan_attributes[name])
            rms = float(scan_attributes[name].get("rms_nm", np.nan))
            title = short[name.removeprefix("scans/")]
            if len(title) > 32:
                title = f"…{title[-32:]}"
            axis.set_title(f"{title}:\nRMS {rms:.3g} nm")
            axis.set_xlabel(unit)
            axis.locator_params(axis="x", nbins=4)
            if "line" in groups[name]:
                line = groups[name]["line"]
                axis.plot(np.linspace(0, size, len(line)), line, color=BLUE, linewidth=0.7)
                axis.set_ylabel("height (nm)")
                continue
            bar = _show_map(axis, groups[name]["heights"], size)
            if name == last_map:
                bar.set_label("height (nm)")
        for axis in axes[len(named) :]:
            axis.set_visible(False)

    return draw(
        "fig9",
        "Height maps of the scans",
        plot,
        (max(3.4, 2.7 * columns), 2.7 * rows),
        columns,
        rows,
    )


def first_map(results: Results) -> tuple[str, str] | None:
    """The user's first map in small, with what it is; None of lines alone, or of made-up scans."""
    if not results.has("topography/spectra.h5", "topography/parameters.json"):
        return None
    if results.json("topography/parameters.json").get("synthetic"):
        return None
    groups, _, scan_attributes = results.h5("topography/spectra.h5")
    names = [name for name in sorted(groups) if name.startswith("scans/")]
    of_maps = [name for name in names if "heights" in groups[name]]
    if not of_maps:
        return None
    first = of_maps[0]
    size, unit = _size(scan_attributes[first])
    rms_nm = show(scan_attributes[first].get("rms_nm"))

    def plot(axis):
        axis.set_xlabel(unit)
        axis.locator_params(axis="x", nbins=4)
        _show_map(axis, groups[first]["heights"], size).set_label("height (nm)")

    words = f"Your surface: {first.removeprefix('scans/')}, RMS {rms_nm} nm"
    if others := len(names) - 1:
        words += f"; {others} more below"
    return draw("first-map", "Height map of the surface", plot, (3.6, 2.2)), f"{words}."


def _size(attributes: Mapping[str, Any]) -> tuple[float, str]:
    """Length of a scan in a unit of its size."""
    size_nm = float(attributes["length_x_nm"])
    if size_nm >= 1000:
        return size_nm / 1e3, "µm"
    return size_nm, "nm"


def _show_map(axis: Any, heights: np.ndarray, size: float) -> Any:
    """Draw a map; returns its colour bar."""
    heights = _thin(heights)
    limit = float(np.quantile(np.abs(heights), 0.995))
    shades = {"cmap": "cividis", "vmin": -limit, "vmax": limit, "interpolation": "none"}
    image = axis.imshow(heights.T, origin="lower", extent=(0, size, 0, size), **shades)
    bar = axis.figure.colorbar(image, ax=axis, shrink=0.7)
    bar.outline.set_visible(False)
    axis.grid(False)
    return bar


def spectra(results: Results) -> str | None:
    """Figure 10: spectra of all scans, pooled spectrum, fits, and the truth of synthetic scans."""
    groups, attributes, scan_attributes = results.h5("topography/spectra.h5")
    names = [name for name in groups if name.startswith("scans/")]
    if not names:
        return None
    styles = {
        "likelihood": ("fit of eq. 9 (maximum likelihood)", BLUE, "-"),
        "lines": ("line fits", GREEN, "-"),
        "shallow_bound": ("bounding slopes", RED, "--"),
        "steep_bound": (None, RED, "--"),
        "plateau_low": ("bounding plateaus", PURPLE, ":"),
        "plateau_high": (None, PURPLE, ":"),
        "truth": ("truth of the typical synthetic place", INK, "--"),
    }

    def plot(axis):
        lowest, highest = np.inf, 0.0
        for name in sorted(names):
            q = groups[name]["q"]
            psd = groups[name]["psd"]
            low, high = (
                float(scan_attributes[name].get(key, end))
                for key, end in (("trusted_low", 0), ("trusted_high", np.inf))
            )
            trusted = (q >= low) & (q <= high)
            axis.loglog(q, psd, color=SOFT, linewidth=0.5, alpha=0.6, zorder=1)
            axis.loglog(q[trusted], psd[trusted], color=SKY, linewidth=0.9, alpha=0.7, zorder=2)
            axis.plot(q[trusted][-1:], psd[trusted][-1:], "|", color=INK, markersize=7, zorder=4)
            lowest = min(lowest, psd[psd > 0].min())
            highest = max(highest, psd.max())
        scans = "synthetic scans" if attributes.get("synthetic") else "scans"
        axis.plot([], [], color=SKY, label=f"{len(names)} {scans}, trusted part")
        axis.plot(
            [], [], color=SOFT, linewidth=0.5, label="limited by levelling, tip, noise or pixels"
        )
        axis.plot([], [], "|", color=INK, label="where the instrument ends it")
        if "pooled" in groups:
            axis.loglog(
                groups["pooled"]["q"],
                groups["pooled"]["psd"],
                color=ORANGE,
                label="pooled",
                linewidth=1.2,
                zorder=1.5,
            )
        fits = groups.get("fits", {})
        for name, (label, color, style) in styles.items():
            if name in fits:
                axis.loglog(fits["q"], fits[name], style, color=color, label=label, linewidth=1.3)
        axis.set(
            xlabel="wave vector q (1/nm)",
            ylabel="PSD (nm⁴)",
            ylim=(max(lowest, highest * 1e-12), 5 * highest),
        )
        axis.legend()

    return draw("fig10", "Power spectra of the scans with fits", plot, (5.0, 4.2))


def _thin(heights: np.ndarray, pixels: int = 128) -> np.ndarray:
    step = max(1, -(-max(heights.shape) // pixels))
    return heights[::step, ::step]


def _pair(pair: Any) -> str:
    if not isinstance(pair, list) or len(pair) != 2:
        return "–"
    low, high = pair
    return f"{show(low)} to {show(high)}"
