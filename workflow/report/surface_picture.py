"""A picture of the measured surface for the eye: one map in nm with its colour bar, and the spectrum."""

from collections.abc import Mapping, Sequence
from itertools import takewhile
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from workflow.report.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, SKY, SOFT

# the page's figures take their colours from the page; a picture alone has them itself
PLAIN = {INK: "#222222", SOFT: "#b5b5b5", SKY: "#56b4e9", ORANGE: "#d55e00"}
PLAIN |= {BLUE: "#0072b2", GREEN: "#009e73", PURPLE: "#cc79a7"}


def short_names(names: Sequence[str]) -> dict[str, str]:
    """Names of measurements without what all of them begin with."""
    parts = [name.split("_") for name in names]
    alike = sum(1 for _ in takewhile(lambda column: len(set(column)) == 1, zip(*parts, strict=False)))
    cut = min(alike, *(len(part) - 1 for part in parts)) if len(names) > 1 else 0
    return {name: "_".join(part[cut:]) for name, part in zip(names, parts, strict=True)}


def surface_picture(
    groups: Mapping[str, Mapping[str, np.ndarray]],
    attributes: Mapping[str, Mapping[str, Any]],
    parameters: Mapping[str, Any],
    path: Path,
) -> None:
    """Write the picture (PNG) of a surface from the content of spectra.h5 and parameters.json."""
    with matplotlib.rc_context({"font.size": 10, "axes.axisbelow": True}):
        figure = Figure(figsize=(10.0, 4.2), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1, 1.2))
        _draw_map(figure, left, groups, attributes)
        draw_one_spectrum(right, groups, attributes, parameters, PLAIN)
        figure.savefig(path, dpi=130, format="png", metadata={"Software": None})


def _draw_map(figure: Figure, axis: Any, groups: Mapping[str, Any], attributes: Mapping[str, Any]) -> None:
    """The largest scan, or the longest profile where there is no scan."""
    names = sorted((name for name in groups if name.startswith("scans/")), key=lambda n: attributes[n]["length_x_nm"])
    maps = [name for name in names if "heights" in groups[name]]
    name = (maps or names)[-1]
    size = float(attributes[name]["length_x_nm"]) / 1e3
    axis.set(title=f"{name.removeprefix('scans/')}: RMS {float(attributes[name]['rms_nm']):.3g} nm", xlabel="µm")
    axis.title.set_fontsize(9)
    if maps:
        heights = groups[name]["heights"]
        limit = float(np.quantile(np.abs(heights), 0.995)) or 1.0
        extent = (0, size, 0, float(attributes[name]["length_y_nm"]) / 1e3)
        image = axis.imshow(heights.T, origin="lower", extent=extent, cmap="cividis", vmin=-limit, vmax=limit)
        figure.colorbar(image, ax=axis, label="height (nm)")
    else:
        line = groups[name]["line"]
        axis.plot(np.linspace(0, size, len(line)), line, color="#0072b2", linewidth=0.8)
        axis.set(ylabel="height (nm)")


def draw_one_spectrum(
    axis: Any,
    groups: Mapping[str, Any],
    attributes: Mapping[str, Any],
    parameters: Mapping[str, Any],
    colors: Mapping[str, str] | None = None,
) -> None:
    """All spectra with their trusted parts, and the one over all scales with its band.

    `colors` replace the page's marker colours.
    """
    ink, soft, sky, orange, *apart = (
        (colors or {}).get(color, color) for color in (INK, SOFT, SKY, ORANGE, BLUE, GREEN, PURPLE, SKY)
    )
    names = sorted(name for name in groups if name.startswith("scans/"))
    short = short_names([name.removeprefix("scans/") for name in names])
    several = 1 < len(names) <= len(apart)
    for name, color in zip(names, apart if several else [sky] * len(names), strict=False):
        q, psd = groups[name]["q"], groups[name]["psd"]
        low, high = float(attributes[name]["trusted_low"]), float(attributes[name]["trusted_high"])
        trusted = (q >= low) & (q <= high)
        label = f"{short[name.removeprefix('scans/')]}, trusted range" if several else None
        axis.loglog(q, psd, color=soft, linewidth=0.6, alpha=0.7, zorder=1)
        axis.loglog(q[trusted], psd[trusted], color=color, linewidth=1.6, zorder=4, label=label)
    if not several:
        axis.plot([], [], color=sky, label="measurements, trusted range")
    axis.plot([], [], color=soft, label="limited by levelling, tip, noise or pixels")
    one = groups.get("one_spectrum")
    if one is not None:
        level = f"{float(parameters['confidence']):.0%}"
        axis.fill_between(one["q"], one["band_low"], one["band_high"], color=orange, alpha=0.25, linewidth=0)
        axis.loglog(one["q"], one["psd"], color=orange, label=f"one spectrum, {level} band", zorder=3)
    end = parameters["trusted_end"]
    axis.axvline(end["value"], color=ink, linewidth=0.8, linestyle="--", label=f"trusted end ({end['limit']})")
    axis.set(xlabel="wave vector q (1/nm)", ylabel="PSD (nm⁴)")
    axis.legend(fontsize=8)
