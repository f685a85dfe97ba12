"""What lies below an oxide film, whatever its potential: a metal, or a glass of covalent bonds."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from atomistic.lammps import Atoms, Progress
from atomistic.materials import FilmBase, Material

NEIGHBOURS = ("neighbor 1.0 bin", "neigh_modify every 2 delay 0 check yes")


@dataclass(frozen=True)
class Base(ABC):
    """A material as the body below a film: its atoms have the first LAMMPS types.

    Attributes
    ----------
    styles : its parts of a `pair_style hybrid/overlay`.
    """

    material: Material
    styles: ClassVar[tuple[str, ...]]

    @property
    def elements(self) -> tuple[str, ...]:
        """Of its LAMMPS types."""
        return tuple(self.material.formula)

    @property
    def below_films(self) -> FilmBase:
        """How atoms of a film act on it, and its grains if it is a metal."""
        return self.material.part("film_base")

    @property
    @abstractmethod
    def masses_u(self) -> Mapping[str, float]:
        """Mass of each element."""

    @property
    @abstractmethod
    def atoms_per_nm3(self) -> float:
        """About, for estimates of cost."""

    @abstractmethod
    def commands(self, above: int) -> list[str]:
        """LAMMPS commands of its own atoms.

        Parameters
        ----------
        above : types of other bodies, which follow.
        """

    @abstractmethod
    def tables(self) -> dict[str, str]:
        """The files that `commands` name."""

    @abstractmethod
    def make(
        self, edge_A: float, tiles: int, seed: int, work: Path, progress: Progress | None = None
    ) -> Atoms:
        """A periodic cell that tiles the width of an asperity; resumes in `work` after a kill.

        Parameters
        ----------
        edge_A, tiles : edge of a cell of the oxide's glass, and how many are as wide as the
            asperity.

        Raises
        ------
        InputError : what was made is not what its file asks for.
        """

    def files(self, elements: tuple[str, ...], energy_scale: float) -> dict[str, str]:
        """What LAMMPS needs for a body without a film; it keeps its energies at every scale."""
        lines = [
            f"pair_style hybrid/overlay {' '.join(self.styles)}",
            *self.commands(0),
            *NEIGHBOURS,
        ]
        return {**self.tables(), "pairs": "\n".join(lines) + "\n"}
