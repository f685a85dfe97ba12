"""The prediction of an indentation: 500 nm of thermal silica on silicon, P/S2 against depth, with
nothing fitted.

Prints the numbers of evidence/predictions/indentation.yaml. P/S2 needs no area function. The
contact pressure is the law of films. The stiffness is that of a rigid circular punch on elastic
layers, by the integral equation of its pressure (Sneddon, Mixed Boundary Value Problems in
Potential Theory, 1966, chapter 4). The depth is h_c + 0.75 P/S (Oliver and Pharr, J. Mater. Res. 7
(1992) 1564), with the area 24.5 h_c^2 of a Berkovich tip.
"""

import json
import sys
from pathlib import Path

import numpy as np

from atomistic.hardness.size_effect import BERKOVICH
from evidence.hardness.films import SAMPLES
from evidence.predictions.score import LEVELS
from mesoscale.contact.coupled.layers import base_modulus, softness
from mesoscale.inputs.hardness import HardnessLaw
from mesoscale.settings.contact import MaterialSettings

DEPTHS_NM = (50.0, 100.0, 200.0, 300.0, 500.0, 600.0, 1000.0, 1500.0)
DRAWS = 400
TIP = MaterialSettings(young_GPa=1141.0, poisson=0.07)  # diamond, Oliver and Pharr 1992
FACE = 24.5  # area of a Berkovich tip over the square of the contact depth


def stiffness_GPa(
    silica_GPa: float, silicon_GPa: float, thickness_nm: float, half_width_nm: np.ndarray
) -> np.ndarray:
    """E_r of contacts on the film."""
    film = MaterialSettings(young_GPa=silica_GPa, poisson=0.17, thickness_nm=thickness_nm)
    bodies = ((film, MaterialSettings(young_GPa=silicon_GPa, poisson=0.22)), (TIP,))
    q = np.linspace(1e-4, 10.0, 600) / thickness_nm  # beyond, the base is not felt
    compliance = softness(bodies, q) / base_modulus(bodies)
    excess, distance = (
        compliance / compliance[-1] - 1.0,
        np.linspace(0.0, 2.0 * half_width_nm.max(), 2000),
    )
    kernel = np.trapezoid(excess * np.cos(np.outer(distance, q)), q, axis=1) / np.pi
    nodes, weights = np.polynomial.legendre.leggauss(48)
    found = []
    for a in half_width_nm:
        place, weight = 0.5 * a * (1.0 + nodes), 0.5 * a * weights
        apart = np.abs(np.subtract.outer(place, place)), np.add.outer(place, place)
        matrix = np.eye(nodes.size) + sum(np.interp(d, distance, kernel) for d in apart) * weight
        found.append(weight @ np.linalg.solve(matrix, np.ones(nodes.size)) / a)
    return np.array(found) / compliance[-1]


def curve(draw: dict[str, float]) -> np.ndarray:
    """P/S2 (1e-3/GPa) at the depths."""
    half_width = np.geomspace(10.0, 6e3, 80)
    area = np.pi * half_width**2
    load = area * HardnessLaw.of(draw).pressure(area)
    e_r = stiffness_GPa(draw["silica_GPa"], draw["silicon_GPa"], draw["t_film"], half_width)
    stiffness = 2.0 * draw["beta"] * e_r * half_width
    depth = np.sqrt(area / FACE) + 0.75 * load / stiffness
    return np.interp(DEPTHS_NM, depth, 1e3 * load / stiffness**2)


def draws(fit: Path) -> list[dict[str, float]]:
    """Inputs: the film's hardness at the tip's slope from a finished hardness stage, k and m as
    scenes have them.
    """
    film, rng = json.loads(fit.read_text())["inputs"]["h_film"], np.random.default_rng(0)
    factor = np.interp(
        np.log(BERKOVICH), np.log(film["steepness"]["rms_slope"]), film["steepness"]["factor"]
    )
    joint = np.loadtxt(SAMPLES, delimiter=",", skiprows=3)  # two lines of comment, and the names
    return [
        {
            "h_film": factor * rng.choice(film["values"]),
            "h_macro": rng.normal(12.0, 0.5),
            "t_film": rng.normal(500.0, 15.0),
            **dict(zip(("k_film", "m_film"), row, strict=True)),
            "silica_GPa": rng.normal(72.0, 2.0),
            "silicon_GPa": rng.normal(165.0, 5.0),
            "beta": rng.uniform(1.02, 1.08),
        }
        for row in rng.choice(joint, DRAWS)
    ]


if __name__ == "__main__":
    curves = np.array([curve(draw) for draw in draws(Path(sys.argv[1]))])
    for at, values in zip(DEPTHS_NM, np.quantile(curves, LEVELS, axis=0).T, strict=True):
        print(
            f"  - {{at: {at:g} nm, quantiles: [{', '.join(f'{value:.3f}' for value in values)}]}}"
        )
