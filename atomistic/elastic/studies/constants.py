"""Elastic constants of crystals beside published ones; the strains assume no symmetry, so its breach is an error."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from atomistic.elastic.tensor import Isotropic, isotropic
from atomistic.materials import Crystal

CUBIC, HEXAGONAL = range(195, 231), range(168, 195)
EQUIVALENT = {
    "cubic": {"C11": ("C22", "C33"), "C12": ("C13", "C23"), "C44": ("C55", "C66")},
    "hexagonal": {"C11": ("C22",), "C13": ("C23",), "C44": ("C55",)},
}


def symmetry(crystal: Crystal) -> str:
    """Which of the classes of EQUIVALENT a crystal belongs to; other classes are not told apart here."""
    return "cubic" if crystal.spacegroup in CUBIC else "hexagonal" if crystal.spacegroup in HEXAGONAL else "other"


def full_matrix(values_GPa: Mapping[str, float], kind: str) -> np.ndarray:
    """C of a cubic or hexagonal crystal from its independent constants, (6, 6)."""
    C = np.zeros((6, 6))
    every = dict(values_GPa)
    for name, others in EQUIVALENT[kind].items():
        every |= dict.fromkeys(others, values_GPa[name])
    if kind == "hexagonal":
        every["C66"] = 0.5 * (values_GPa["C11"] - values_GPa["C12"])
    for name, value in every.items():
        i, j = int(name[1]) - 1, int(name[2]) - 1
        C[i, j] = C[j, i] = value
    return C


def beside_published(report: Mapping[str, Any], crystal: Crystal) -> Iterator[dict[str, Any]]:
    """Rows of accuracy/elastic_constants.csv of one crystal.

    Parameters
    ----------
    report : of `Measured`, ions relaxed
    """
    kind = symmetry(crystal)
    if report["failure"] or kind == "other":
        return
    relaxed, clamped = (np.array(report[f"C_{ions}_GPa"]) for ions in ("relaxed", "clamped"))
    for published, known in crystal.constants.items():
        theirs = isotropic(full_matrix(known.values_GPa, kind))
        quantities = [
            (name, *(_constant(C, name, kind) for C in (relaxed, clamped)), value)
            for name, value in known.values_GPa.items()
        ]
        quantities += [
            (name, (_moduli(isotropic(relaxed))[name], None), (_moduli(isotropic(clamped))[name], None), value)
            for name, value in _moduli(theirs).items()
        ]
        for name, (value, breach), (stiff, _), their_value in quantities:
            yield {
                "structure": report["structure"],
                "atoms": report["atoms"],
                "quantity": name,
                "relaxed": value,
                "clamped": stiff,
                "breach": breach,
                "asymmetry_GPa": report["error_GPa"],
                "published": published,
                "published_value": their_value,
                "deviation": value / their_value - 1,
                "published_source": known.source,
            }


def _moduli(mean: Isotropic) -> dict[str, float]:
    return {"B": mean.B, "G": mean.G, "E": mean.E, "nu": mean.nu}


def _constant(C: np.ndarray, name: str, kind: str) -> tuple[float, float]:
    """Mean over the constants that symmetry makes equal, and how far apart they are."""
    same = [C[int(n[1]) - 1, int(n[2]) - 1] for n in (name, *EQUIVALENT[kind].get(name, ()))]
    if (kind, name) == ("hexagonal", "C66"):
        same.append(0.5 * (C[0, 0] - C[0, 1]))
    return float(np.mean(same)), float(np.ptp(same))
