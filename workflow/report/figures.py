"""The figures of a page as SVG files of their own, for slides and `snakemake --report`."""

import re
from pathlib import Path

STYLE = Path(__file__).with_name("style.css")


def figures_of(page: str) -> dict[str, str]:
    """Drawn figures of a page by name, in its light colours.

    Programs that draw SVG files know no CSS variables, so that each gets its value.
    """
    style = STYLE.read_text(encoding="utf-8")
    light = style[: style.index("@media")]
    colors = dict(re.findall(r"(--[\w-]+): (#\w+);", light))
    figures = {}
    for picture in re.findall(r"<figure[^>]*>(?:<div[^>]*>)?(<svg.*?</svg>)", page, re.DOTALL):
        name = re.search(r'id="([\w-]+)-figure_1"', picture)
        if name is not None:
            colored = re.sub(
                r"var\((--[\w-]+)\)", lambda match: colors.get(match[1], match[0]), picture
            )
            figures[name[1]] = colored.replace("<svg ", '<svg font-family="sans-serif" ', 1)
    return figures
