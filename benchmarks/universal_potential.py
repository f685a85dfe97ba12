"""A universal potential beside the anchors of the elastic stage and beside its own DFT on the same glasses.

uv run --with sevenn python -m benchmarks.universal_potential 7net-0|7net-mf-0|7net-l3i5 [RESULTS]

RESULTS: folder of a scene whose elastic stage has run, results/reduced.  Prints elastic constants of β-Si3N4 and
silicon with their deviation from PBE or experiment, then B of every glass by the potential and by DFT, about the same
positions (docs/elastic.md, Universal potentials).
"""

import csv
import sys
import time
from pathlib import Path

import numpy as np
from ase import Atoms
from ase.calculators.calculator import Calculator
from ase.io import read
from atomistic.elastic.joint_moduli import measure_constants
from atomistic.elastic.studies.constants import beside_published

from atomistic.elastic.energy_scans import scan_volumes
from atomistic.elastic.equation_of_state import fit_equation_of_state
from atomistic.elastic.networks import crystal
from atomistic.materials import load_material
from atomistic.settings import TensorSettings

MATERIALS = Path(__file__).parents[1] / "config/materials"
STRAINS = (-0.03, -0.015, 0.0, 0.015, 0.03)
SETTINGS = TensorSettings(force_eV_A=0.02, tolerance_GPa=0.2, rounds=10, max_steps=200)


def potential(name: str) -> Calculator:
    """The calculator of a potential whose weights ship with the package `sevenn`."""
    from sevenn.calculator import SevenNetCalculator  # pyright: ignore[reportMissingImports]  (installed by --with)

    tasks = {"modal": "PBE"} if name == "7net-mf-0" else {}
    return SevenNetCalculator(name, device="cpu", **tasks)


def constants(calculator: Calculator, material: str, name: str) -> None:
    """Print the constants of a crystal beside the published ones."""
    known = load_material(MATERIALS / f"{material}.yaml")
    measured = measure_constants(crystal(known, name), calculator, SETTINGS)
    print(f"{name}: {measured.failure or 'ions and cell at rest'}")
    for row in beside_published(measured.report(name), known.crystals[name]):
        print(
            f"  {row['quantity']:4} clamped {row['clamped']:8.3f}  relaxed {row['relaxed']:8.3f}  "
            f"{row['published']} {row['published_value']:8.3f}  deviation {row['deviation']:+.1%}",
            flush=True,
        )


def bulk_modulus(atoms: Atoms, calculator: Calculator) -> tuple[float, float]:
    """B (GPa) with clamped ions, as the elastic stage finds it, and the volume at rest (Å³)."""
    points = scan_volumes(atoms, calculator, STRAINS)
    fit = fit_equation_of_state([point.volume_A3 for point in points], [point.energy_eV for point in points])
    return fit.B_GPa, fit.V0_A3


def glasses(calculator: Calculator, results: Path) -> None:
    """Print B and volume of every glass whose clamped PBE curve there is."""
    with (results / "elastic/bulk_moduli.csv").open(encoding="utf-8", newline="") as table:
        rows = list(csv.DictReader(table))
    pairs = []
    for row in rows:
        path = results / f"elastic/structures/{row['structure']}.xyz"
        if (row["xc"], row["ions"]) != ("GGA", "clamped") or not row["structure"].startswith("a"):
            continue
        B, volume = bulk_modulus(read(path), calculator)
        pairs.append((B - float(row["B_GPa"]), volume / float(row["V0_A3"]) - 1))
        print(f"{row['structure']}: B {B:.1f}, by DFT {float(row['B_GPa']):.1f} GPa; volume {pairs[-1][1]:+.2%}")
    shift, volume = np.array(pairs).T
    print(f"B - DFT {shift.mean():.1f} +- {shift.std(ddof=1):.1f} GPa over {len(shift)} glasses, {volume.mean():+.2%}")


if __name__ == "__main__":
    start = time.process_time()
    engine = potential(sys.argv[1])
    constants(engine, "silicon", "silicon")
    constants(engine, "silicon_nitride", "beta")
    if len(sys.argv) > 2:
        glasses(engine, Path(sys.argv[2]))
    print(f"{time.process_time() - start:.0f} s of processor time")
