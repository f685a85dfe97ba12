"""Error of bulk and shear modulus against run time: one knob of the calculation at a time, on cells of β-Si3N4."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from ase import Atoms

from atomistic.elastic.dft import PyscfGamma, TwoMeshes, commensurate_mesh
from atomistic.elastic.energy_scans import Point, scan_volumes
from atomistic.elastic.equation_of_state import fit_equation_of_state
from atomistic.elastic.joint_moduli import measure_constants
from atomistic.elastic.networks import tersoff_calculator
from atomistic.elastic.relaxation import spring_hessian
from atomistic.elastic.response import elastic_response
from atomistic.elastic.tensor import isotropic
from atomistic.materials import NetworkGlass
from atomistic.settings import TensorSettings

Progress = Callable[[float, str], None]
BASE: dict[str, Any] = {"basis": "gth-dzvp-molopt-sr", "cutoff_Ha": 60.0, "tolerance_Ha": 1e-6, "max_cycles": 40}
STRAINS = (-0.03, -0.015, 0.0, 0.015, 0.03)
DENSE = tuple(np.linspace(-0.06, 0.06, 13).round(3).tolist())
CUTOFFS_HA = (40.0, 60.0, 80.0, 100.0, 140.0)
TOLERANCES_HA = (1e-3, 1e-4, 1e-6, 1e-8)
RANGES = (0.02, 0.04, 0.06)  # five of the dense strains each
COUNTS = (5, 7, 13)  # over the whole range


def timed_scan(atoms: Atoms, strains: Sequence[float], **changes: Any) -> tuple[list[Point], dict[str, float]]:
    """E(V) by PBE with `changes` to `BASE`, and what it cost."""
    p = {**BASE, **changes}
    largest = atoms.cell.array * (1 + max(strains))
    calculator = PyscfGamma(xc="GGA", mesh=commensurate_mesh(largest, p["cutoff_Ha"]), **p)
    with timed() as cost:
        points = scan_volumes(atoms, calculator, strains)
    return points, cost


def modulus(points: Sequence[Point]) -> float:
    """Bulk modulus of the converged points, GPa; NaN with fewer than five."""
    good = [point for point in points if point.converged]
    if len(good) < 5:
        return float("nan")
    return fit_equation_of_state([p.volume_A3 for p in good], [p.energy_eV for p in good]).B_GPa


def point(
    knob: str, value: Any, modulus_GPa: float, reference_GPa: float, reference: str, cost: Mapping, symbol: str = "B"
) -> dict[str, Any]:
    """Error and cost of one value of a knob; `symbol` names the modulus, B or G."""
    return {
        "case": f"{symbol} {modulus_GPa:.2f} GPa",
        "knob": knob,
        "value": value,
        "error": modulus_GPa / reference_GPa - 1,
        "error_metric": f"relative error of {symbol}",
        "reference": f"{reference}: {reference_GPa:.2f} GPa",
        **cost,
    }


def accuracy_points(cell: Atoms, double_cell: Atoms, progress: Progress | None = None) -> Iterator[dict[str, Any]]:
    """Cutoff, SCF tolerance, basis, cell size, range and number of strains.

    Parameters
    ----------
    cell, double_cell : β-Si3N4 with 14 and 28 atoms
    """

    def say(done: float, text: str) -> None:
        if progress:
            progress(done, text)

    by_cutoff = {}
    for k, cutoff in enumerate(CUTOFFS_HA):
        say(0.08 * k, f"cutoff {cutoff:g} Ha")
        by_cutoff[cutoff] = timed_scan(cell, STRAINS, cutoff_Ha=cutoff)
    best = modulus(by_cutoff[CUTOFFS_HA[-1]][0])
    for cutoff, (points, cost) in by_cutoff.items():
        yield point("cutoff_Ha", cutoff, modulus(points), best, f"{CUTOFFS_HA[-1]:g} Ha", cost)
    base = modulus(by_cutoff[BASE["cutoff_Ha"]][0])

    by_tolerance = {}
    for k, tolerance in enumerate(TOLERANCES_HA):
        say(0.35 + 0.06 * k, f"SCF tolerance {tolerance:g} Ha")
        by_tolerance[tolerance] = timed_scan(cell, STRAINS, tolerance_Ha=tolerance)
    tight = modulus(by_tolerance[TOLERANCES_HA[-1]][0])
    for tolerance, (points, cost) in by_tolerance.items():
        yield point("tolerance_Ha", tolerance, modulus(points), tight, f"{TOLERANCES_HA[-1]:g} Ha", cost)

    say(0.6, "basis without polarisation functions")
    points, cost = timed_scan(cell, STRAINS, basis="gth-szv-molopt-sr")
    yield point("basis", "gth-szv-molopt-sr", modulus(points), base, BASE["basis"], cost)

    say(0.65, "28 atoms")
    points, cost = timed_scan(double_cell, STRAINS)
    yield point("atoms", len(cell), base, modulus(points), f"{len(double_cell)} atoms", by_cutoff[BASE["cutoff_Ha"]][1])
    yield point("atoms", len(double_cell), modulus(points), modulus(points), f"{len(double_cell)} atoms", cost)

    say(0.85, f"{len(DENSE)} strains")
    points, cost = timed_scan(cell, DENSE)
    reference = modulus(points)
    for reach in RANGES:
        chosen = sorted(points, key=lambda p: min(abs(p.strain - reach * x) for x in (-1, -0.5, 0, 0.5, 1)))[:5]
        share = {**cost, "wall_s": sum(p.wall_s for p in chosen), "cpu_s": None}
        yield point("strain_range", reach, modulus(chosen), reference, f"{len(DENSE)} strains", share)
    for count in COUNTS:
        positions = np.linspace(0, len(DENSE) - 1, count).round().astype(int)
        chosen = [points[k] for k in positions]
        share = {**cost, "wall_s": sum(p.wall_s for p in chosen), "cpu_s": None}
        yield point("strains", count, modulus(chosen), reference, f"{len(DENSE)} strains", share)


def constants_points(cell: Atoms, criteria: NetworkGlass) -> Iterator[dict[str, Any]]:
    """What strain, displacement, rounds and the relaxation before cost the shear modulus, under the cheap potential.

    Parameters
    ----------
    cell : a crystal of the material
    criteria : the `network_glass` of the material, for its potential
    """
    base = TensorSettings(
        strain=0.002, displacement_A=0.01, rounds=6, tolerance_GPa=1e-2, force_eV_A=1e-3, max_steps=300
    )
    knobs: dict[str, tuple[float, ...]] = {
        "strain": (0.02, 0.01, 0.005, 0.002),
        "displacement_A": (0.1, 0.03, 0.01),
        "rounds": (1, 2, 3, 6),
        "force_eV_A": (0.3, 0.1, 0.03, 1e-3),
    }

    def shear_modulus(settings: TensorSettings) -> tuple[float, dict[str, float]]:
        with timed() as cost:
            measured = measure_constants(cell, tersoff_calculator(criteria.tersoff), settings)
        return (isotropic(measured.response.relaxed).G if measured.response else float("nan")), cost

    finest, _ = shear_modulus(base)
    for knob, values in knobs.items():
        for value in values:
            G, cost = shear_modulus(base.model_copy(update={knob: value}))
            yield point(f"tensor.{knob}", value, G, finest, "finest of each, Tersoff potential", cost, "G")


def shear_points(cell: Atoms, progress: Progress | None = None) -> Iterator[dict[str, Any]]:
    """What cutoff, SCF tolerance, a larger basis and one mesh instead of two do to the shear modulus by PBE.

    All with the same springs between the ions, so that stresses and forces of the strained states make the difference.

    Parameters
    ----------
    cell : a crystal of the material, as published
    """
    base: dict[str, Any] = {**BASE, "cutoff_Ha": 80.0, "tolerance_Ha": 1e-7}
    knobs: list[tuple[str, Any]] = [("cutoff_Ha", 80.0), ("cutoff_Ha", 60.0), ("cutoff_Ha", 100.0)]
    knobs += [("tolerance_Ha", 1e-6), ("tolerance_Ha", 1e-8), ("basis", "gth-tzvp-molopt"), ("meshes", 1)]
    settings, reference = TensorSettings(), float("nan")
    for done, (knob, value) in enumerate(knobs):
        if progress:
            progress(done / len(knobs), f"shear modulus, {knob} {value}")
        p = {**base, knob: value}
        meshes = p.pop("meshes", 2)
        engine = PyscfGamma(xc="GGA", mesh=commensurate_mesh(cell.cell.array * 1.03, p["cutoff_Ha"]), **p)
        sides = TwoMeshes(engine).sides if meshes == 2 else (engine, engine)
        with timed() as cost:
            response = elastic_response(cell, sides, spring_hessian(cell), settings.strain, 0.0, 0, 0.0)
        G = isotropic(response.relaxed).G
        reference = G if done == 0 else reference
        yield point(f"{knob}, strained", value, G, reference, "80 Ha, 1e-7 Ha, two meshes", cost, "G")


@contextmanager
def timed() -> Iterator[dict[str, float]]:
    """Seconds that a block takes, in the dictionary it is given."""
    cost: dict[str, float] = {}
    wall, cpu = time.perf_counter(), time.process_time()
    yield cost
    cost |= {"wall_s": time.perf_counter() - wall, "cpu_s": time.process_time() - cpu}


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
