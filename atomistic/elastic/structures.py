"""The amorphous structures of the ensemble: relaxed, judged and listed."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from ase import Atoms
from ase.calculators.calculator import Calculator

from atomistic.elastic.moduli import Modulus
from atomistic.elastic.networks import Gate, examine, no_insulator
from atomistic.elastic.relaxation import UNTOUCHED, Progress, Relaxation, relax_glass
from atomistic.materials import NetworkGlass
from atomistic.settings import RelaxationSettings


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
    settings: RelaxationSettings,
    refused: str = "",
    progress: Progress | None = None,
) -> Structure:
    """Relax a quenched cell and judge the result; a cell that no quench made right is not relaxed at all.

    Parameters
    ----------
    criteria : the `network_glass` of a material
    make_calculator : called only if the cell is relaxed
    refused : why the quenched cell was rejected; empty if it was accepted
    """
    if refused:
        return Structure(quenched, None, examine(quenched, criteria), UNTOUCHED, (refused,))
    calculator = make_calculator()
    atoms, done = relax_glass(quenched, calculator, settings, progress)
    verdict = examine(atoms, criteria)
    reasons = [*verdict.reasons, *filter(None, [done.failure]), *no_insulator(done.gap_eV, criteria)]
    return Structure(atoms, calculator, verdict, done, tuple(reasons))


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
            moduli.append(Modulus(row["structure"], row["xc"], row["ions"], B, not reasons, "; ".join(reasons), error))
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
