"""Energy-volume scans E(V) under isotropic strain, and the bulk modulus of each.

"Clamped" ions keep their fractional coordinates (every bond scales); "relaxed" ions find their minimum at each
strain, which is what a slow experiment does.  A glass is softer with relaxed ions.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from ase import Atoms
from ase.calculators.calculator import CalculationFailed, Calculator

from atomistic.elastic.dft import PyscfGamma, Store, commensurate_mesh
from atomistic.elastic.equation_of_state import MIN_POINTS, fit_equation_of_state
from atomistic.elastic.relaxation import Rest, extrapolated_ions, strained
from atomistic.errors import InputError
from atomistic.settings import DftSettings

Progress = Callable[[float, str], None]
ENGINES_OF_ASE = ("espresso", "vasp", "abinit", "cp2k", "gpaw", "siesta")


def make_calculator(
    dft: DftSettings,
    xc: str,
    largest_cell: np.ndarray | None = None,
    store: Store | None = None,
    cutoff_Ha=None,
) -> Calculator:
    """The DFT engine of the settings.

    Parameters
    ----------
    xc : "GGA" or "LDA"
    largest_cell : (3, 3) Å; the mesh is fixed to what this cell needs, so that it does not jump along a scan
    store : finished calculations (PySCF engine only)
    """
    if dft.engine == "pyscf":
        cutoff = cutoff_Ha or dft.cutoff_Ha
        return PyscfGamma(
            store=store,
            xc=xc,
            basis=dft.basis,
            cutoff_Ha=cutoff,
            mesh=None if largest_cell is None else commensurate_mesh(largest_cell, cutoff),
            tolerance_Ha=dft.tolerance_Ha,
            max_cycles=dft.max_cycles,
            numerics=dft.numerics,
        )
    from ase.calculators.calculator import get_calculator_class

    try:
        parameters: dict[str, Any] = dict(dft.parameters)
        return get_calculator_class(dft.engine)(**parameters)
    except Exception as error:
        raise InputError(f"elastic.dft.engine: ASE cannot set up {dft.engine}: {error}") from error


@dataclass(frozen=True)
class Point:
    """One volume of an E(V) scan; `energy_eV` is NaN where the calculation failed.

    `detail` says why it failed, or how relaxed ions came to rest.
    """

    strain: float
    volume_A3: float
    energy_eV: float
    converged: bool
    wall_s: float
    detail: str = ""


def scan_order(strains: Sequence[float]) -> list[float]:
    """Smallest strain first, then outwards: each calculation starts from its neighbours'."""
    return sorted(strains, key=lambda strain: (abs(strain), -strain))


def scan_volumes(
    atoms: Atoms,
    calculator: Calculator,
    strains: Sequence[float],
    relax: Callable[[Atoms, np.ndarray | None], Rest] | None = None,
    progress: Progress | None = None,
) -> list[Point]:
    """Energy of a structure at each isotropic strain.

    A calculation that fails is reported in its point and the scan goes on.  Ions that relax start from where those of
    the nearest strains came to rest, with the Hessian found there; the energy that is still
    recoverable from the residual forces is subtracted.

    Parameters
    ----------
    relax : moves the ions of a strained structure (its calculator attached) to their minimum, from a Hessian if there
        is one; None clamps them
    """
    points: dict[float, Point] = {}
    rested: dict[float, Atoms] = {}
    hessian: np.ndarray | None = None
    order = scan_order(strains)
    if relax is not None:
        order.append(order[0])  # repeat the first strain with its neighbours as initial guess
    for done, strain in enumerate(order):
        if progress:
            progress(done / len(order), f"strain {strain:+.3f}")
        others = {known: ions for known, ions in rested.items() if known != strain}
        trial = extrapolated_ions(others or {0.0: atoms}, strain)
        trial.calc = calculator
        start = time.perf_counter()
        energy, converged, detail = float("nan"), True, ""
        try:
            below = 0.0
            if relax is not None:
                rest = relax(trial, hessian)
                rested[strain], hessian, below = trial, rest.hessian_eV_A2, rest.depth_eV
                detail = (
                    f"{rest.steps} steps, {rest.force_left_eV_A:.2f} eV/A left, minimum {1000 * below:.1f} meV below"
                )
            energy = float(trial.get_potential_energy()) - below
        except (CalculationFailed, NotImplementedError, np.linalg.LinAlgError, FloatingPointError) as error:
            converged, detail = False, f"strain {strain:+.3f}: {error}"
        point = Point(strain, float(trial.get_volume()), energy, converged, time.perf_counter() - start, detail)
        before = points.get(strain, point)
        lower = before if before.energy_eV < energy or not converged else point
        points[strain] = replace(lower, wall_s=point.wall_s + (before.wall_s if before is not point else 0.0))
    return [points[strain] for strain in sorted(points)]


def rejected_points(atoms: Atoms, strains: Sequence[float], reason: str) -> list[Point]:
    """The scan of a structure that failed its gate: nothing computed, the reason in every point."""
    volumes = [float(strained(atoms, strain).get_volume()) for strain in strains]
    return [Point(s, v, float("nan"), False, 0.0, reason) for s, v in zip(strains, volumes, strict=True)]


def fit_scan(scan: Sequence[Mapping[str, str]]) -> dict[str, Any]:
    """Row of `bulk_moduli.csv` from the rows of one scan: the fit, or why there is none.

    Points that did not converge are named in `flags`; with fewer than five left the structure is rejected.
    """
    good = [row for row in scan if row["converged"] == "True"]
    failed = list(dict.fromkeys(row["detail"] for row in scan if row["converged"] != "True"))
    result: dict[str, Any] = {key: scan[0][key] for key in ("structure", "xc", "ions", "atoms")}
    empty = ("B_GPa", "B_prime", "V0_A3", "B_vinet_GPa", "B_error_GPa", "residual_meV")
    if len(good) < MIN_POINTS:
        flags = [f"{len(good)} of {len(scan)} strains converged, {MIN_POINTS} are needed", *failed]
        return {
            **result,
            **dict.fromkeys(empty),
            "points": len(good),
            "flags": "; ".join(flags),
            "failed": "",
        }
    fit = fit_equation_of_state([float(r["volume_A3"]) for r in good], [float(r["energy_eV"]) for r in good])
    return {
        **result,
        **{key: getattr(fit, key) for key in empty},
        "points": fit.points,
        "flags": "; ".join(fit.flags),
        "failed": "; ".join(failed),
    }


# -- effective modulus
