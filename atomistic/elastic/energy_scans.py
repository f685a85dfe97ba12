"""Energy-volume scans E(V) under isotropic strain, and the bulk modulus of each.

Ions keep their fractional coordinates (they are "clamped": every bond scales), as in the paper.  A
glass whose ions follow the strain is softer.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from ase import Atoms
from ase.calculators.calculator import CalculationFailed, Calculator

from atomistic.elastic.dft import Solution, Store, make_calculator
from atomistic.elastic.equation_of_state import MIN_POINTS, fit_equation_of_state
from atomistic.elastic.relaxation import strained
from atomistic.lammps import Progress
from atomistic.settings import DftSettings

STRAINS = (-0.03, -0.015, 0.0, 0.015, 0.03)
"""Linear isotropic strains of a scan. Kim et al. (2013) took 5 %, which makes B 0.2 to 0.5 %
smaller and misses the curve by more (study `elastic.strains`); `accuracy/elastic.csv` has the
errors of a scene's own glasses."""


@dataclass(frozen=True)
class ScanPoint:
    """One volume of an E(V) scan; `energy_eV` is NaN where it failed, and `detail` says why."""

    strain: float
    volume_A3: float
    energy_eV: float
    converged: bool
    wall_s: float
    detail: str = ""


def scan_volumes(
    atoms: Atoms, calculator: Calculator, strains: Sequence[float], progress: Progress | None = None
) -> list[ScanPoint]:
    """Energy of a structure at each isotropic strain, ions clamped.

    The smallest strain comes first, then they go outwards: each calculation starts from its
    neighbours'.  One that fails is reported in its point and the scan goes on.
    """
    points: dict[float, ScanPoint] = {}
    for strain in sorted(strains, key=lambda strain: (abs(strain), -strain)):
        if progress:
            progress(len(points) / len(strains), f"strain {strain:+.3f}")
        trial = strained(atoms, strain)
        trial.calc = calculator
        start = time.perf_counter()
        energy = float("nan")
        detail = ""
        try:
            energy = float(trial.get_potential_energy())
        except (
            CalculationFailed,
            NotImplementedError,
            np.linalg.LinAlgError,
            FloatingPointError,
        ) as error:
            detail = f"strain {strain:+.3f}: {error}"
        seconds = time.perf_counter() - start
        points[strain] = ScanPoint(
            strain, float(trial.get_volume()), energy, not detail, seconds, detail
        )
    return [points[strain] for strain in sorted(points)]


def scan_rows(
    name: str,
    atoms: Atoms,
    xc: str,
    dft: DftSettings,
    store: Store | None = None,
    start: Sequence[Solution] = (),
    rejected: str = "",
    progress: Progress | None = None,
) -> list[dict[str, Any]]:
    """Rows of elastic/points.csv of one structure and functional.

    Parameters
    ----------
    start : former solutions to start from
    rejected : why the structure failed its gate: nothing is computed, and every row says so
    """
    if xc == "LDA":
        atoms = strained(atoms, -0.012)  # its volume is some 4 % smaller than that of GGA
    if rejected:
        volumes = [float(strained(atoms, strain).get_volume()) for strain in STRAINS]
        points = []
        for strain, volume in zip(STRAINS, volumes, strict=True):
            points.append(ScanPoint(strain, volume, float("nan"), False, 0.0, rejected))
    else:
        calculator = make_calculator(dft, xc, atoms.cell.array * (1 + max(STRAINS)), store)
        calculator.history = list(start)
        points = scan_volumes(atoms, calculator, STRAINS, progress)
    head = {"structure": name, "xc": xc, "ions": "clamped", "atoms": len(atoms)}
    return [{**head, **asdict(point)} for point in points]


def fit_scan(scan: Sequence[Mapping[str, str]]) -> dict[str, Any]:
    """Row of `bulk_moduli.csv` from the rows of one scan: the fit, or why there is none.

    Points that did not converge are named in `flags`; with fewer than five left the structure is
    rejected.
    """
    good = [row for row in scan if row["converged"] == "True"]
    failed = list(dict.fromkeys(row["detail"] for row in scan if row["converged"] != "True"))
    result: dict[str, Any] = {key: scan[0][key] for key in ("structure", "xc", "ions", "atoms")}
    empty = ("B_GPa", "B_prime", "V0_A3", "B_vinet_GPa", "B_error_GPa", "residual_meV")
    if len(good) < MIN_POINTS:
        flags = [f"{len(good)} of {len(scan)} strains converged, {MIN_POINTS} are needed", *failed]
        result |= dict.fromkeys(empty)
        return {**result, "points": len(good), "flags": "; ".join(flags), "failed": ""}
    volumes = [float(row["volume_A3"]) for row in good]
    energies = [float(row["energy_eV"]) for row in good]
    fit = fit_equation_of_state(volumes, energies)
    result |= {key: getattr(fit, key) for key in empty}
    result["points"] = fit.points
    result["flags"] = "; ".join(fit.flags)
    result["failed"] = "; ".join(failed)
    return result
