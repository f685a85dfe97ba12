"""Hard cases for the engine of a scene: what it cannot compute is refused or flagged, never a plausible number."""

from collections.abc import Callable
from functools import partial

import numpy as np
from ase import Atoms
from ase.build import bulk
from ase.calculators.calculator import CalculationFailed

from atomistic.elastic.dft import make_calculator
from atomistic.elastic.energy_scans import scan_volumes
from atomistic.elastic.equation_of_state import fit_equation_of_state
from atomistic.elastic.networks import no_insulator
from atomistic.elastic.relaxation import last_gap_eV, strained
from atomistic.materials import NetworkGlass
from atomistic.settings import DftSettings

Verdict = tuple[bool, str]
Check = tuple[str, str, str, Callable[[], Verdict]]
NARROW = (-0.05, -0.025, 0.0, 0.025, 0.05)
WIDE = (-0.1, -0.075, *NARROW, 0.075, 0.1)
MAX_WIDE = 0.03  # of B: what five more per cent of strain may change
LEAST_RISE_EV = 1.0  # per atom, of a cell that has collapsed


def wide_strain(cell: Atoms, dft: DftSettings) -> Verdict:
    """Linear strain of 10 % in place of 5 %."""
    calculator = make_calculator(dft, "GGA", cell.cell.array * (1 + max(WIDE)))
    points = [point for point in scan_volumes(cell, calculator, WIDE) if point.converged]
    narrow, wide = (
        fit_equation_of_state([p.volume_A3 for p in part], [p.energy_eV for p in part])
        for part in ([point for point in points if point.strain in NARROW], points)
    )
    change, flags = wide.B_GPa / narrow.B_GPa - 1, "; ".join(wide.flags)
    said = f"B {narrow.B_GPa:.1f} -> {wide.B_GPa:.1f} GPa ({change:+.1%}); flags: {flags or 'none'}"
    return abs(change) < MAX_WIDE or bool(flags), said


def collapsed(cell: Atoms, dft: DftSettings) -> Verdict:
    """A cell at 60 % of its edges."""
    calculator = make_calculator(dft, "GGA", cell.cell.array)
    energies = []
    for strain in (0.0, -0.4):
        atoms = strained(cell, strain)
        atoms.calc = calculator
        try:
            energies.append(atoms.get_potential_energy() / len(atoms))
        except (CalculationFailed, np.linalg.LinAlgError) as error:
            return bool(energies), f"strain {strain:+.1f}: {error}"
    return energies[1] > energies[0] + LEAST_RISE_EV, f"{energies[1] - energies[0]:+.1f} eV/atom"


def conductor(atoms: Atoms, dft: DftSettings, criteria: NetworkGlass) -> Verdict:
    """A cell with levels in its gap, or without a gap."""
    atoms.calc = calculator = make_calculator(dft, "GGA", atoms.cell.array)
    try:
        atoms.get_potential_energy()
    except CalculationFailed as error:
        return True, str(error)
    gap_eV = last_gap_eV(calculator)
    return bool(no_insulator(gap_eV, criteria)), f"gap {gap_eV:.2f} eV, {criteria.gap_eV} are needed"


def stability_checks(cell: Atoms, criteria: NetworkGlass, dft: DftSettings) -> list[Check]:
    """Case, description, what is checked, and the check.

    Parameters
    ----------
    cell : a crystal of the material, small
    criteria : the `network_glass` of the material
    """
    broken = cell[[k for k in range(len(cell)) if k != 0]]
    refused = "not converged, or gap too small"
    cases: list[tuple[str, str, Callable[..., Verdict], tuple]] = [
        ("strain of ±10 %", "B moves by < 3 % or the fit is flagged", wide_strain, (cell, dft)),
        ("collapsed cell", "far above equilibrium, or an error", collapsed, (cell, dft)),
        ("missing atom", refused, conductor, (broken, dft, criteria)),
        ("metal", refused, conductor, (bulk("Al", "fcc", 4.05, cubic=True), dft, criteria)),
    ]
    return [(case, judge.__doc__ or "", checks, partial(judge, *arguments)) for case, checks, judge, arguments in cases]
