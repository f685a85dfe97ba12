"""Rigid-ion pair potentials read from data files, checked, and written as LAMMPS tables.

All terms of a pair, Coulomb included, go into one table: 3-5 times faster than the sum of their own
pair styles, and its twin with all energies halved is the same table times one half.
"""

import io
from collections.abc import Callable, Mapping
from functools import cached_property, partial
from itertools import combinations_with_replacement
from pathlib import Path
from typing import Annotated, Literal, Protocol

import numpy as np
from pydantic import Field
from scipy.special import erfc

from asperity.guards.errors import InputError
from asperity.guards.settings import Settings, load_settings
from atomistic.constants import COULOMB_EV_A

TABLE_START_A = 0.4  # atoms nearer than this stop LAMMPS

Confidence = Literal["high", "medium", "low"]
Positive = Annotated[float, Field(gt=0)]
# names stand in LAMMPS's commands, where $(...), ${...} or a new line would be evaluated
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,19}$")]


class _Sourced(Settings):
    source: str
    confidence: Confidence


class Morse(_Sourced):
    """D {[1 - exp(-a (r - r0))]^2 - 1}."""

    term: Literal["morse"]
    D_eV: Positive
    a_1_per_A: Positive
    r0_A: Positive

    def energy_and_slope(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        decay = np.exp(-self.a_1_per_A * (r - self.r0_A))
        energy = self.D_eV * ((1 - decay) ** 2 - 1)
        slope = 2 * self.D_eV * self.a_1_per_A * (1 - decay) * decay
        return energy, slope


class Power(_Sourced):
    """C / r^n."""

    term: Literal["power"]
    C_eV_A_n: Positive
    n: int = Field(ge=1, le=36)

    def energy_and_slope(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        energy = self.C_eV_A_n / r**self.n
        return energy, -self.n * energy / r


class Buckingham(_Sourced):
    """A exp(-r / rho) - C / r^6."""

    term: Literal["buckingham"]
    A_eV: Positive
    rho_A: Positive
    C_eV_A6: float = Field(ge=0)

    def energy_and_slope(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        repulsion = self.A_eV * np.exp(-r / self.rho_A)
        dispersion = self.C_eV_A6 / r**6
        return repulsion - dispersion, -repulsion / self.rho_A + 6 * dispersion / r


class Pair(Settings):
    """All short-range terms between two species."""

    species: tuple[Name, Name]
    terms: tuple[Annotated[Morse | Power | Buckingham, Field(discriminator="term")], ...] = Field(
        min_length=1
    )


class Species(_Sourced):
    """An ion."""

    charge_e: float
    mass_u: Positive
    mass_source: str


class Coulomb(_Sourced):
    """Damped shifted-force Coulomb sum (Fennell and Gezelter 2006)."""

    method: Literal["dsf"]
    damping_1_per_A: float = Field(ge=0, le=1)


class Source(Settings):
    """Where numbers come from; doi is null for what was added here."""

    citation: str
    doi: str | None


class AreaCalibration(Settings):
    """How the contact area's definition was tested on known sections of a potential's glass.

    Attributes
    ----------
    error : largest deviation from the known area, as a fraction.
    """

    error: float = Field(ge=0, le=0.1)
    source: str


class Potential(Settings):
    """A rigid-ion potential; energies in eV, distances in Å."""

    name: str
    description: str
    sources: dict[str, Source]
    species: dict[Name, Species]
    coulomb: Coulomb
    cutoff_A: float = Field(ge=4, le=20)
    materials: dict[Name, dict[Name, int]]
    pairs: tuple[Pair, ...]
    contact_area: AreaCalibration | None = None

    @cached_property
    def _terms(self) -> dict[frozenset[str], Pair]:
        return {frozenset(pair.species): pair for pair in self.pairs}

    @property
    def masses_u(self) -> dict[str, float]:
        """Mass of each element."""
        return {name: ion.mass_u for name, ion in self.species.items()}

    def energy_and_force(
        self, first: str, second: str, r: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Energy (eV) and force (eV/Å, positive = repulsion) of a pair at distances `r` (Å).

        Short-range terms are shifted so that energy and force vanish at the cutoff, as the damped
        Coulomb sum does by construction: no jump, so energy is conserved.
        """
        r = np.asarray(r, dtype=float)
        r_c = np.array([self.cutoff_A])
        energy, force = self._coulomb(first, second, r)
        for term in self._terms[frozenset((first, second))].terms:
            value, slope = term.energy_and_slope(r)
            value_c, slope_c = term.energy_and_slope(r_c)
            energy = energy + value - value_c - slope_c * (r - r_c)
            force = force - (slope - slope_c)
        return np.where(r < r_c, energy, 0.0), np.where(r < r_c, force, 0.0)

    def _coulomb(self, first: str, second: str, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        alpha, r_c = self.coulomb.damping_1_per_A, self.cutoff_A
        strength = COULOMB_EV_A * self.species[first].charge_e * self.species[second].charge_e

        def bare(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            screened = erfc(alpha * x) / x
            gaussian = np.exp(-((alpha * x) ** 2))
            return screened, screened / x + 2 * alpha / np.sqrt(np.pi) * gaussian / x

        value, force = bare(r)
        value_c, force_c = bare(np.array([r_c]))
        return strength * (value - value_c + force_c * (r - r_c)), strength * (force - force_c)

    def table(self, elements: tuple[str, ...], energy_scale: float = 1.0) -> str:
        """LAMMPS `pair_style table` file: a section A_B per pair of `elements`, and `contact`.

        Parameters
        ----------
        elements : species in the order of their LAMMPS types.
        energy_scale : factor on every energy and force; 0.5 gives the twin with halved energies.
        """
        title = f"{' '.join(self.description.split())}; energies x {energy_scale}"
        sections: dict[str, EnergyAndForce] = {}
        for first, second in combinations_with_replacement(elements, 2):
            sections[f"{first}_{second}"] = partial(self.energy_and_force, first, second)
        return pair_table(title, sections, self.cutoff_A, energy_scale)

    def files(self, elements: tuple[str, ...], energy_scale: float) -> dict[str, str]:
        """What LAMMPS needs, by file name: the table, and in `pairs` the commands that use it.

        Parameters
        ----------
        elements : of each LAMMPS type.
        """
        lines = ["pair_style table linear 4000"]
        for i, first in enumerate(elements, 1):
            for j, second in enumerate(elements[i - 1 :], i):
                lines.append(f"pair_coeff {i} {j} table {first}_{second} {self.cutoff_A}")
        lines += ["neighbor 0.6 bin", "neigh_modify every 2 delay 0 check yes"]
        return {"table": self.table(elements, energy_scale), "pairs": "\n".join(lines) + "\n"}


class ForceField(Protocol):
    """What molecular dynamics uses of a `Potential`: a metal or a stack has it too."""

    @property
    def masses_u(self) -> Mapping[str, float]:
        """Mass of each element."""
        ...

    def files(self, elements: tuple[str, ...], energy_scale: float) -> dict[str, str]:
        """Files for LAMMPS by name."""
        ...


EnergyAndForce = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


def pair_table(
    title: str, sections: Mapping[str, EnergyAndForce], cutoff_A: float, energy_scale: float
) -> str:
    """LAMMPS `pair_style table` file of these sections and of `contact`.

    Parameters
    ----------
    sections : energy (eV) and force (eV/Å) at distances (Å), by name.
    energy_scale : factor on all of them.
    """
    points = 4000
    r = np.sqrt(np.linspace(TABLE_START_A**2, cutoff_A**2, points))
    lines = io.StringIO()
    lines.write(f"# {title}; eV, Angstrom\n")
    for name, law in {**sections, "contact": contact_energy_and_force}.items():
        energy, force = law(r)
        lines.write(f"\n{name}\nN {points} RSQ {TABLE_START_A} {cutoff_A}\n\n")
        rows = np.column_stack(
            [np.arange(1, points + 1), r, energy_scale * energy, energy_scale * force]
        )
        np.savetxt(lines, rows, fmt="%d %.12g %.12g %.12g")
    return lines.getvalue()


def contact_energy_and_force(r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Repulsion (eV, eV/Å) of atoms that only repel each other: 12-6 cut at its minimum (WCA).

    The radius of 3 Å is about the O-O distance across an interface.
    """
    radius_A, depth_eV = 3.0, 0.1
    x = (radius_A / r) ** 6
    energy = depth_eV * (x**2 - 2 * x + 1)
    force = 12 * depth_eV * (x**2 - x) / r
    return np.where(r < radius_A, energy, 0.0), np.where(r < radius_A, force, 0.0)


def load_potential(path: str | Path) -> Potential:
    """Read and check a potential file.

    Raises
    ------
    InputError : unreadable or malformed file, missing pair, unknown species or source, charged
        formula unit, or a pair without a repulsive core.
    """
    path = Path(path)
    potential = load_settings(Potential, path, "potential", "config/potentials/pmmcs.yaml")
    _check(path, potential)
    return potential


def _check(path: Path, potential: Potential) -> None:
    named = {potential.coulomb.source}
    for ion in potential.species.values():
        named |= {ion.source, ion.mass_source}
    for pair in potential.pairs:
        named |= {term.source for term in pair.terms}
    if unknown := sorted(named - set(potential.sources)):
        raise InputError(f"{path}: source {unknown[0]!r} is used but not listed under `sources`")
    seen: set[frozenset[str]] = set()
    for pair in potential.pairs:
        label = "-".join(pair.species)
        if set(pair.species) - set(potential.species):
            raise InputError(
                f"{path}: pair {label} names a species that is not listed under `species`"
            )
        if frozenset(pair.species) in seen:
            raise InputError(f"{path}: pair {label} stands twice; keep one")
        seen.add(frozenset(pair.species))
    for first, second in combinations_with_replacement(potential.species, 2):
        if frozenset((first, second)) not in seen:
            raise InputError(
                f"{path}: pair {first}-{second} is missing; add its terms under `pairs`"
            )
    for name, formula in potential.materials.items():
        if set(formula) - set(potential.species):
            raise InputError(
                f"{path}: material {name} names a species that is not listed under `species`"
            )
        charge = sum(count * potential.species[ion].charge_e for ion, count in formula.items())
        if abs(charge) > 1e-9:
            raise InputError(
                f"{path}: material {name} has charge {charge:+g} e per formula unit; it must be"
                " neutral"
            )
    core_A = 0.9  # below this every pair must repel; the shortest bond (Si-O) is 1.6 A
    r = np.linspace(TABLE_START_A, core_A, 200)
    for first, second in combinations_with_replacement(potential.species, 2):
        _, force = potential.energy_and_force(first, second, r)
        if np.any(force <= 0):
            raise InputError(
                f"{path}: pair {first}-{second} attracts at {r[force <= 0].max():.2f} A: "
                f"it needs a repulsive core (add a `power` term) below {core_A} A"
            )
