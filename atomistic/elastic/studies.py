"""Accuracy and stability of the elastic stage: the choices of a scene varied on a crystal, and hard cases.

What the engine cannot compute must be refused or flagged; a plausible number would be wrong.
"""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from ase import Atoms
from ase.build import bulk
from ase.calculators.calculator import CalculationFailed

from asperity.guards.errors import InputError
from atomistic.elastic.dft import make_calculator
from atomistic.elastic.energy_scans import scan_volumes
from atomistic.elastic.equation_of_state import EquationOfState, fit_equation_of_state
from atomistic.elastic.networks import crystal, no_insulator
from atomistic.elastic.relaxation import last_gap_eV, strained
from atomistic.materials import Material, NetworkGlass
from atomistic.settings import DftSettings, ElasticSettings

Check = tuple[str, str, str, Callable[[], tuple[bool, str]]]  # case, description, what is checked, the check


def volume_points(
    cell: Atoms, larger: Atoms, settings: ElasticSettings, progress: Callable[[float, str], None] | None = None
) -> Iterator[dict[str, Any]]:
    """Error of the bulk modulus by PBE against run time: cut-off, basis, strains and size of the cell.

    Parameters
    ----------
    cell, larger : the same crystal in a small and in a larger cell
    """
    dft = settings.dft
    knobs: dict[str, list[tuple[Any, Atoms, DftSettings, Sequence[float]]]] = {  # the last of each is the reference
        "cutoff_Ha": [
            (
                value := round(share * dft.cutoff_Ha, 6),
                cell,
                dft.model_copy(update={"cutoff_Ha": value}),
                settings.strains,
            )
            for share in (0.6, 0.8, 1.0, 1.4)
        ],
        "basis": [
            (basis, cell, dft.model_copy(update={"basis": basis}), settings.strains)
            for basis in (dft.basis, "gth-tzvp-molopt")
        ],
        "largest strain": [
            (max(strains), cell, dft, strains)
            for strains in (tuple(share * strain for strain in settings.strains) for share in (2.0, 0.67, 1.0))
        ],
        "atoms": [(len(atoms), atoms, dft, settings.strains) for atoms in (cell, larger)],
    }
    for done, (knob, tries) in enumerate(knobs.items()):
        tried = []
        for value, atoms, chosen, strains in tries:
            if progress:
                progress(done / len(knobs), f"{knob} {value}")
            wall, cpu = time.perf_counter(), time.process_time()
            try:
                B = _fit(atoms, chosen, strains).B_GPa
            except InputError:  # too few strains converged
                B = float("nan")
            tried.append((value, B, {"wall_s": time.perf_counter() - wall, "cpu_s": time.process_time() - cpu}))
        reference, best, _ = tried[-1]
        for value, B, cost in tried:
            yield {
                "case": f"B {B:.2f} GPa",
                "knob": knob,
                "value": value,
                "error": B / best - 1,
                "error_metric": "relative error of B",
                "reference": f"{reference}: {best:.2f} GPa",
                **cost,
            }


def accuracy_points(
    material: Material,
    fits: Sequence[Mapping[str, str]],
    points: Sequence[Mapping[str, str]],
    settings: ElasticSettings,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[dict[str, Any]]:
    """Error of B against run time: by the number of glasses, and by the choices of a scan of a crystal.

    Parameters
    ----------
    fits, points : rows of elastic/bulk_moduli.csv and elastic/points.csv.
    """
    glasses = [row for row in fits if row["structure"] not in material.crystals]
    clamped = [row for row in glasses if row["xc"] == "GGA" and not row["flags"]]
    names = {row["structure"] for row in clamped}
    cost = sum(float(point["wall_s"]) for point in points if point["structure"] in names)
    yield from ensemble_points([float(row["B_GPa"]) for row in clamped], cost)
    name = next(iter(material.crystals), "")
    yield from volume_points(crystal(material, name, (1, 1, 1)), crystal(material, name), settings, progress)


def ensemble_points(moduli_GPa: Sequence[float], wall_s: float) -> Iterator[dict[str, Any]]:
    """Standard error of the mean modulus of a glass against the number of structures, from their scatter."""
    B = np.asarray(moduli_GPa, float)
    for count in range(2, len(B) + 1):
        yield {
            "case": f"amorphous, B {B.mean():.1f} GPa",
            "knob": "structures",
            "value": count,
            "error": float(B.std(ddof=1) / np.sqrt(count) / B.mean()),
            "error_metric": "relative standard error of the mean B",
            "reference": f"scatter of {len(B)} structures: {B.std(ddof=1):.1f} GPa",
            "wall_s": wall_s * count / len(B),
            "cpu_s": None,
            "peak_rss_MB": None,
        }


def stability_checks(material: Material, dft: DftSettings) -> list[Check]:
    """Hard cases for the engine of a scene, on a small cell of the first crystal of its material."""
    cell = crystal(material, next(iter(material.crystals), ""), (1, 1, 1))
    criteria: NetworkGlass = material.part("network_glass")
    refused = "not converged, or gap too small"
    broken, metal = cell[1:], bulk("Al", "fcc", 4.05, cubic=True)
    return [
        (
            "strain of ±10 %",
            "linear strain of 10 % in place of 5 %",
            "B moves by < 3 % or the fit is flagged",
            partial(_wide_strain, cell, dft),
        ),
        (
            "collapsed cell",
            "a cell at 60 % of its edges",
            "far above equilibrium, or an error",
            partial(_collapsed, cell, dft),
        ),
        ("missing atom", "a cell with levels in its gap", refused, partial(conductor, broken, dft, criteria)),
        ("metal", "a cell without a gap", refused, partial(conductor, metal, dft, criteria)),
    ]


def _fit(cell: Atoms, dft: DftSettings, strains: Sequence[float]) -> EquationOfState:
    """The equation of state by PBE, of the strains that converged."""
    calculator = make_calculator(dft, "GGA", cell.cell.array * (1 + max(strains)))
    points = [point for point in scan_volumes(cell, calculator, strains) if point.converged]
    return fit_equation_of_state([p.volume_A3 for p in points], [p.energy_eV for p in points])


def _wide_strain(cell: Atoms, dft: DftSettings) -> tuple[bool, str]:
    narrow, wide = (_fit(cell, dft, np.linspace(-largest, largest, 7).tolist()) for largest in (0.05, 0.1))
    change, flags = wide.B_GPa / narrow.B_GPa - 1, "; ".join(wide.flags)
    detail = f"B {narrow.B_GPa:.1f} -> {wide.B_GPa:.1f} GPa ({change:+.1%}); flags: {flags or 'none'}"
    return abs(change) < 0.03 or bool(flags), detail


def _collapsed(cell: Atoms, dft: DftSettings) -> tuple[bool, str]:
    calculator = make_calculator(dft, "GGA", cell.cell.array)
    energies = []
    for strain in (0.0, -0.4):
        atoms = strained(cell, strain)
        atoms.calc = calculator
        try:
            energies.append(atoms.get_potential_energy() / len(atoms))
        except (CalculationFailed, np.linalg.LinAlgError) as error:
            return bool(energies), f"strain {strain:+.1f}: {error}"
    return energies[1] > energies[0] + 1.0, f"{energies[1] - energies[0]:+.1f} eV/atom"


def conductor(atoms: Atoms, dft: DftSettings, criteria: NetworkGlass) -> tuple[bool, str]:
    """Whether a cell with levels in its gap, or without a gap, is refused."""
    atoms.calc = calculator = make_calculator(dft, "GGA", atoms.cell.array)
    try:
        atoms.get_potential_energy()
    except CalculationFailed as error:
        return True, str(error)
    gap_eV = last_gap_eV(calculator)
    return bool(no_insulator(gap_eV, criteria)), f"gap {gap_eV:.2f} eV, {criteria.gap_eV} are needed"
