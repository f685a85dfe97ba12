"""Structures of the elastic stage: crystals from files, silicon nitride by melt and quench.

Lengths in Å.  A glass cell is melted at the density of experiment and quenched with a Tersoff
potential and soft cores in LAMMPS, its shape free as soon as it is stiff.  At rest it must be a
network without symmetry in which (almost) every atom has its valence, and none that the ensemble
already has.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from ase import Atoms
from ase.data import atomic_numbers

from asperity.guards.errors import InputError
from atomistic.constants import AMU_PER_A3_IN_G_CM3
from atomistic.covalent import QUENCH, core_commands, random_places, tersoff_table
from atomistic.materials import SEARCHED_A, Material, NetworkGlass, Supercell
from atomistic.settings import NitrideGlassSettings


def crystal(material: Material, name: str, supercell: Supercell | None = None) -> Atoms:
    """A crystal of a material, repeated to `supercell`, by default to that of its file.

    Raises
    ------
    InputError
        if the material has no such crystal
    """
    from ase.build import make_supercell
    from ase.spacegroup import crystal as from_spacegroup

    known = material.crystals
    if name not in known:
        raise InputError(
            f"elastic.crystals: {material.name} has no crystal {name!r}; it has"
            f" {', '.join(known) or 'none'}"
        )
    data = known[name]
    repeats = np.array(supercell or data.supercell)
    symbols = []
    sites = []
    for element, places in data.sites.items():
        symbols += [element] * len(places)
        sites += places
    atoms = from_spacegroup(
        symbols,
        sites,
        spacegroup=data.spacegroup,
        setting=data.setting,
        cellpar=data.cell,
        primitive_cell=data.primitive,
    )
    atoms = make_supercell(atoms, np.diag(repeats) if repeats.ndim == 1 else repeats)
    atoms.wrap()
    return Atoms(
        atoms.get_chemical_symbols(), positions=atoms.positions, cell=atoms.cell.array, pbc=True
    )


@dataclass(frozen=True)
class NetworkVerdict:
    """Measured numbers of a structure and, if it failed, the reasons."""

    density_g_cm3: float
    coordination: dict[str, float]
    shortest_A: dict[str, float]
    bond_spread_A: float
    symmetry_operations: int
    defects: int
    reasons: tuple[str, ...]

    def columns(self) -> dict[str, Any]:
        """The numbers as columns of a table, in the order of its schema."""
        coordination = {f"coordination_{element}": n for element, n in self.coordination.items()}
        shortest = {f"shortest_{pair}_A": length for pair, length in self.shortest_A.items()}
        return {
            "density_g_cm3": self.density_g_cm3,
            **coordination,
            **shortest,
            "bond_spread_A": self.bond_spread_A,
            "symmetry_operations": self.symmetry_operations,
            "defects": self.defects,
        }


def examine(atoms: Atoms, criteria: NetworkGlass, max_defects: int | None = None) -> NetworkVerdict:
    """Hold density, coordination, shortest distances and symmetry against `criteria`.

    Parameters
    ----------
    criteria : the `network_glass` of a material
    max_defects : also reject a cell in which more atoms lack or exceed their valence
    """
    from ase.neighborlist import neighbor_list

    density = float(atoms.get_masses().sum() / atoms.get_volume() * AMU_PER_A3_IN_G_CM3)
    symbols = np.array(atoms.get_chemical_symbols())
    first, second, distance = neighbor_list("ijd", atoms, SEARCHED_A)
    unlike = symbols[first] != symbols[second]
    bonds = unlike & (distance < criteria.cutoff_A)
    counts = np.bincount(first[bonds], minlength=len(atoms))
    reasons = []
    low, high = criteria.density_g_cm3
    if not low <= density <= high:
        reasons.append(f"density {density:.2f} outside {low} to {high} g/cm3")
    coordination = {}
    for element, (low, high) in criteria.coordination.items():
        coordination[element] = 0.0
        if np.any(symbols == element):
            coordination[element] = float(counts[symbols == element].mean())
        if not low <= coordination[element] <= high:
            reasons.append(
                f"coordination of {element} {coordination[element]:.2f} outside {low} to {high}"
            )
    shortest = {}
    for pair, limit in criteria.shortest_A.items():
        a, b = pair.split("-")
        distances = distance[(symbols[first] == a) & (symbols[second] == b)]
        shortest[pair] = float(distances.min()) if len(distances) else SEARCHED_A
        if shortest[pair] < limit:
            reasons.append(f"{pair} distance {shortest[pair]:.2f} below {limit} A")
    valence = np.array([criteria.valence[symbol] for symbol in symbols])
    defects = int(np.sum(counts != valence))
    if max_defects is not None and defects > max_defects:
        reasons.append(f"{defects} atoms without their valence")
    spread = float(distance[bonds].std()) if bonds.any() else 0.0
    if spread < criteria.bond_spread_A:
        reasons.append(f"bond lengths spread by {spread:.3f} A only: crystalline")
    operations = symmetry_operations(atoms, criteria.symmetry_tolerance_A)
    if operations > 1:
        reasons.append(f"{operations} symmetry operations: a crystal")
    return NetworkVerdict(
        density, coordination, shortest, spread, operations, defects, tuple(reasons)
    )


def symmetry_operations(atoms: Atoms, tolerance_A: float) -> int:
    """Operations that map the cell onto itself within a tolerance; 1: the identity."""
    import spglib.error

    spglib.error.OLD_ERROR_HANDLING = False  # it shall raise
    cell: Any = (atoms.cell.array, atoms.get_scaled_positions(), atoms.numbers)
    try:
        symmetry: Any = spglib.get_symmetry_dataset(cell, tolerance_A)
    except spglib.error.SpglibError as error:
        if "too close" not in str(error):
            raise
        return 1  # atoms overlap: their distance is judged
    return len(symmetry.rotations)


def same_network(atoms: Atoms, accepted: Mapping[str, Atoms]) -> str | None:
    """Name of the first of `accepted` that is this cell again; None of a new one.

    A small cell has few good networks, so that independent quenches end in the same one.
    """
    from ase.utils.structure_comparator import SymmetryEquivalenceCheck

    comparison = SymmetryEquivalenceCheck()
    for name, other in accepted.items():
        if comparison.compare(atoms.copy(), other.copy()):
            return name
    return None


def no_insulator(gap_eV: float, criteria: NetworkGlass) -> list[str]:
    """Why a cell with this gap is no insulator; nothing where it is one, or without a gap (NaN)."""
    if gap_eV >= criteria.gap_eV:
        return []
    return [f"gap {gap_eV:.2f} eV: no insulator"]


def random_structure(
    formula: Mapping[str, int],
    units: int,
    density_g_cm3: float,
    seed: int,
    edges: Sequence[float] = (1, 1, 1),
) -> Atoms:
    """Formula units at random in a box of a density and edge ratio, none closer than 1.4 Å."""
    symbols = [element for element, n in formula.items() for _ in range(n * units)]
    atoms = Atoms(symbols, pbc=True)
    shape = np.asarray(edges, float)
    volume_A3 = atoms.get_masses().sum() * AMU_PER_A3_IN_G_CM3 / density_g_cm3
    edge = shape * (volume_A3 / shape.prod()) ** (1 / 3)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 5]))
    atoms.set_cell(edge)
    atoms.positions = random_places(len(symbols), edge, QUENCH.start_distance_A, rng)
    return atoms


def make_glass(
    material: Material,
    settings: NitrideGlassSettings,
    seed: int,
    work: Path,
    progress: Callable[[float, str], None] | None = None,
    accepted: Mapping[str, Atoms] | None = None,
) -> tuple[Atoms, list[dict[str, Any]]]:
    """Melt and quench until a cell passes the gates.

    Parameters
    ----------
    seed : of the structure; attempt k has its own stream
    work : a directory for LAMMPS
    others : cells the ensemble already has, by name; none of them is made once more

    Returns
    -------
    The first cell that passes, or the last one tried, and one row per attempt with its numbers and
    verdict.
    """
    attempts: list[dict[str, Any]] = []
    atoms = Atoms()
    network = material.part("network_glass")
    for attempt in range(QUENCH.attempts):
        if progress:
            progress(attempt / QUENCH.attempts, f"melt and quench, attempt {attempt + 1}")
        state = np.random.SeedSequence([seed, attempt]).generate_state(1)
        quench_seed = int(state[0] % 900_000_000) + 1
        atoms = quench(material, settings, quench_seed, work)
        verdict = examine(atoms, network, settings.max_defects)
        reasons = verdict.reasons
        if not reasons and (copied := same_network(atoms, accepted or {})):
            reasons = (f"the network of {copied} again",)
        status = "accepted"
        if reasons:
            status = "rejected: " + "; ".join(reasons)
        attempts.append({"attempt": attempt, **verdict.columns(), "status": status})
        if not reasons:
            break
    return atoms, attempts


def quench(material: Material, settings: NitrideGlassSettings, seed: int, work: Path) -> Atoms:
    """One melt and quench, then ions and cell at rest together (LAMMPS, `protocols/nitride.in`).

    Down to `QUENCH.free_below_K` the volume is constant; below it volume and shape follow a
    pressure of zero.  In the box of the melt a network is left under up to 30 GPa of shear stress,
    and slides far when it is let go.
    """
    from ase.io import read

    from atomistic.lammps import Atoms as LammpsAtoms
    from atomistic.lammps import LammpsFolder, run_lammps, write_data

    elements = tuple(material.formula)
    network: NetworkGlass = material.part("network_glass")
    start = random_structure(
        material.formula, settings.formula_units, network.start_density_g_cm3, seed, network.edges
    )
    symbols = start.get_chemical_symbols()
    types = np.array([elements.index(symbol) + 1 for symbol in symbols])
    identity = {
        "seed": seed,
        "settings": settings.model_dump(),
        "tersoff": network.tersoff.model_dump(),
        "cores": {pair: core.model_dump() for pair, core in network.cores.items()},
    }
    workspace = LammpsFolder(work, identity, "nitride.in")
    (workspace / "potential.tersoff").write_text(tersoff_table(network.tersoff), encoding="utf-8")
    (workspace / "cores.in").write_text(
        "\n".join(core_commands(network.cores, elements)) + "\n", encoding="utf-8"
    )
    placed = LammpsAtoms(elements, types, start.positions, np.diag(start.cell.array))
    write_data(workspace / "start.data", placed, network.masses_u)
    steps_per_ps = 1000 / QUENCH.timestep_fs
    steps_per_K = steps_per_ps / QUENCH.rate_K_ps
    variables = {
        "elements": " ".join(elements),
        "seed": seed,
        "timestep": QUENCH.timestep_fs / 1000,
        "melt": QUENCH.melt_K,
        "free": QUENCH.free_below_K,
        "final": QUENCH.final_K,
        "melt_steps": round(QUENCH.melt_ps * steps_per_ps),
        "quench_steps": round((QUENCH.melt_K - QUENCH.free_below_K) * steps_per_K),
        "free_steps": round((QUENCH.free_below_K - QUENCH.final_K) * steps_per_K),
    }
    run_lammps("nitride.in", workspace, variables)
    numbers = {kind: atomic_numbers[element] for kind, element in enumerate(elements, 1)}
    quenched: Any = read(
        workspace / "glass.data", format="lammps-data", atom_style="atomic", Z_of_type=numbers
    )
    workspace.remove()
    return Atoms(
        quenched.get_chemical_symbols(),
        positions=quenched.positions,
        cell=quenched.cell.array,
        pbc=True,
    )
