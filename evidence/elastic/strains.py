"""Do bulk moduli by strains of 3 %, as in use, differ from those by 5 %, as in Kim et al. (2013)?

E(V) of small glasses and of β-Si3N4 by PBE with clamped ions: five strains of each width by the
stage's fit, beside a polynomial of degree 5 through all energies. Four minutes of one core.
"""

import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ase import Atoms

from atomistic.elastic.accuracy import (
    DEGREE,
    WIDTHS,
    ScannedGlass,
    five_strains,
    modulus_of_polynomial,
)
from atomistic.elastic.dft import make_calculator
from atomistic.elastic.equation_of_state import fit_equation_of_state
from atomistic.elastic.networks import crystal, make_glass
from atomistic.elastic.structures import relaxed_structure
from atomistic.materials import Material, load_material
from atomistic.settings import DftSettings, NitrideGlassSettings
from evidence.record import ROOT

IN_USE, PAPER = 0.03, 0.05


def arguments(parser: ArgumentParser) -> None:
    """How many glasses, and how large."""
    parser.add_argument("--glasses", type=int, default=3)
    parser.add_argument("--formula-units", type=int, default=2)
    parser.add_argument("--cutoff", type=float, default=80.0, help="Ha")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A cell with one width."""
    nitride = load_material(ROOT / "config" / "materials" / "silicon_nitride.yaml")
    dft = DftSettings(cutoff_Ha=given.cutoff)
    every = sorted({strain for width in WIDTHS for strain in five_strains(width)})
    for name, atoms in _cells(nitride, dft, given):
        cell = ScannedGlass(atoms, dft)
        reference = modulus_of_polynomial(*cell.curve(every), DEGREE)
        for width in WIDTHS:
            fit = fit_equation_of_state(*cell.curve(five_strains(width)))
            yield {
                "structure": name,
                "atoms": len(atoms),
                "largest_strain": width,
                "B_GPa": fit.B_GPa,
                "B_error_GPa": fit.B_error_GPa,
                "reference_B_GPa": reference,
                "off_percent": 100 * (fit.B_GPa / reference - 1),
                "residual_meV": fit.residual_meV,
                "flags": "; ".join(fit.flags),
            }


def _cells(nitride: Material, dft: DftSettings, given: Namespace) -> Iterator[tuple[str, Atoms]]:
    """The crystal's smallest cell, and relaxed glasses that are insulators."""
    yield "beta", crystal(nitride, "beta", (1, 1, 1))
    settings = NitrideGlassSettings(formula_units=given.formula_units, max_defects=2)
    seed = 0
    found = 0
    while found < given.glasses:
        seed += 1
        with tempfile.TemporaryDirectory() as work:
            quenched, attempts = make_glass(nitride, settings, seed, Path(work))
        if attempts[-1]["status"] != "accepted":
            continue
        calculator = make_calculator(dft, "GGA", quenched.cell.array * 1.02, forces=True)
        made = relaxed_structure(
            quenched,
            nitride.part("network_glass"),
            lambda engine=calculator: engine,
            dft.relaxation_steps,
        )
        if not made.reasons:
            found += 1
            yield f"glass {seed}", made.atoms


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Largest errors of both widths, and by how much the wider one is softer."""
    off = {
        width: {
            row["structure"]: float(row["off_percent"])
            for row in rows
            if float(row["largest_strain"]) == width
        }
        for width in (IN_USE, PAPER)
    }
    change = [off[PAPER][name] - off[IN_USE][name] for name in off[IN_USE]]
    return {
        "cells": str(len(change)),
        "in_use": f"{max(map(abs, off[IN_USE].values())):.1f} %",
        "paper": f"{max(map(abs, off[PAPER].values())):.1f} %",
        "change": f"{min(change):.1f} to {max(change):.1f} %",
    }
