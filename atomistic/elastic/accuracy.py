"""Error of bulk and shear modulus against run time: the numerical choices of a scene, one at a time, on a crystal."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from ase import Atoms

from atomistic.elastic.dft import (
    ENERGY_TOLERANCE_HA,
    FORCES_TOLERANCE_HA,
    PyscfGamma,
    TwoMeshes,
    commensurate_mesh,
)
from atomistic.elastic.energy_scans import Point, scan_volumes
from atomistic.elastic.equation_of_state import MIN_POINTS, fit_equation_of_state
from atomistic.elastic.relaxation import spring_hessian
from atomistic.elastic.response import elastic_response
from atomistic.elastic.tensor import isotropic
from atomistic.settings import ElasticSettings

Progress = Callable[[float, str], None]
DENSE = tuple(np.linspace(-0.06, 0.06, 13).round(3).tolist())
RANGES = (0.02, 0.04, 0.06)  # five of the dense strains each
COUNTS = (5, 7, 13)  # over the whole range
TOLERANCES_HA = (1e-4, ENERGY_TOLERANCE_HA, 1e-8)
CUTOFFS = (0.6, 0.8, 1.0, 1.4)  # times the cut-off of the scene
LARGE_BASIS = "gth-tzvp-molopt"


def volume_points(
    cell: Atoms, larger: Atoms, settings: ElasticSettings, progress: Progress | None = None
) -> Iterator[dict[str, Any]]:
    """Bulk modulus by E(V) with PBE: cut-off, SCF tolerance, basis, size of the cell, range and number of strains.

    Parameters
    ----------
    cell, larger : the same crystal in a small and in a larger cell
    """
    cutoff, basis = settings.dft.cutoff_Ha, settings.dft.basis
    use: dict[str, Any] = {"cutoff_Ha": cutoff, "basis": basis, "tolerance_Ha": ENERGY_TOLERANCE_HA}
    knobs: dict[str, Sequence[Any]] = {  # the last value of each is the reference
        "cutoff_Ha": [round(share * cutoff, 6) for share in CUTOFFS],
        "tolerance_Ha": TOLERANCES_HA,
        "basis": [basis, LARGE_BASIS],
        "atoms": [len(cell), len(larger)],
    }
    for knob, values in knobs.items():
        tried = []
        for value in values:
            if progress:
                progress(0.15 * list(knobs).index(knob), f"{knob} {value}")
            chosen = use if knob == "atoms" else {**use, knob: value}
            tried.append(_scan(larger if value == len(larger) else cell, settings.strains, chosen))
        best = _modulus(tried[-1][0])
        for value, (points, cost) in zip(values, tried, strict=True):
            yield _point(knob, value, _modulus(points), best, str(values[-1]), cost)
    if progress:
        progress(0.6, f"{len(DENSE)} strains")
    points, cost = _scan(cell, DENSE, use)
    thinned = [
        ("strain_range", reach, [_nearest(points, reach * share) for share in (-1, -0.5, 0, 0.5, 1)])
        for reach in RANGES
    ]
    thinned += [
        ("strains", count, [points[k] for k in np.linspace(0, len(DENSE) - 1, count).round().astype(int)])
        for count in COUNTS
    ]
    for knob, value, part in thinned:
        share = {**cost, "wall_s": sum(p.wall_s for p in part), "cpu_s": None}
        yield _point(knob, value, _modulus(part), _modulus(points), f"{len(DENSE)} strains", share)


def shear_points(cell: Atoms, settings: ElasticSettings, progress: Progress | None = None) -> Iterator[dict[str, Any]]:
    """Shear modulus with PBE: cut-off, and one mesh in place of two.

    All with the same springs between the ions, so that stresses and forces of the strained states make the difference.

    Parameters
    ----------
    cell : a crystal of the material, as published
    """
    cutoff = settings.dft.forces_cutoff_Ha
    tries = [("meshes", 2, cutoff), ("meshes", 1, cutoff)]
    tries += [("cutoff_Ha, strained", share * cutoff, share * cutoff) for share in (0.75, 1.25)]
    reference = float("nan")
    for done, (knob, value, cutoff_Ha) in enumerate(tries):
        if progress:
            progress(0.75 + 0.25 * done / len(tries), f"shear modulus, {knob} {value:g}")
        engine = _engine(cell.cell.array * 1.03, cutoff_Ha, settings.dft.basis, FORCES_TOLERANCE_HA)
        sides = (engine, engine) if (knob, value) == ("meshes", 1) else TwoMeshes(engine).sides
        with _timed() as cost:
            G = isotropic(elastic_response(cell, sides, spring_hessian(cell), rounds=0, tolerance_GPa=0.0).relaxed).G
        reference = reference if done else G
        yield _point(knob, value, G, reference, f"two meshes, {cutoff:g} Ha", cost, "G")


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


def _engine(largest_cell: np.ndarray, cutoff_Ha: float, basis: str, tolerance_Ha: float) -> PyscfGamma:
    mesh = commensurate_mesh(largest_cell, cutoff_Ha)
    return PyscfGamma(xc="GGA", mesh=mesh, cutoff_Ha=cutoff_Ha, basis=basis, tolerance_Ha=tolerance_Ha)


def _scan(atoms: Atoms, strains: Sequence[float], choice: Mapping[str, Any]) -> tuple[list[Point], dict[str, float]]:
    engine = _engine(atoms.cell.array * (1 + max(strains)), **choice)
    with _timed() as cost:
        points = scan_volumes(atoms, engine, strains)
    return points, cost


def _nearest(points: Sequence[Point], strain: float) -> Point:
    return min(points, key=lambda point: abs(point.strain - strain))


def _modulus(points: Sequence[Point]) -> float:
    """Bulk modulus of the converged points, GPa; NaN with too few."""
    good = [point for point in points if point.converged]
    if len(good) < MIN_POINTS:
        return float("nan")
    return fit_equation_of_state([p.volume_A3 for p in good], [p.energy_eV for p in good]).B_GPa


def _point(
    knob: str, value: Any, modulus_GPa: float, reference_GPa: float, reference: str, cost: Mapping, symbol: str = "B"
) -> dict[str, Any]:
    return {
        "case": f"{symbol} {modulus_GPa:.2f} GPa",
        "knob": knob,
        "value": value,
        "error": modulus_GPa / reference_GPa - 1,
        "error_metric": f"relative error of {symbol}",
        "reference": f"{reference}: {reference_GPa:.2f} GPa",
        **cost,
    }


@contextmanager
def _timed() -> Iterator[dict[str, float]]:
    """Seconds that a block takes, in the dictionary it is given."""
    cost: dict[str, float] = {}
    wall, cpu = time.perf_counter(), time.process_time()
    yield cost
    cost |= {"wall_s": time.perf_counter() - wall, "cpu_s": time.process_time() - cpu}
