"""The effective modulus E* with its uncertainty, from bulk moduli and a range of Poisson's ratio.

E = 3 B (1 − 2ν),   1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂          (Kim et al. 2013, eq. 5)
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import reduce
from typing import Any

import numpy as np

from atomistic.materials import Material, NetworkGlass, Polycrystal
from atomistic.settings import ElasticSettings

SAMPLE_COLUMNS = {
    "e_star_GPa": ("GPa", "effective modulus E*"),
    "B_GPa": ("GPa", "bulk modulus of the glass"),
    "nu": ("1", "Poisson ratio of the glass"),
    "counter_E_GPa": ("GPa", "Young modulus of the counter body"),
    "xc": ("1", "functional: 0 GGA, 1 GGA + (LDA - GGA)"),
}
"""Unit and long name of each array of samples, as elastic/e_star.h5 states them."""
SAMPLES = 20_000
"""Samples of E*, of which its quantiles and the page are made."""


@dataclass(frozen=True)
class Modulus:
    """A bulk modulus in or out of E*; `error_GPa`: standard error by its fit's misfit."""

    structure: str
    xc: str
    B_GPa: float
    trusted: bool
    reason: str = ""
    error_GPa: float = 0.0


def plane_strain_modulus(B_GPa, nu, other_E_GPa, other_nu):
    """E* of two bodies in GPa (eq. 5); arrays broadcast."""
    E = 3 * np.asarray(B_GPa) * (1 - 2 * np.asarray(nu))
    compliance = (1 - np.asarray(nu) ** 2) / E
    other_compliance = (1 - np.asarray(other_nu) ** 2) / np.asarray(other_E_GPa)
    return 1 / (compliance + other_compliance)


def share_of_glass(summary: Mapping[str, Any]) -> float:
    """Relative change of E* over that of the glass's bulk modulus.

    Parameters
    ----------
    summary : of `effective_modulus`.
    """
    other = summary["counter_body"]
    return 1.0 - summary["mean_GPa"] * (1 - other["nu"] ** 2) / other["E_GPa"]


def functional_shift(moduli: Sequence[Modulus]) -> dict[str, Any]:
    """LDA − GGA of the bulk modulus over the structures that have both: mean and spread."""
    trusted = [modulus for modulus in moduli if modulus.trusted]
    by_xc = {}
    for xc in ("GGA", "LDA"):
        by_xc[xc] = {modulus.structure: modulus.B_GPa for modulus in trusted if modulus.xc == xc}
    both = sorted(set(by_xc["GGA"]) & set(by_xc["LDA"]))
    differences = np.array([by_xc["LDA"][s] - by_xc["GGA"][s] for s in both])
    mean = float("nan")
    std = float("nan")
    if both:
        mean = float(differences.mean())
    if len(both) > 1:
        std = float(differences.std(ddof=1))
    return {"mean_GPa": mean, "std_GPa": std, "structures": both}


def mean_and_deviation(
    B_GPa: Sequence[float] | np.ndarray,
    B_error_GPa: Sequence[float] | np.ndarray,
    shift_GPa: float,
    nu: tuple[float, float],
    other_E: tuple[float, float],
    other_nu: float,
    ions: tuple[float, float] = (1.0, 0.0),
) -> tuple[float, float]:
    """Mean and standard deviation of E*, GPa, without sampling error.

    The inputs are independent: structure (the ensemble, equal weights), the error of its fit
    (normal), functional (GGA or GGA + shift, equal weights), ions that follow the strain (a normal
    factor on B), ν (uniform), E of the other body (normal).  Gauss quadrature makes a weighted grid
    of them.
    """
    B = np.asarray(B_GPa, float)
    B_error = np.asarray(B_error_GPa, float)
    normal, normal_weights = np.polynomial.hermite_e.hermegauss(5)
    nodes_nu, weights_nu = np.polynomial.legendre.leggauss(12)
    nodes_E, weights_E = np.polynomial.hermite_e.hermegauss(9)
    axes = (  # values and weights
        (np.arange(len(B)), np.full(len(B), 1 / len(B))),
        (normal, normal_weights),
        (np.array([0.0, shift_GPa]), np.full(2, 0.5)),
        (ions[0] + ions[1] * normal, normal_weights),
        (0.5 * (nu[0] + nu[1]) + 0.5 * (nu[1] - nu[0]) * nodes_nu, weights_nu),
        (other_E[0] + other_E[1] * nodes_E, weights_E),
    )
    values, weights = zip(*axes, strict=True)
    structure, error, functional, follow, ratio, E = np.meshgrid(*values, indexing="ij")
    of_structure = B[structure.astype(int)] + error * B_error[structure.astype(int)]
    grid = plane_strain_modulus((of_structure + functional) * follow, ratio, E, other_nu)
    weight = reduce(np.multiply.outer, weights)
    mean = np.average(grid, weights=weight)
    variance = np.average((grid - mean) ** 2, weights=weight)
    return float(mean), float(np.sqrt(variance))


def effective_modulus(
    moduli: Sequence[Modulus], material: Material, counter_body: Material, settings: ElasticSettings
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """E* as a distribution: GGA mixed with GGA + (LDA − GGA), ν uniform, counter body measured.

    Scans clamp the ions. Where the material states how much those that follow soften it, B is
    corrected.

    Parameters
    ----------
    moduli : of the glasses (crystals do not belong here)
    material : the computed body, with its `network_glass`
    counter_body : the other body, with its `polycrystal`

    Returns
    -------
    Content of e_star.json, with `inputs` and `gate`, and the arrays of SAMPLE_COLUMNS; none without
    structures.
    """
    used = [m for m in moduli if m.xc == "GGA" and m.trusted]
    shift = functional_shift(moduli)
    other: Polycrystal = counter_body.part("polycrystal")
    low, high = settings.poisson_ratio
    glass: NetworkGlass = material.part("network_glass")
    films = _moduli_of_films(material, other)
    summary: dict[str, Any] = {
        "ions": "follow, by a stated factor" if glass.ions_follow else "clamped",
        "films_GPa": films,
        "structures_used": [m.structure for m in used],
        "kept_out": [asdict(m) for m in moduli if not m.trusted],
        "LDA_minus_GGA": shift,
        "poisson_ratio": {"distribution": "uniform", "a": low, "b": high},
        "counter_body": {
            "name": counter_body.name,
            "E_GPa": other.young_GPa,
            "E_std_GPa": other.young_std_GPa,
            "nu": other.poisson_ratio,
        },
        "paper": {"mean_GPa": 91.0, "std_GPa": 3.8, "source": "Kim et al. (2013), Table 1"},
        "notes": _notes(settings.glass.max_defects, glass.ions_follow, films),
        "mean_GPa": float("nan"),
        "std_GPa": float("nan"),
        "inputs": {},
        "gate": _gate(len(used), shift),
    }
    if not used:
        return summary, {}
    shift_GPa = shift["mean_GPa"] if shift["structures"] else 0.0
    follow = glass.ions_follow or (1.0, 0.0)
    B = [modulus.B_GPa for modulus in used]
    B_error = [modulus.error_GPa for modulus in used]
    ranges = (settings.poisson_ratio, (other.young_GPa, other.young_std_GPa), other.poisson_ratio)
    summary["clamped_GPa"], _ = mean_and_deviation(B, B_error, shift_GPa, *ranges)
    mean, deviation = mean_and_deviation(B, B_error, shift_GPa, *ranges, follow)
    summary["mean_GPa"] = mean
    summary["std_GPa"] = deviation
    samples = _samples(used, shift_GPa, follow, other, settings)
    quantiles = (0.025, 0.16, 0.5, 0.84, 0.975)
    values = np.quantile(samples["e_star_GPa"], quantiles).tolist()
    summary["quantiles_GPa"] = dict(zip(map(str, quantiles), values, strict=True))
    summary["inputs"] = {"e_star": {"distribution": "normal", "a": mean, "b": deviation}}
    return summary, samples


def _moduli_of_films(material: Material, other: Polycrystal) -> dict[str, list[float]]:
    """E* (GPa, lowest and highest) of the material's measured films on the other body."""
    moduli: dict[str, list[float]] = {}
    for name, film in material.films.items():
        B_film = np.array(film.young_GPa) / (3 - 6 * np.array(film.poisson_ratio))
        e_star = plane_strain_modulus(
            B_film, film.poisson_ratio, other.young_GPa, other.poisson_ratio
        )
        moduli[name] = e_star.tolist()
    return moduli


def _samples(
    used: Sequence[Modulus],
    shift_GPa: float,
    follow: tuple[float, float],
    other: Polycrystal,
    settings: ElasticSettings,
) -> dict[str, np.ndarray]:
    """The arrays of SAMPLE_COLUMNS, drawn as `mean_and_deviation` weighs them."""
    B = np.array([modulus.B_GPa for modulus in used])
    B_error = np.array([modulus.error_GPa for modulus in used])
    low, high = settings.poisson_ratio
    rng = np.random.default_rng(np.random.SeedSequence([settings.seed, 51]))
    lda = rng.integers(0, 2, SAMPLES)
    structure = rng.integers(0, len(B), SAMPLES)
    nu = rng.uniform(low, high, SAMPLES)
    E = rng.normal(other.young_GPa, other.young_std_GPa, SAMPLES)
    B_samples = B[structure] + shift_GPa * lda
    B_samples = B_samples + B_error[structure] * rng.standard_normal(SAMPLES)
    B_samples *= follow[0] + follow[1] * rng.standard_normal(SAMPLES)
    return {
        "e_star_GPa": plane_strain_modulus(B_samples, nu, E, other.poisson_ratio),
        "B_GPa": B_samples,
        "nu": nu,
        "counter_E_GPa": E,
        "xc": lda,
    }


def _notes(
    max_defects: int, follow: tuple[float, float] | None, films: Mapping[str, Sequence[float]]
) -> list[str]:
    """What the numbers leave out, for the page."""
    notes = [
        "The glasses are quenched as ideal networks: every Si has four N and every N three Si."
        " Films hold a few per cent of broken bonds, which may soften them: take B and E* for"
        " upper estimates."
    ]
    if max_defects:
        notes = [
            f"Up to {max_defects} atoms of a quenched cell may lack or exceed their valence."
            " Cells without a gap are left out, so of the broken bonds only those without levels"
            " in the gap are represented."
        ]
    if follow is not None:
        notes.append(
            f"Scans clamp the ions; those that follow a strain have {follow[0]:g} ± {follow[1]:g}"
            " of that bulk modulus."
        )
    else:
        notes.append(
            "Ions clamped to fractional coordinates stiffen the glass: take E* for an upper"
            " estimate."
        )
    if films:
        measured = "; ".join(
            f"{name} {low:.0f} to {high:.0f}" for name, (low, high) in films.items()
        )
        notes.append(
            "The glass has no hydrogen, no pores and no excess of silicon. By measured moduli, E*"
            f" of films is in GPa: {measured}. For such a film state it as inputs.e_star."
        )
    return notes


def _gate(structures: int, shift: Mapping[str, Any]) -> dict[str, Any]:
    """Whether E* is to be trusted, and why not."""
    # fewer say too little about their scatter
    reasons = []
    needed = 4
    if structures < needed:
        reasons.append(
            f"{structures} amorphous structures with a trusted clamped-ion GGA bulk modulus,"
            f" {needed} are needed"
        )
    if not shift["structures"]:
        reasons.append("no structure has both LDA and GGA: the model-form shift is unknown")
    return {"passed": not reasons, "reasons": reasons}
