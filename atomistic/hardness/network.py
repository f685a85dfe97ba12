"""A covalent glass below an oxide film: silicon nitride by Tersoff, melted and quenched.

The schedule is that of the elastic stage (`atomistic/elastic/networks.py`), in cells as wide as
those of the oxide.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asperity.guards.errors import InputError
from atomistic.constants import AVOGADRO
from atomistic.covalent import Quench, core_commands, random_places, tersoff_table
from atomistic.hardness.film_base import Base
from atomistic.hardness.glass import NEAREST_START_A, density_g_cm3, run_segments, unlike_neighbours
from atomistic.lammps import Atoms, LammpsFolder, Progress
from atomistic.materials import NetworkGlass


@dataclass(frozen=True)
class SlowQuench(Quench):
    """The quench of the elastic stage, with its rate and a rest at the end."""

    rate_K_ps: float = 100.0
    rest_ps: float = 3.0


QUENCH = SlowQuench()


@dataclass(frozen=True)
class Network(Base):
    """A glass of covalent bonds below films, or by itself."""

    styles = ("tersoff", "harmonic/cut")

    @property
    def network(self) -> NetworkGlass:
        """Its potential, and what it must look like."""
        return self.material.part("network_glass")

    @property
    def masses_u(self) -> Mapping[str, float]:
        """Mass of each element."""
        return self.network.masses_u

    @property
    def atoms_per_nm3(self) -> float:
        """At the density of its start."""
        unit_u = sum(
            count * self.network.masses_u[element]
            for element, count in self.material.formula.items()
        )
        atoms = sum(self.material.formula.values())
        return atoms * self.network.start_density_g_cm3 * AVOGADRO / unit_u * 1e-21

    def commands(self, above: int) -> list[str]:
        """Commands of its own atoms, the first types."""
        types = " ".join([*self.elements, *["NULL"] * above])
        return [
            f"pair_coeff * * tersoff base.tersoff {types}",
            *core_commands(self.network.cores, self.elements),
        ]

    def tables(self) -> dict[str, str]:
        """The Tersoff potential."""
        return {"base.tersoff": tersoff_table(self.network.tersoff)}

    def make(
        self, edge_A: float, tiles: int, seed: int, work: Path, progress: Progress | None = None
    ) -> Atoms:
        """A cell as wide as the oxide's glass, at zero pressure and 300 K; resumes in `work`.

        Raises
        ------
        InputError : its density or coordination is not that of the material's file.
        """
        segments = _segments()
        identity = {
            "network": self.material.model_dump(),
            "edge": edge_A,
            "seed": seed,
            "segments": segments,
        }
        glass = run_segments(
            LammpsFolder(work, identity, "glass.in"),
            self,
            self.elements,
            lambda: self._random_start(edge_A, seed),
            segments,
            1 + seed,
            QUENCH.timestep_fs,
            f"melt and quench of {self.material.name}",
            progress,
        )
        if reasons := self.faults(glass):
            raise InputError(
                f"{self.material.name}: {'; '.join(reasons)}; take another seed or a wider glass"
                " cell"
            )
        return glass

    def _random_start(self, edge_A: float, seed: int) -> Atoms:
        formula = self.material.formula
        formulas = (edge_A / 10) ** 3 * self.atoms_per_nm3 / sum(formula.values())
        units = max(1, round(formulas))
        counts = [units * count for count in formula.values()]
        rng = np.random.default_rng(np.random.SeedSequence([seed, 47]))
        cell = np.full(3, edge_A)
        places = random_places(sum(counts), cell, NEAREST_START_A, rng)
        types = rng.permutation(np.repeat(np.arange(1, len(counts) + 1), counts))
        return Atoms(self.elements, types, places, cell)

    def properties(self, glass: Atoms) -> dict[str, float]:
        """Density (g/cm3), median unlike bond (Å), and mean coordination of each element."""
        bonds, lengths_A = unlike_neighbours(glass, glass.types, self.network.cutoff_A)
        neighbours = np.bincount(bonds.ravel(), minlength=len(glass))
        measured = {
            "density_g_cm3": density_g_cm3(glass, self),
            "bond_A": float(np.median(lengths_A)),
        }
        for kind, element in enumerate(glass.elements, 1):
            measured[f"coordination_{element}"] = float(neighbours[glass.types == kind].mean())
        return measured

    def faults(self, glass: Atoms) -> list[str]:
        """What of a glass is not as its material's file says."""
        measured = self.properties(glass)
        accepted = {"density_g_cm3": self.network.density_g_cm3}
        for element, limits in self.network.coordination.items():
            accepted[f"coordination_{element}"] = limits
        return [
            f"{name} {measured[name]:.3g} outside {low:g} to {high:g}"
            for name, (low, high) in accepted.items()
            if not low <= measured[name] <= high
        ]


def _segments() -> list[dict[str, Any]]:
    """Melt and quench for `run_segments`: at constant volume, then the height is free."""
    melt, free, end = QUENCH.melt_K, QUENCH.free_below_K, QUENCH.final_K
    stages = [
        ("nvt", 1.5 * melt, melt, 0.2 * QUENCH.melt_ps),
        ("nvt", melt, melt, 0.8 * QUENCH.melt_ps),
        ("nvt", melt, free, (melt - free) / QUENCH.rate_K_ps),
        ("npt_height", free, end, (free - end) / QUENCH.rate_K_ps),
        ("npt_height", end, end, QUENCH.rest_ps),
    ]
    segments = []
    for ensemble, start, end, duration_ps in stages:
        steps = round(1000 * duration_ps / QUENCH.timestep_fs)
        segments.append({"ensemble": ensemble, "from": start, "to": end, "steps": steps})
    return segments
