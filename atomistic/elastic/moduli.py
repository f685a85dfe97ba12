"""The effective modulus E* with its uncertainty: from bulk moduli by E(V), or from elastic constants.

E = 3 B (1 − 2ν),   1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂          (Kim et al. 2013, eq. 5)
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from atomistic.elastic.tensor import poisson, young
from atomistic.materials import Material, Polycrystal
from atomistic.settings import ElasticSettings

MIN_STRUCTURES = 4  # trusted structures below which E* fails its gate: fewer say too little about their scatter
SIZE_ERROR = 0.02  # standard deviation of a factor on B and G for the size of the cell; the largest change measured
QUANTILES = (0.025, 0.16, 0.5, 0.84, 0.975)
IDEAL_NETWORKS = (
    "The glasses are quenched as ideal networks: every Si has four N and every N three Si. Films hold a few per cent "
    "of broken bonds, which may soften them: take B and E* for upper estimates."
)
BROKEN_BONDS = (
    "Up to {} atoms of a quenched cell may lack or exceed their valence. Cells without a gap are left out, so of the "
    "broken bonds only those without levels in the gap are represented."
)
CLAMPED_IONS = (
    "Ions clamped to fractional coordinates stiffen the glass: take E* for an upper estimate. Where elastic.poisson is "
    "'computed' they follow the strain."
)
ASSUMPTIONS = (
    "Poisson's ratio is computed: bulk and shear modulus of each structure come from its elastic constants.",
    "LDA scales bulk and shear modulus by one factor, that of the bulk modulus under clamped ions.",
    "Anisotropy is what a small cell leaves of the difference between Voigt's and Reuss's bounds. What its size "
    "changes beyond that is taken from larger cells of a crystal and of single glasses, not from an ensemble of them.",
)
SAMPLE_COLUMNS = {
    "e_star_GPa": ("GPa", "effective modulus E*"),
    "B_GPa": ("GPa", "bulk modulus of the glass"),
    "nu": ("1", "Poisson ratio of the glass"),
    "counter_E_GPa": ("GPa", "Young modulus of the counter body"),
    "xc": ("1", "functional: 0 GGA, 1 GGA + (LDA - GGA)"),
}
"""Unit and long name of each array of samples, as elastic/e_star.h5 states them."""
IONS = ("clamped", "relaxed")
PAPER = {"mean_GPa": 91.0, "std_GPa": 3.8, "source": "Kim et al. (2013), Table 1"}
EStar = tuple[dict[str, Any], dict[str, np.ndarray]]
"""Summary for `e_star.json` (with `inputs` and `gate`), and the arrays of SAMPLE_COLUMNS; none without structures."""


@dataclass(frozen=True)
class Modulus:
    """A bulk modulus that entered or was kept out of E*; `error_GPa` is its standard error by the misfit of its fit."""

    structure: str
    xc: str
    B_GPa: float
    trusted: bool
    reason: str = ""
    error_GPa: float = 0.0


def plane_strain_modulus(B_GPa, nu, other_E_GPa, other_nu):
    """E* of two bodies in GPa (eq. 5); arrays broadcast."""
    E = 3 * np.asarray(B_GPa) * (1 - 2 * np.asarray(nu))
    return 1 / ((1 - np.asarray(nu) ** 2) / E + (1 - np.asarray(other_nu) ** 2) / np.asarray(other_E_GPa))


def functional_shift(moduli: Sequence[Modulus]) -> dict[str, Any]:
    """LDA − GGA of the bulk modulus over the structures that have both: mean, spread, 95 % interval of the mean."""
    from scipy.stats import t

    by_xc = {xc: {m.structure: m.B_GPa for m in moduli if m.xc == xc and m.trusted} for xc in ("GGA", "LDA")}
    both = sorted(set(by_xc["GGA"]) & set(by_xc["LDA"]))
    differences = np.array([by_xc["LDA"][s] - by_xc["GGA"][s] for s in both])
    n = len(differences)
    if n == 0:
        return {"mean_GPa": float("nan"), "std_GPa": float("nan"), "interval_95_GPa": None, "structures": []}
    mean = float(differences.mean())
    std = float(differences.std(ddof=1)) if n > 1 else float("nan")
    half = float(t.ppf(0.975, n - 1) * std / np.sqrt(n)) if n > 1 else float("nan")
    return {"mean_GPa": mean, "std_GPa": std, "interval_95_GPa": [mean - half, mean + half], "structures": both}


def variance_shares(
    B_GPa: Sequence[float] | np.ndarray,
    B_error_GPa: Sequence[float] | np.ndarray,
    shift_GPa: float,
    nu: tuple[float, float],
    other_E: tuple[float, float],
    other_nu: float,
) -> dict[str, Any]:
    """Mean, standard deviation and first-order and total shares of the variance of E*, without sampling error.

    The five inputs are independent: structure (the ensemble, equal weights), the error of its fit (normal), functional
    (GGA or GGA + shift, equal weights), ν (uniform), E of the other body (normal).  Gauss quadrature makes a weighted
    grid on which the analysis of variance is exact.
    """
    B, B_error = np.asarray(B_GPa, float), np.asarray(B_error_GPa, float)
    normal, normal_weights = np.polynomial.hermite_e.hermegauss(5)
    nodes_nu, weights_nu = np.polynomial.legendre.leggauss(12)
    nodes_E, weights_E = np.polynomial.hermite_e.hermegauss(9)
    axes = {
        "structure": (np.arange(len(B)), np.full(len(B), 1 / len(B))),
        "fit": (normal, normal_weights / normal_weights.sum()),
        "functional": (np.array([0.0, shift_GPa]), np.full(2, 0.5)),
        "poisson_ratio": (0.5 * (nu[0] + nu[1]) + 0.5 * (nu[1] - nu[0]) * nodes_nu, weights_nu / 2),
        "counter_body": (other_E[0] + other_E[1] * nodes_E, weights_E / weights_E.sum()),
    }

    def e_star(structure, error, functional, nu, E):
        of_structure = B[structure.astype(int)] + error * B_error[structure.astype(int)]
        return plane_strain_modulus(of_structure + functional, nu, E, other_nu)

    return grid_shares(axes, e_star)


def grid_shares(axes: Mapping[str, tuple[np.ndarray, np.ndarray]], function: Callable[..., np.ndarray]):
    """Mean, standard deviation and first-order and total shares of the variance of a function of independent inputs.

    Parameters
    ----------
    axes : values and weights (adding to one) of each input; a grid of all of them makes the analysis exact
    """
    values, weights = zip(*axes.values(), strict=True)
    grid = np.asarray(function(*(axis.ravel() for axis in np.meshgrid(*values, indexing="ij"))))
    grid = grid.reshape([len(v) for v in values])

    def average(array: np.ndarray, over: Sequence[int]) -> np.ndarray:
        for axis in sorted(over, reverse=True):
            array = np.tensordot(array, weights[axis], (axis, 0))
        return array

    every = range(len(weights))
    mean = float(average(grid, every))
    variance = float(average((grid - mean) ** 2, every))
    shares = {}
    for axis, name in enumerate(axes):
        rest = [k for k in every if k != axis]
        first = float(weights[axis] @ (average(grid, rest) - mean) ** 2)
        without = (average(grid, [axis]) - mean) ** 2
        for k in sorted(range(len(rest)), reverse=True):
            without = np.tensordot(without, weights[rest[k]], (k, 0))
        shares[name] = {"first_order": first / variance, "total": 1 - float(without) / variance} if variance else {}
    return {"mean_GPa": mean, "std_GPa": float(np.sqrt(variance)), "shares": shares}


def effective_modulus(moduli: Sequence[Modulus], counter_body: Material, settings: ElasticSettings) -> EStar:
    """E* as a distribution: mixture of GGA and GGA shifted by LDA − GGA, ν uniform, counter body from experiment.

    Parameters
    ----------
    moduli : of the glasses (crystals do not belong here)
    counter_body : the other body, with its `polycrystal`
    """
    used = [m for m in moduli if m.xc == "GGA" and m.trusted]
    shift = functional_shift(moduli)
    other: Polycrystal = counter_body.part("polycrystal")
    low, high = settings.poisson_ratio
    summary: dict[str, Any] = {
        "ions": "clamped",
        "structures_used": [m.structure for m in used],
        "kept_out": [asdict(m) for m in moduli if not m.trusted],
        "B_GGA_GPa": spread([m.B_GPa for m in used]),
        "LDA_minus_GGA": shift,
        "poisson_ratio": {"distribution": "uniform", "a": low, "b": high},
        "counter_body": {
            "name": counter_body.name,
            "E_GPa": other.young_GPa,
            "E_std_GPa": other.young_std_GPa,
            "nu": other.poisson_ratio,
        },
        "paper": PAPER,
        "notes": [
            BROKEN_BONDS.format(settings.glass.max_defects) if settings.glass.max_defects else IDEAL_NETWORKS,
            CLAMPED_IONS,
        ],
        **_nothing(_gate(len(used), "a trusted clamped-ion GGA bulk modulus", shift)),
    }
    if not used:
        return summary, {}
    delta = shift["mean_GPa"] if shift["structures"] else 0.0
    B, B_error = np.array([(m.B_GPa, m.error_GPa) for m in used]).T
    others = (settings.poisson_ratio, (other.young_GPa, other.young_std_GPa), other.poisson_ratio)
    summary |= variance_shares(B, B_error, delta, *others)
    jackknife = float("nan")
    if len(B) > 1:
        left_out = [(np.delete(B, k), np.delete(B_error, k)) for k in range(len(B))]
        means = np.array([variance_shares(*pair, delta, *others)["mean_GPa"] for pair in left_out])
        jackknife = np.sqrt((len(B) - 1) / len(B) * np.sum((means - means.mean()) ** 2))
    rng = np.random.default_rng(np.random.SeedSequence([settings.seed, 51]))
    n = settings.samples
    lda = rng.integers(0, 2, n)
    drawn = rng.integers(0, len(B), n)
    B_samples = B[drawn] + delta * lda
    nu = rng.uniform(low, high, n)
    E = rng.normal(other.young_GPa, other.young_std_GPa, n)
    B_samples = B_samples + B_error[drawn] * rng.standard_normal(n)
    e_star = plane_strain_modulus(B_samples, nu, E, other.poisson_ratio)
    samples = {"e_star_GPa": e_star, "B_GPa": B_samples, "nu": nu, "counter_E_GPa": E, "xc": lda}
    return summary | _sampled(e_star, summary, jackknife), samples


def with_computed_poisson(
    by_literature: Mapping[str, Any],
    rows: Sequence[Mapping[str, str]],
    counter_body: Material,
    settings: ElasticSettings,
) -> EStar:
    """E* from the structures' own bulk and shear moduli, ions relaxed, so that Poisson's ratio is not assumed.

    Parameters
    ----------
    by_literature : what `effective_modulus` gives with Poisson's ratio from its range; kept beside the result
    rows : of elastic/isotropic_moduli.csv
    """
    other: Polycrystal = counter_body.part("polycrystal")
    trusted = {ions: [row for row in rows if row["ions"] == ions and not row["flags"]] for ions in IONS}
    columns = ("B_GPa", "G_GPa", "B_error_GPa", "G_error_GPa")
    pairs = {
        ions: np.array([[float(row[c]) for c in columns] for row in trusted[ions]]).reshape(-1, 4) for ions in IONS
    }
    used = pairs["relaxed"]
    shift, clamped_B = by_literature["LDA_minus_GGA"], by_literature["B_GGA_GPa"]["mean"]
    summary = {
        **by_literature,
        "ions": "relaxed",
        "structures_used": [row["structure"] for row in trusted["relaxed"]],
        "poisson_ratio": {"distribution": "computed", **spread(poisson(used[:, 0], used[:, 1]))},
        "isotropic_moduli": {
            ions: {
                "B_GPa": spread(p[:, 0]),
                "G_GPa": spread(p[:, 1]),
                "E_GPa": spread(young(p[:, 0], p[:, 1])),
                "nu": spread(poisson(p[:, 0], p[:, 1])),
            }
            for ions, p in pairs.items()
        },
        "by_literature_poisson": {
            key: by_literature.get(key)
            for key in ("mean_GPa", "std_GPa", "shares", "quantiles_GPa", "ions", "structures_used", "gate")
        },
        "notes": [by_literature["notes"][0], *ASSUMPTIONS],
        **_nothing(_gate(len(used), "trusted elastic constants", shift)),
    }
    if not len(used):
        return summary, {}
    factor = 1 + shift["mean_GPa"] / clamped_B if shift["structures"] else 1.0
    nodes, weights = np.polynomial.legendre.leggauss(8)
    normal, normal_weights = np.polynomial.hermite_e.hermegauss(9)

    def modulus(structure, anisotropy, size, functional, counter_E):
        B, G, B_error, G_error = used[np.asarray(structure, int)].T
        scale = functional * (1 + SIZE_ERROR * size)
        B, G = scale * (B + anisotropy * B_error).T, scale * (G + anisotropy * G_error).T
        return plane_strain_modulus(B, poisson(B, G), counter_E, other.poisson_ratio), B, G

    def shares(structures: np.ndarray) -> dict[str, Any]:
        axes = {
            "structure": (structures, np.full(len(structures), 1 / len(structures))),
            "anisotropy": (nodes, weights / 2),  # uniform between the bounds
            "size": (normal, normal_weights / normal_weights.sum()),
            "functional": (np.array([1.0, factor]), np.full(2, 0.5)),
            "counter_body": (other.young_GPa + other.young_std_GPa * normal, normal_weights / normal_weights.sum()),
        }
        return grid_shares(axes, lambda *values: modulus(*values)[0])

    summary |= shares(np.arange(len(used)))
    sound = np.array([k for k, row in enumerate(trusted["relaxed"]) if not row["doubts"]], int)
    if len(sound) < len(used):
        without = shares(sound) if len(sound) else {}
        pair = {key: without.get(key) for key in ("mean_GPa", "std_GPa")}
        summary["without_doubtful"] = {"structures": len(sound), **pair}
        summary["notes"].append(_on_doubtful(trusted["relaxed"], without))
    rng = np.random.default_rng(np.random.SeedSequence([settings.seed, 52]))
    n = settings.samples
    lda = rng.integers(0, 2, n)
    counter = rng.normal(other.young_GPa, other.young_std_GPa, n)
    structure, anisotropy, size = rng.integers(0, len(used), n), rng.uniform(-1, 1, n), rng.standard_normal(n)
    e_star, B, G = modulus(structure, anisotropy, size, np.where(lda, factor, 1.0), counter)
    means = [modulus(k, 0.0, 0.0, 0.5 * (1 + factor), other.young_GPa)[0] for k in range(len(used))]
    error = np.std(means, ddof=1) / np.sqrt(len(used)) if len(used) > 1 else float("nan")
    samples = {"e_star_GPa": e_star, "B_GPa": B, "nu": poisson(B, G), "counter_E_GPa": counter, "xc": lda}
    return summary | _sampled(e_star, summary, error), samples


def _gate(structures: int, what: str, shift: Mapping[str, Any]) -> dict[str, Any]:
    """Whether E* is to be trusted, and why not."""
    reasons = []
    if structures < MIN_STRUCTURES:
        reasons.append(f"{structures} amorphous structures with {what}, {MIN_STRUCTURES} are needed")
    if not shift["structures"]:
        reasons.append("no structure has both LDA and GGA: the model-form shift is unknown")
    return {"passed": not reasons, "reasons": reasons}


def _nothing(gate: Mapping[str, Any]) -> dict[str, Any]:
    """What a summary says of E* without any structure."""
    return {"mean_GPa": float("nan"), "std_GPa": float("nan"), "inputs": {}, "gate": gate}


def _sampled(e_star: np.ndarray, summary: Mapping[str, Any], standard_error: float) -> dict[str, Any]:
    """What the samples add to a summary."""
    return {
        "quantiles_GPa": dict(zip(map(str, QUANTILES), np.quantile(e_star, QUANTILES).tolist(), strict=True)),
        "standard_error_of_mean_GPa": float(standard_error),
        "inputs": {"e_star": {"distribution": "normal", "a": summary["mean_GPa"], "b": summary["std_GPa"]}},
    }


def _on_doubtful(rows: Sequence[Mapping[str, str]], sound: Mapping[str, Any]) -> str:
    """What to say of cells that are no insulating glass at rest, and of E* without them."""
    said = ", ".join(f"{row['structure']} ({row['doubts']})" for row in rows if row["doubts"])
    without = (
        f"Without them it is {sound['mean_GPa']:.1f} ± {sound['std_GPa']:.1f} GPa" if sound else "None is left without"
    )
    return f"Cells that are no insulating glass when they are at rest: {said}. They are in E*. {without}."


def spread(values: Sequence[float] | np.ndarray) -> dict[str, Any]:
    """Mean, standard deviation and number of values of structures; None where there are too few."""
    array = np.array(values, float)
    return {
        "mean": float(array.mean()) if len(array) else None,
        "std": float(array.std(ddof=1)) if len(array) > 1 else None,
        "structures": len(array),
    }
