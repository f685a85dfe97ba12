"""The amorphous structures of the ensemble: relaxed, judged and listed."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from ase import Atoms
from ase.calculators.calculator import CalculationFailed, Calculator

from atomistic.elastic.moduli import Modulus
from atomistic.elastic.networks import Gate, examine, no_insulator
from atomistic.elastic.relaxation import last_gap_eV, relax_ions, strained
from atomistic.materials import NetworkGlass

Progress = Callable[[float, str], None]
FORCE_EV_A = 0.3  # largest force left on an atom before the E(V) scan


@dataclass(frozen=True)
class Relaxation:
    """What the relaxation of a glass did; by default nothing.

    Attributes
    ----------
    steps : ionic steps
    force_left_eV_A, converged : largest force left, and whether that met the goal
    energy_gained_eV : below the quenched cell
    gap_eV : between the highest occupied and the lowest empty level at the end; NaN if the engine does not tell
    failure : why a calculation failed; the ions are then those of the quenched glass
    """

    steps: int = 0
    force_left_eV_A: float = float("nan")
    converged: bool = False
    energy_gained_eV: float = 0.0
    gap_eV: float = float("nan")
    failure: str = ""


@dataclass(frozen=True)
class Structure:
    """A cell after its relaxation, Å.

    Attributes
    ----------
    calculator : as it ended; None where the quenched cell was rejected and nothing was calculated
    verdict : on the relaxed cell, or on the quenched one that was rejected
    reasons : why the structure does not enter E*; empty for a good one
    """

    atoms: Atoms
    calculator: Calculator | None
    verdict: Gate
    relaxation: Relaxation
    reasons: tuple[str, ...]

    def report(self, name: str) -> dict[str, Any]:
        """What elastic/structures/NAME.json says."""
        return {
            "structure": name,
            "atoms": len(self.atoms),
            "density_g_cm3": self.verdict.density_g_cm3,
            **{f"coordination_{element}": value for element, value in self.verdict.coordination.items()},
            "defects": self.verdict.defects,
            "bond_spread_A": self.verdict.bond_spread_A,
            "symmetry_operations": self.verdict.symmetry_operations,
            "relaxation": asdict(self.relaxation),
            "gate": {"passed": not self.reasons, "reasons": list(self.reasons)},
        }


def relaxed_structure(
    quenched: Atoms,
    criteria: NetworkGlass,
    make_calculator: Callable[[], Calculator],
    max_steps: int,
    refused: str = "",
    progress: Progress | None = None,
) -> Structure:
    """Relax the ions of a quenched cell and judge the result; a cell that no quench made right is not relaxed at all.

    The cell keeps shape and size: its volume is found by the E(V) scan, stress anisotropy is left in it.

    Parameters
    ----------
    criteria : the `network_glass` of a material
    make_calculator : called only if the cell is relaxed
    refused : why the quenched cell was rejected; empty if it was accepted
    """
    if refused:
        return Structure(quenched, None, examine(quenched, criteria), Relaxation(), (refused,))
    calculator, atoms = make_calculator(), strained(quenched, 0.0)
    done = _relax(atoms, calculator, max_steps, progress) if max_steps else Relaxation()
    atoms = strained(quenched if done.failure else atoms, 0.0)
    verdict = examine(atoms, criteria)
    reasons = [*verdict.reasons, *filter(None, [done.failure]), *no_insulator(done.gap_eV, criteria)]
    return Structure(atoms, calculator, verdict, done, tuple(reasons))


def _relax(atoms: Atoms, calculator: Calculator, max_steps: int, progress: Progress | None) -> Relaxation:
    """Move the ions to rest, in as many steps as there may be."""
    atoms.calc = calculator
    if progress:
        progress(0.0, f"relaxing ions, at most {max_steps} steps")
    try:
        atoms.get_forces()  # asked for first, so that the energy comes from the same calculation
        before = atoms.get_potential_energy()
        rest = relax_ions(atoms, FORCE_EV_A, max_steps)
        gained = float(before - atoms.get_potential_energy())
    except CalculationFailed as error:
        return Relaxation(failure=f"relaxation: {error}")
    return Relaxation(rest.steps, rest.force_left_eV_A, rest.converged, gained, last_gap_eV(calculator))


def trusted_moduli(fits: Sequence[Mapping[str, str]], reports: Sequence[Mapping[str, Any]]) -> list[Modulus]:
    """The bulk moduli of the ensemble, each trusted if its fit has no flag and its structure passed its gate.

    Parameters
    ----------
    fits : rows of elastic/bulk_moduli.csv; crystals among them anchor the engine and are left out
    reports : of the amorphous structures (`Structure.report`)
    """
    gates = {report["structure"]: report["gate"] for report in reports}
    moduli = []
    for row in fits:
        if row["structure"] in gates:
            reasons = [*filter(None, [row["flags"]]), *gates[row["structure"]]["reasons"]]
            B = float(row["B_GPa"] or "nan")
            error = float(row["B_error_GPa"] or "nan")
            moduli.append(Modulus(row["structure"], row["xc"], B, not reasons, "; ".join(reasons), error))
    return moduli


def structure_rows(reports: Sequence[Mapping[str, Any]], quenches: Sequence[int]) -> list[dict[str, Any]]:
    """Rows of elastic/structures.csv from the structures' reports and the number of quenches each one took."""
    return [
        {
            "structure": report["structure"],
            "atoms": report["atoms"],
            "density_g_cm3": report["density_g_cm3"],
            **{key: value for key, value in report.items() if key.startswith("coordination_")},
            "defects": report["defects"],
            "bond_spread_A": report["bond_spread_A"],
            "symmetry_operations": report["symmetry_operations"],
            **report["relaxation"],
            "quenches": count,
            "status": "accepted" if report["gate"]["passed"] else "rejected: " + "; ".join(report["gate"]["reasons"]),
        }
        for report, count in zip(reports, quenches, strict=True)
    ]
