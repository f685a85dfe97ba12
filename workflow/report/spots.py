"""Picture of the surface with its contact spots under load: an image of the heights, and a layer for each step."""

import base64
import io

import numpy as np

from workflow.report.available import Results
from workflow.report.numbers import show

SHADES = 256


def spots_picture(results: Results) -> str | None:
    """The picture with its slider; without a script it shows the spots of the largest load."""
    if not results.has("curves/spots.h5"):
        return None
    groups, attributes, _ = results.h5("curves/spots.h5")
    spots, length = groups["spots"], float(attributes["length_nm"])
    heights = spots["towards_flat_nm"]
    limit = float(np.abs(heights).max())
    image, colors = _image(heights, limit)
    side = heights.shape[0]
    last = len(spots["separation_nm"]) - 1
    words = [_words(spots, k) for k in range(last + 1)]
    squares = [_squares(spots["step"] == k) for k in range(len(words))]
    layers = "".join(
        f'<path d="{path}" data-step="{k}" data-words="{text}"/>'
        for k, (path, text) in enumerate(zip(squares, words, strict=True))
    )
    label = f"Heights of the surface and where the flat has reached it; {words[-1]}"
    ends = f"−{show(limit)} nm", f"+{show(limit)} nm, towards the flat"
    return (
        f'<div class="spots" id="spots"><svg viewBox="0 0 {side} {side}" role="img" aria-label="{label}">'
        f'<image href="data:image/png;base64,{image}" width="{side}" height="{side}"/>'
        f'<g class="reached">{layers}</g>{_scale(side, length)}</svg>'
        f'<p class="bar"><span>{ends[0]}</span><span style="background: linear-gradient(90deg, {colors})"></span>'
        f"<span>{ends[1]}</span></p>"
        f'<label hidden>load <input type="range" min="0" max="{last}" value="{last}" autocomplete="off"></label>'
        f'<p class="told">{words[-1]}</p></div>'
    )


def _scale(side: int, length_nm: float) -> str:
    """A bar of a fifth of the side."""
    sizes = f'font-size="{0.05 * side:g}" stroke-width="{0.012 * side:g}"'
    line = f'<path d="M{0.05 * side:g} {0.95 * side:g}h{0.2 * side:g}"/>'
    words = f'<text x="{0.05 * side:g}" y="{0.92 * side:g}">{show(0.2 * length_nm)} nm</text>'
    return f'<g class="scale" {sizes}>{line}{words}</g>'


def _words(spots: dict[str, np.ndarray], k: int) -> str:
    load, share = float(spots["repulsive_nN"][k]) / 1e3, float(spots["cut_share"][k])
    return (
        f"{show(load)} µN: separation {show(spots['separation_nm'][k])} nm, asperities in contact: "
        f"{int(spots['asperities'][k])}, {show(100 * share, 2)} % of the surface reached"
    )


def _image(heights: np.ndarray, limit: float) -> tuple[str, str]:
    """PNG of the heights in base64, and the colours from lowest to highest for a gradient."""
    import matplotlib
    from PIL import Image

    table = (matplotlib.colormaps["cividis"](np.linspace(0, 1, SHADES))[:, :3] * 255).round().astype(np.uint8)
    shades = ((heights / limit + 1) / 2 * (SHADES - 1)).round().astype(np.uint8)
    picture = Image.fromarray(shades.T[::-1], "P")
    picture.putpalette(table.tobytes())
    stream = io.BytesIO()
    picture.save(stream, "PNG", optimize=True)
    colors = ", ".join("#" + bytes(table[k]).hex() for k in np.linspace(0, SHADES - 1, 9).astype(int))
    return base64.b64encode(stream.getvalue()).decode(), colors


def _squares(mask: np.ndarray) -> str:
    """Path of the pixels, run by run, in the orientation of the image."""
    parts: list[str] = []
    for row, line in enumerate(mask.T[::-1]):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], line.astype(int), [0]])))
        parts += [f"M{start} {row}h{end - start}v1h{start - end}z" for start, end in edges.reshape(-1, 2).tolist()]
    return "".join(parts)
