"""The amorphous structures of the ensemble: relaxed, judged and listed."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from ase import Atoms
from ase.calculators.calculator import CalculationFailed, Calculator

from atomistic.elastic.moduli import Modulus
from atomistic.elastic.networks import NetworkVerdict, examine, no_insulator
from atomistic.elastic.relaxation import Relaxation, relax_ions, strained
from atomistic.lammps import Progress
from atomistic.materials import NetworkGlass


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
    verdict: NetworkVerdict
    relaxation: Relaxation
    reasons: tuple[str, ...]

    def report(self, name: str) -> dict[str, Any]:
        """What elastic/structures/NAME.json says."""
        return {
            "structure": name,
            "atoms": len(self.atoms),
            **self.verdict.columns(),
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
    """Relax the ions of a quenched cell and judge it; a cell that no quench made right stays.

    The cell keeps shape and size: its volume is found by the E(V) scan, stress anisotropy is left
    in it.

    Parameters
    ----------
    criteria : the `network_glass` of a material
    make_calculator : called only if the cell is relaxed
    refused : why the quenched cell was rejected; empty if it was accepted
    """
    if refused:
        return Structure(quenched, None, examine(quenched, criteria), Relaxation(), (refused,))
    calculator = make_calculator()
    atoms = strained(quenched, 0.0)
    atoms.calc = calculator
    done = Relaxation()
    if progress:
        progress(0.0, f"relaxing ions, at most {max_steps} steps")
    if max_steps:
        try:
            # eV/Å, largest force left before the E(V) scan
            done = relax_ions(atoms, 0.3, max_steps)
        except CalculationFailed as error:
            done = Relaxation(failure=f"relaxation: {error}")
    atoms = strained(quenched if done.failure else atoms, 0.0)
    verdict = examine(atoms, criteria)
    failures = [done.failure] if done.failure else []
    reasons = [*verdict.reasons, *failures, *no_insulator(done.gap_eV, criteria)]
    return Structure(atoms, calculator, verdict, done, tuple(reasons))


def trusted_moduli(
    fits: Sequence[Mapping[str, str]], reports: Sequence[Mapping[str, Any]]
) -> list[Modulus]:
    """Bulk moduli of the ensemble, trusted if a fit has no flag and its structure passed.

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
            why = "; ".join(reasons)
            moduli.append(Modulus(row["structure"], row["xc"], B, not reasons, why, error))
    return moduli


NESTED = ("relaxation", "gate", "provenance")
"""Entries of a report that are no columns of a table."""


def structure_rows(
    reports: Sequence[Mapping[str, Any]], quenches: Sequence[int]
) -> list[dict[str, Any]]:
    """Rows of elastic/structures.csv from the structures' reports and numbers of quenches."""
    rows = []
    for report, count in zip(reports, quenches, strict=True):
        row = {key: value for key, value in report.items() if key not in NESTED}
        row |= report["relaxation"]
        row["quenches"] = count
        row["status"] = "accepted"
        if not report["gate"]["passed"]:
            row["status"] = "rejected: " + "; ".join(report["gate"]["reasons"])
        rows.append(row)
    return rows
