"""Covalent networks for LAMMPS: Tersoff potential, soft cores between like atoms, random starts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from atomistic.materials import Core, Tersoff


@dataclass(frozen=True)
class Quench:
    """How a cell is melted and quenched; a glass below films takes the same temperatures."""

    start_distance_A: float = 1.4
    """In a random start nothing is closer."""

    melt_K: float = 5000.0
    """Of the melt."""

    melt_ps: float = 3.0
    """Of the melt."""

    final_K: float = 300.0
    """Of the glass."""

    rate_K_ps: float = 300.0
    """Of the cooling."""

    free_below_K: float = 2500.0
    """A melt has no shape to keep; below this its network still settles as a glass."""

    timestep_fs: float = 1.0
    """Of the molecular dynamics."""

    attempts: int = 1000
    """Quenches until one passes the gates; of 28 atoms about one in sixty does."""


QUENCH = Quench()


def tersoff_table(parameters: Tersoff) -> str:
    """Tersoff parameters in the format of LAMMPS (and ASE), one line per triplet.

    A pair's own parameters come from the mixing rules of Tersoff, PRB 39, 5566 (1989); `chi` scales
    the attraction of unlike (and, if given, like) pairs.  The cutoff of a triplet i j k is that of
    i–k.
    """
    elements = parameters.elements
    chi = {frozenset(pair.split("-")): value for pair, value in parameters.chi.items()}
    lines = ["# m gamma lambda3 c d costheta0 n beta lambda2 B R D lambda1 A"]
    for i, j, k in product(elements, repeat=3):
        p = elements[i]
        q = elements[j]
        r = elements[k]
        inner = np.sqrt(p.R * r.R)
        outer = np.sqrt(p.S * r.S)
        strength = chi.get(frozenset((i, j)), 1.0)
        attraction = np.sqrt(p.B * q.B) * strength
        numbers = [3, 1, 0, p.c, p.d, p.h, p.n, p.beta, (p.mu + q.mu) / 2, attraction]
        numbers += [(inner + outer) / 2, (outer - inner) / 2]
        numbers += [(p.lambda_ + q.lambda_) / 2, np.sqrt(p.A * q.A)]
        lines.append(" ".join([i, j, k, *(f"{float(x):.10g}" for x in numbers)]))
    return "\n".join(lines) + "\n"


def core_commands(cores: Mapping[str, Core], elements: Sequence[str]) -> list[str]:
    """Commands of the soft cores k (r_c − r)², for elements in the order of their LAMMPS types."""
    lines = []
    for pair, core in cores.items():
        i, j = sorted(1 + elements.index(element) for element in pair.split("-"))
        lines.append(f"pair_coeff {i} {j} harmonic/cut {core.k_eV_A2} {core.r_A}")
    return lines


def random_places(
    number: int, edges_A: np.ndarray, nearest_A: float, rng: np.random.Generator
) -> np.ndarray:
    """Places in a periodic box, no two nearer than `nearest_A`; shape (number, 3), Å."""
    placed = np.empty((number, 3))
    for k in range(number):
        while True:
            trial = rng.uniform(0, edges_A, 3)
            apart = placed[:k] - trial
            apart -= edges_A * np.round(apart / edges_A)
            if not np.any(np.einsum("ij,ij->i", apart, apart) < nearest_A**2):
                break
        placed[k] = trial
    return placed
