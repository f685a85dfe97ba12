"""Elastic constants of the structures of an ensemble at rest, and the isotropic moduli that follow."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from ase import Atoms
from ase.calculators.calculator import CalculationFailed, Calculator

from atomistic.constants import AMU_PER_A3_IN_G_CM3
from atomistic.elastic.dft import TwoMeshes
from atomistic.elastic.moduli import IONS
from atomistic.elastic.networks import examine, no_insulator, same_network
from atomistic.elastic.relaxation import Rest, last_gap_eV, relax_cell, strained
from atomistic.elastic.response import Response, elastic_response
from atomistic.elastic.tensor import isotropic
from atomistic.errors import InputError
from atomistic.materials import NetworkGlass

Progress = Callable[[float, str], None]

FORCE_EV_A = 0.1  # largest force left when ions and cell relax before
MAX_STEPS = 80  # of that relaxation, on one mesh and again on both; glasses take 6 to 59
ROUGH = 3.0  # times the largest force left: so far one of two meshes serves, at half the cost; its ripple is as large
MOST_ESTIMATED = 0.2  # of a constant: a third of the estimate may be wrong, so 7 % of the constant


class Measured(NamedTuple):
    """Elastic constants of a structure at rest, or why there are none.

    Attributes
    ----------
    atoms : ions and cell as they came to rest
    doubts : why a cell at rest is no insulating glass any more
    """

    atoms: Atoms
    rest: Rest | None
    response: Response | None
    failure: str
    doubts: tuple[str, ...] = ()

    def report(self, name: str) -> dict[str, Any]:
        """What elastic/tensors/NAME.json says; GPa in Voigt's order xx, yy, zz, yz, xz, xy."""
        constants, rest = self.response, self.rest
        return {
            "structure": name,
            "atoms": len(self.atoms),
            "density_g_cm3": float(self.atoms.get_masses().sum() / self.atoms.get_volume() * AMU_PER_A3_IN_G_CM3),
            "steps": rest.steps if rest else 0,
            "force_left_eV_A": rest.force_left_eV_A if rest else None,
            "calculations": constants.calculations if constants else 0,
            "softest_eV_A2": constants.softest_eV_A2 if constants else None,
            "stress_left_GPa": constants.clamped.stress.tolist() if constants else None,
            "error_GPa": float(constants.clamped.error.max()) if constants else None,
            "still_softer_GPa": constants.relaxed_left.tolist() if constants else None,
            "C_clamped_GPa": constants.clamped.C.tolist() if constants else None,
            "C_relaxed_GPa": constants.relaxed.tolist() if constants else None,
            "failure": self.failure,
            "doubts": list(self.doubts),
        }


def measure_constants(
    atoms: Atoms,
    calculator: Calculator,
    progress: Progress | None = None,
    criteria: NetworkGlass | None = None,
    force_eV_A: float = FORCE_EV_A,
    max_steps: int = MAX_STEPS,
    **response: Any,
) -> Measured:
    """Relax ions and cell, then elastic constants; whatever fails costs this structure only and is named.

    Parameters
    ----------
    criteria : what a glass should still fulfil when its cell has come to rest; None for a crystal
    response : numerical choices of `elastic_response`
    """
    atoms = strained(atoms, 0.0)
    sides = calculator.sides if isinstance(calculator, TwoMeshes) else (calculator, calculator)
    rest, doubts = None, ()
    try:
        rest = _relax(atoms, calculator, force_eV_A, max_steps)
        if not rest.converged:
            left = f"{rest.force_left_eV_A:.2f} eV/A left on an atom"
            return Measured(atoms, rest, None, f"ions and cell not at rest after {rest.steps} steps, {left}")
        doubts = _no_glass(atoms, calculator, criteria) if criteria else ()
        constants = elastic_response(atoms, sides, rest.hessian_eV_A2, progress=progress, **response)
    except (CalculationFailed, NotImplementedError, InputError, np.linalg.LinAlgError, FloatingPointError) as error:
        return Measured(atoms, rest, None, str(error), doubts)
    return Measured(atoms, rest, constants, "", doubts)


def _no_glass(atoms: Atoms, calculator: Calculator, criteria: NetworkGlass) -> tuple[str, ...]:
    """Why a cell at rest is no insulating glass: without the stress of its box it may have turned into a crystal."""
    return (*examine(atoms, criteria).reasons, *no_insulator(last_gap_eV(calculator), criteria))


def _relax(atoms: Atoms, calculator: Calculator, force_eV_A: float, max_steps: int) -> Rest:
    """Ions and cell at rest; of two meshes the first goes ahead as far as its ripple lets it."""
    before, hessian = 0, None
    if isinstance(calculator, TwoMeshes):
        atoms.calc = calculator.sides[0]
        rough = relax_cell(atoms, ROUGH * force_eV_A, max_steps)
        if not rough.converged:
            return rough
        before, hessian = rough.steps, rough.hessian_eV_A2
    atoms.calc = calculator
    rest = relax_cell(atoms, force_eV_A, max_steps, hessian)
    return rest._replace(steps=before + rest.steps)


def isotropic_rows(report: Mapping[str, Any], copied: str | None = None) -> list[dict[str, Any]]:
    """Rows of elastic/isotropic_moduli.csv of one structure, clamped and relaxed, from its `Measured.report`.

    Parameters
    ----------
    copied : the structure that this one is once more at rest; it counts once
    """
    rows = []
    for ions in IONS:
        flags = [*filter(None, [report["failure"], copied and f"at rest it is {copied} again"])]
        values = dict.fromkeys(("B_GPa", "G_GPa", "E_GPa", "nu", "B_error_GPa", "G_error_GPa"))
        if not report["failure"]:
            if ions == "relaxed":
                flags += _resting_on_estimates(report)
            try:
                mean = isotropic(np.array(report[f"C_{ions}_GPa"]))
                values = dict(zip(values, (mean.B, mean.G, mean.E, mean.nu, mean.B_error, mean.G_error), strict=True))
            except InputError as error:
                flags.append(str(error))
        head = {key: report[key] for key in ("structure", "atoms", "density_g_cm3")}
        rows.append({**head, "ions": ions, **values, "flags": "; ".join(flags), "doubts": "; ".join(report["doubts"])})
    return rows


def isotropic_table(measured: Iterable[tuple[Mapping[str, Any], Atoms]]) -> list[dict[str, Any]]:
    """Rows of elastic/isotropic_moduli.csv; a network in which several cells come to rest counts once.

    Parameters
    ----------
    measured : of each structure its `Measured.report` and its cell at rest
    """
    rows: list[dict[str, Any]] = []
    known: dict[str, Atoms] = {}
    for report, atoms in measured:
        rows += isotropic_rows(report, same_network(atoms, known))
        if not report["failure"]:
            known[report["structure"]] = atoms
    return rows


def _resting_on_estimates(report: Mapping[str, Any]) -> list[str]:
    """What to say of the first constant whose softening by the ions is estimated for a large part, if there is one."""
    names = ("C11", "C22", "C33", "C44", "C55", "C66")
    for name, value, left in zip(names, np.diag(report["C_relaxed_GPa"]), report["still_softer_GPa"], strict=True):
        if left > MOST_ESTIMATED * abs(value):
            return [f"{name} of {value:.0f} GPa rests on an estimate of {left:.0f} GPa"]
    return []
