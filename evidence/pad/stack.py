"""How far does a stack of elastic layers move the release of a switch, which is pressed with one modulus?

Points of finished scenes, the central one first, on pads of the same surfaces: `bare` with the modulus of the scene,
`soft` and `stiff` with 2.5 nm of oxide on the nitride and 5 nm of oxide on the titanium. The modulus of the scene is
then that of the bases. Titanium oxide has 130 GPa (amorphous with tantalum: arXiv:1401.7061, 132 to 177) or 226 GPa
(rutile films: Chuang and Luo, doi:10.4028/www.scientific.net/AMR.214.388).
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from evidence.pad.runs import finished
from mesoscale.device.points import solve_point, surfaces_of
from mesoscale.settings import ContactSettings

CELLS = 16
NITRIDE, TITANIUM = {"young_GPa": 280.0, "poisson": 0.26}, {"young_GPa": 116.0, "poisson": 0.32}
SILICA = {"young_GPa": 73.0, "poisson": 0.17, "thickness_nm": 2.5}  # fused silica
TITANIA_GPa = {"soft": 130.0, "stiff": 226.0}


def arguments(parser: ArgumentParser) -> None:
    """Finished scenes, and how many points of each."""
    parser.add_argument("results", nargs="+", type=Path)
    parser.add_argument("--points", type=int, default=8)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each point."""
    for folder in given.results:
        points, _ = finished(folder)
        grid = points.on_grid.model_dump()
        stacks = {"bare": ()} | {name: _stack(young) for name, young in TITANIA_GPa.items()}
        contacts = {name: ContactSettings.model_validate(grid | {"bodies": stack}) for name, stack in stacks.items()}
        for number in range(given.points + 1):
            point = points.by_number[number]
            solved = {name: solve_point(point, of, CELLS, surfaces_of(number)) for name, of in contacts.items()}
            releases = {f"{name}_V": one.states.get("release_V", np.nan) for name, one in solved.items()}
            yield {"scene": folder.name, "point": number} | releases


def _stack(titania_GPa: float) -> tuple[tuple[dict[str, float], ...], ...]:
    titania = {"young_GPa": titania_GPa, "poisson": 0.28, "thickness_nm": 5.0}
    return (SILICA, NITRIDE), (titania, TITANIUM)


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """What layers add to the release."""
    shown = {}
    for name in TITANIA_GPa:
        moved = np.array([float(row[f"{name}_V"]) - float(row["bare_V"]) for row in table])
        moved = moved[np.isfinite(moved)]
        shown[name] = f"{np.median(moved):+.2f} [{moved.min():+.2f}, {moved.max():+.2f}] V"
    return shown
