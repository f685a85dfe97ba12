"""Do elastic constants of known crystals agree with published ones?

β-Si3N4 (42 atoms) and silicon (54 atoms) with PBE, ions clamped and relaxed.  The strains assume no symmetry: `breach`
is how far apart constants are that symmetry makes equal.  B, G, E and ν are those of the isotropic polycrystal (Hill).
Half an hour of one core.  The first rows were copied from a page of their commit, to the digits that it gave.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from atomistic.elastic.constants import Measured, measure_constants
from atomistic.elastic.dft import PyscfGamma, TwoMeshes, make_calculator
from atomistic.elastic.networks import crystal
from atomistic.elastic.tensor import isotropic
from atomistic.materials import Crystal, load_materials
from atomistic.settings import DftSettings
from evidence.record import ROOT

CUBIC, HEXAGONAL = range(195, 231), range(168, 195)
EQUIVALENT = {
    "cubic": {"C11": ("C22", "C33"), "C12": ("C13", "C23"), "C44": ("C55", "C66")},
    "hexagonal": {"C11": ("C22",), "C13": ("C23",), "C44": ("C55",)},
}
ISOTROPIC = ("B", "G", "E", "nu")


def arguments(parser: ArgumentParser) -> None:
    """Which crystals."""
    parser.add_argument("--crystals", nargs="+", default=["beta", "silicon"])


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A constant or modulus of a crystal beside a published value."""
    for material in load_materials(ROOT / "config" / "materials").values():
        for name in (name for name in material.crystals if name in given.crystals):
            data = material.crystals[name]
            cell = data.constants_cell or data
            atoms = crystal(material, name, cell.supercell)
            engine = make_calculator(DftSettings(), "GGA", atoms.cell.array * 1.03, None, cell.cutoff_Ha, forces=True)
            assert isinstance(engine, PyscfGamma)
            yield from beside_published(name, measure_constants(atoms, TwoMeshes(engine)), data)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """The isotropic moduli of β-Si3N4 and their deviation from Brillouin scattering."""
    beta = {row["quantity"]: row for row in rows if (row["structure"], row["published"]) == ("beta", "experiment")}
    silicon = {row["quantity"]: row for row in rows if (row["structure"], row["published"]) == ("silicon", "GGA")}
    values = {key: (float(row["relaxed"]), float(row["published_value"])) for key, row in beta.items()}
    return {
        **{f"beta_{key}": f"{100 * (values[key][0] / values[key][1] - 1):+.0f} %" for key in ("B", "G", "E")},
        "beta_nu": f"{values['nu'][0] - values['nu'][1]:+.3f}",
        "silicon_G": f"{100 * (float(silicon['G']['relaxed']) / float(silicon['G']['published_value']) - 1):+.0f} %",
        "softening_G": f"{100 * (1 - values['G'][0] / float(beta['G']['clamped'])):.0f} %",
    }


def beside_published(name: str, measured: Measured, data: Crystal) -> Iterator[dict[str, Any]]:
    """Rows of one crystal; none where its constants could not be measured."""
    kind = "cubic" if data.spacegroup in CUBIC else "hexagonal" if data.spacegroup in HEXAGONAL else "other"
    if measured.response is None or kind == "other":
        return
    relaxed, clamped = measured.response.relaxed, measured.response.clamped.C
    for published, known in data.constants.items():
        theirs = isotropic(full_matrix(known.values_GPa, kind))
        expected = {**known.values_GPa, **{key: getattr(theirs, key) for key in ISOTROPIC}}
        for quantity, value in expected.items():
            ours, stiff = (_values(C, quantity, kind) for C in (relaxed, clamped))
            yield {
                "structure": name,
                "atoms": len(measured.atoms),
                "quantity": quantity,
                "relaxed": np.mean(ours),
                "clamped": np.mean(stiff),
                "breach": np.ptp(ours),
                "published": published,
                "published_value": value,
                "published_source": known.source,
            }


def full_matrix(values_GPa: Mapping[str, float], kind: str) -> np.ndarray:
    """C of a cubic or hexagonal crystal from its independent constants, (6, 6)."""
    every = dict(values_GPa)
    for name, others in EQUIVALENT[kind].items():
        every |= dict.fromkeys(others, values_GPa[name])
    if kind == "hexagonal":
        every["C66"] = 0.5 * (values_GPa["C11"] - values_GPa["C12"])
    C = np.zeros((6, 6))
    for name, value in every.items():
        i, j = int(name[1]) - 1, int(name[2]) - 1
        C[i, j] = C[j, i] = value
    return C


def _values(C: np.ndarray, quantity: str, kind: str) -> list[float]:
    """A quantity of a matrix of constants: a modulus, or the constants that symmetry makes equal."""
    if quantity in ISOTROPIC:
        return [getattr(isotropic(C), quantity)]
    same = [float(C[int(n[1]) - 1, int(n[2]) - 1]) for n in (quantity, *EQUIVALENT[kind].get(quantity, ()))]
    if (kind, quantity) == ("hexagonal", "C66"):
        same.append(0.5 * float(C[0, 0] - C[0, 1]))
    return same
