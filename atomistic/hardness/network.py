"""A covalent glass below an oxide film: silicon nitride by its Tersoff potential, melted and quenched.

The schedule is that of the elastic stage (`atomistic/elastic/networks.py`), in cells as wide as those of the oxide.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from atomistic.constants import AVOGADRO
from atomistic.covalent import core_commands, random_places, tersoff_table
from atomistic.errors import InputError
from atomistic.hardness.film_base import Base
from atomistic.hardness.glass import NEAREST_START_A, density_g_cm3, run_segments, unlike_neighbours
from atomistic.lammps import Atoms, Progress, Workspace
from atomistic.materials import NetworkGlass

MELT_K, FREE_BELOW_K, FINAL_K = 5000.0, 2500.0, 300.0
MELT_PS, QUENCH_K_PS, REST_PS = 3.0, 100.0, 3.0
TIMESTEP_FS = 1.0
FILE = "base.tersoff"


@dataclass(frozen=True)
class Network(Base):
    """A glass of covalent bonds below films, or by itself."""

    styles = ("tersoff", "harmonic/cut")

    @property
    def network(self) -> NetworkGlass:
        """Its potential, and what it must look like."""
        return self.material.part("network_glass")

    @property
    def species(self) -> Mapping[str, Any]:
        """What has the mass of its atoms, by element."""
        return {element: SimpleNamespace(mass_u=mass) for element, mass in self.network.masses_u.items()}

    @property
    def atoms_per_nm3(self) -> float:
        """At the density of its start."""
        unit_u = sum(count * self.network.masses_u[element] for element, count in self.material.formula.items())
        atoms = sum(self.material.formula.values())
        return atoms * self.network.start_density_g_cm3 * AVOGADRO / unit_u * 1e-21

    def commands(self, above: int) -> list[str]:
        """Commands of its own atoms, the first types."""
        types = " ".join([*self.elements, *["NULL"] * above])
        return [f"pair_coeff * * tersoff {FILE} {types}", *core_commands(self.network.cores, self.elements)]

    def tables(self) -> dict[str, str]:
        """The Tersoff potential."""
        return {FILE: tersoff_table(self.network.tersoff)}

    def make(self, edge_A: float, tiles: int, seed: int, work: Path, progress: Progress | None = None) -> Atoms:
        """A cell as wide as one of the oxide's glass, its height at zero pressure and 300 K; resumes in `work`.

        Raises
        ------
        InputError : its density or coordination is not that of the material's file.
        """
        segments = _segments()
        identity = {"network": self.material.model_dump(), "edge": edge_A, "seed": seed, "segments": segments}
        glass = run_segments(
            Workspace(work, identity, "glass.in"),
            self,
            self.elements,
            lambda: self._random_start(edge_A, seed),
            segments,
            1 + seed,
            TIMESTEP_FS,
            f"melt and quench of {self.material.name}",
            progress,
        )
        if reasons := self.faults(glass):
            raise InputError(f"{self.material.name}: {'; '.join(reasons)}; take another seed or a wider glass cell")
        return glass

    def make_atom_steps(self, edge_A: float, tiles: int) -> float:
        """Atoms times MD steps of `make`."""
        return (edge_A / 10) ** 3 * self.atoms_per_nm3 * sum(segment["steps"] for segment in _segments())

    def _random_start(self, edge_A: float, seed: int) -> Atoms:
        formula = self.material.formula
        units = max(1, round((edge_A / 10) ** 3 * self.atoms_per_nm3 / sum(formula.values())))
        counts = [units * count for count in formula.values()]
        rng = np.random.default_rng(np.random.SeedSequence([seed, 47]))
        cell = np.full(3, edge_A)
        places = random_places(sum(counts), cell, NEAREST_START_A, rng)
        return Atoms(self.elements, rng.permutation(np.repeat(np.arange(1, len(counts) + 1), counts)), places, cell)

    def properties(self, glass: Atoms) -> dict[str, float]:
        """Density (g/cm3), median bond of unlike atoms (Å), and the mean coordination of each element by them."""
        bonds, lengths_A = unlike_neighbours(glass, glass.types, self.network.cutoff_A)
        neighbours = np.bincount(bonds.ravel(), minlength=len(glass))
        return {
            "density_g_cm3": density_g_cm3(glass, self),
            "bond_A": float(np.median(lengths_A)),
            **{
                f"coordination_{element}": float(neighbours[glass.types == kind].mean())
                for kind, element in enumerate(glass.elements, 1)
            },
        }

    def faults(self, glass: Atoms) -> list[str]:
        """What of a glass is not as its material's file says."""
        measured, accepted = self.properties(glass), {"density_g_cm3": self.network.density_g_cm3}
        accepted |= {f"coordination_{element}": of for element, of in self.network.coordination.items()}
        return [
            f"{name} {measured[name]:.3g} outside {low:g} to {high:g}"
            for name, (low, high) in accepted.items()
            if not low <= measured[name] <= high
        ]


def _segments() -> list[dict[str, Any]]:
    """Melt and quench, as `run_segments` takes them: at constant volume, below `FREE_BELOW_K` the height is free."""
    parts = [
        ("nvt", 1.5 * MELT_K, MELT_K, 0.2 * MELT_PS),
        ("nvt", MELT_K, MELT_K, 0.8 * MELT_PS),
        ("nvt", MELT_K, FREE_BELOW_K, (MELT_K - FREE_BELOW_K) / QUENCH_K_PS),
        ("npt_height", FREE_BELOW_K, FINAL_K, (FREE_BELOW_K - FINAL_K) / QUENCH_K_PS),
        ("npt_height", FINAL_K, FINAL_K, REST_PS),
    ]
    return [
        {"ensemble": ensemble, "from": start, "to": end, "steps": round(1000 * duration_ps / TIMESTEP_FS)}
        for ensemble, start, end, duration_ps in parts
    ]
