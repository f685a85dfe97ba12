"""Figures as inline SVG that follow the page: its font, its colours, light and dark.

Matplotlib draws in marker colours, each of which becomes a CSS variable of the page afterwards.
Numbers of a figure are in the files named below it.
"""

import base64
import io
import re
from collections.abc import Callable
from typing import Any

import matplotlib
import numpy as np

matplotlib.use("svg")
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
from PIL import Image

INK, SOFT, GRID, PAPER = "#010203", "#010204", "#010205", "#010206"
SERIES = ("#020301", "#020302", "#020303", "#020304", "#020305", "#020306")
BLUE, ORANGE, GREEN, PURPLE, SKY, RED = SERIES
VARIABLES = {
    INK: "--ink",
    SOFT: "--soft",
    GRID: "--grid",
    PAPER: "--card",
    **{color: f"--series-{i + 1}" for i, color in enumerate(SERIES)},
}
STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",  # text stays text: selectable, read aloud, in the page's font
    "font.family": "sans-serif",
    "font.size": 10,
    "axes.edgecolor": SOFT,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "axes.titlesize": 10.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "text.color": INK,
    "lines.linewidth": 1.8,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "legend.title_fontsize": 9,
    "axes.formatter.use_mathtext": False,
    "path.simplify_threshold": 0.3,
}


def draw(
    name: str,
    label: str,
    plot: Callable[..., None],
    size: tuple[float, float] = (5.0, 3.5),
    columns: int = 1,
    rows: int = 1,
    **options: Any,
) -> str:
    """SVG of a figure; one of several columns also as single panels, which narrow screens show
    below each other.

    Parameters
    ----------
    name : unique on the page; prefixes every id, so that figures cannot disturb each other
    label : what the figure shows, read aloud by screen readers
    plot : called with the axes, one argument per panel
    options : passed to `Figure.subplots`
    """
    with matplotlib.rc_context({**STYLE, "svg.hashsalt": name}):
        figure = Figure(figsize=size, layout="constrained")
        figure.patch.set_alpha(0)
        axes = figure.subplots(rows, columns, squeeze=False, **options).ravel()
        for axis in axes:
            axis.patch.set_alpha(0)
        plot(*axes)
        _lay_out(figure)
        boxes = _panels(figure) if columns > 1 else []
        stream = io.StringIO()
        # not Figure.savefig, which draws twice: once to find out what a layout would need
        FigureCanvasSVG(figure).print_svg(stream, metadata={"Date": None, "Creator": None})
    full_figure = _inline(stream.getvalue(), name, label)
    if not boxes:
        return full_figure
    pieces = (
        f'<svg viewBox="{box}" role="img" aria-label="{_attribute(label)}, panel {k}">'
        f'<use href="#{name}-figure_1"/></svg>'
        for k, box in enumerate(boxes, start=1)
    )
    return f'<div class="whole">{full_figure}</div><div class="panels">{"".join(pieces)}</div>'


def _lay_out(figure: Figure) -> None:
    """Find the places of everything once; otherwise each drawing would find them again."""
    engine = figure.get_layout_engine()
    assert engine is not None
    engine.execute(figure)
    figure.set_layout_engine("none")


def _panels(figure: Figure) -> list[str]:
    """View boxes of the panels, in points from the upper left corner."""
    width, height = 72 * figure.get_size_inches()
    boxes = []
    bars = {
        axis: [image.colorbar.ax for image in axis.images if image.colorbar] for axis in figure.axes
    }
    panels = [
        axis
        for axis in figure.axes
        if axis.get_visible() and not any(axis in bar for bar in bars.values())
    ]
    for axis in panels:
        extents = [extent.get_tightbbox() for extent in (axis, *bars[axis])]
        box = (
            Bbox.union([extent for extent in extents if extent is not None])
            .transformed(figure.transFigure.inverted())
            .padded(0.005)
        )
        boxes.append(
            f"{box.x0 * width:.1f} {(1 - box.y1) * height:.1f} {box.width * width:.1f}"
            f" {box.height * height:.1f}"
        )
    return boxes


def _attribute(label: str) -> str:
    return label.replace("&", "and").replace('"', "'").replace("<", "less than")


def _inline(svg: str, name: str, label: str) -> str:
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r'\bid="([^"]+)"', rf'id="{name}-\1"', svg)
    svg = re.sub(r"url\(#([^)]+)\)", rf"url(#{name}-\1)", svg)
    svg = re.sub(r'href="#([^"]+)"', rf'href="#{name}-\1"', svg)
    for color, variable in VARIABLES.items():
        svg = svg.replace(color, f"var({variable})")
    # fonts come from the page; sizes stay
    svg = re.sub(r"font: ([\d.]+px) [^;\"]+", r"font-size: \1", svg)
    svg = re.sub(r"font-family: [^;\"]+;? ?", "", svg)
    # matplotlib blackens what has no colour of its own
    svg = svg.replace("fill: #000000", "fill: var(--ink)").replace(
        "stroke: #000000", "stroke: var(--ink)"
    )
    svg = re.sub(r">([^<]*\w_\w[^<]*)<", lambda match: f">{_subscripts(match[1])}<", svg)
    svg = re.sub(r"\n\s*", "\n", svg)
    svg = _lighter(svg)
    opening = re.match(r"<svg[^>]*>", svg)
    assert opening is not None
    box = re.search(r'viewBox="([^"]+)"', opening[0])
    assert box is not None
    width = float(box[1].split()[2]) * 4 / 3
    start = (
        '<svg xmlns:xlink="http://www.w3.org/1999/xlink" xmlns="http://www.w3.org/2000/svg"'
        f' viewBox="{box[1]}" role="img" aria-label="{_attribute(label)}"'
        f' style="--width:{width:.0f}px">'
    )
    return start + svg[opening.end() :]


def _lighter(svg: str) -> str:
    """The same picture in fewer bytes: coordinates to a hundredth of a point, images by their
    palette.
    """
    svg = re.sub(
        r'\b(?:d|x|y|width|height|transform)="[^"]*"',
        lambda match: re.sub(r"(\.\d\d)\d+", r"\1", match[0]),
        svg,
    )
    return re.sub(
        r"(?<=data:image/png;base64,)[A-Za-z0-9+/=\s]+", lambda match: _by_palette(match[0]), svg
    )


def _by_palette(encoded: str) -> str:
    """A PNG in base64 with one byte a pixel, unless it has more than 256 colours."""
    pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(encoded))).convert("RGBA"))
    colors, places = np.unique(pixels.reshape(-1, 4), axis=0, return_inverse=True)
    if len(colors) > 256:
        return encoded
    picture = Image.fromarray(places.reshape(pixels.shape[:2]).astype(np.uint8))
    picture.putpalette(colors[:, :3].tobytes())
    stream = io.BytesIO()
    picture.save(stream, "PNG", optimize=True, transparency=colors[:, 3].tobytes())
    return base64.b64encode(stream.getvalue()).decode()


SUBSCRIPT = re.compile(r"(?<![A-Za-z])(δ?[A-Za-zρ])_(macro|film|[a-zA-Z])(?![A-Za-z_])")


def _subscripts(text: str) -> str:
    """Names such as d_c with their index set low."""
    low = r'\1<tspan dy="2.5" font-size="75%">\2</tspan><tspan dy="-2.5">&#8203;</tspan>'
    return SUBSCRIPT.sub(low, text)
