"""Size dependence of hardness, H(A) = H_macro + H' A^-0.25 (Kim et al. 2013, eq. 4).

A reduced series of sizes cannot identify both parameters, so two fits stand side by side: the default takes
H_macro from its literature range and H' = (H - H_macro) A^0.25 from every MD point; the free fit takes both
from the points.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.special import stdtrit
from scipy.stats import rankdata

from atomistic.settings import FitSettings

INTERVAL = (0.16, 0.84)  # 68 %, as in the paper
SHAPES_ALIKE = 0.1  # amplitudes over wavelength that differ by less than this part are of one shape
MIN_POINTS, MIN_SHARE = 6, 0.5  # defended points needed, and their share of the runs
BOOTSTRAP = 2000
# What moves every run of a scene alike, as standard deviations relative to the hardness (study `hardness.choices`)
SYSTEMATIC = {
    "rate": 0.05,  # closing speed in use against rest
    "base": 0.04,  # base in use against a thicker one
    "potential": 0.1,  # one potential of silica against another
    "shape": 0.23,  # asperities half and twice as steep as those in use
}
Point = Mapping[str, str]


def fit_size_effect(
    points: Sequence[Point],
    glasses: Sequence[Mapping],
    fit: FitSettings,
    energy_scales: Sequence[float],
    area_error: float,
    others: Mapping[str, float] = SYSTEMATIC,
) -> dict:
    """Fit both ways, with 68 % intervals by bootstrap over runs, and judge whether the fit may be used.

    Parameters
    ----------
    points : rows of points.csv.
    glasses : properties of the glasses, each with its gate.
    area_error : largest error of the contact area by its calibration, as a fraction.
    others : errors that all runs share, as standard deviations relative to the hardness.

    Returns
    -------
    Content of fit.json (docs/hardness.md).
    """
    used = [point for point in points if point["status"] == "yield"]
    refused = [{"run": point["run"], "status": point["status"]} for point in points if point["status"] != "yield"]
    reasons = [reason for glass in glasses for reason in glass["gate"]["reasons"]]
    if len(used) < MIN_POINTS:
        reasons.append(f"{len(used)} of {len(points)} runs gave a defended hardness, {MIN_POINTS} are needed")
    elif len(used) < MIN_SHARE * len(points):
        reasons.append(f"only {len(used)} of {len(points)} runs gave a defended hardness (gate {MIN_SHARE:.0%})")
    scales = {float(point["energy_scale"]) for point in used}
    if missing := sorted(set(energy_scales) - scales):
        reasons.append(f"no defended hardness at energy scale {', '.join(f'{scale:g}' for scale in missing)}")
    result: dict = {
        "method": fit.h_macro,
        "points_used": len(used),
        "points_total": len(points),
        "points_rejected": refused,
        "cost": cost_of(points),
        "inputs": {},
        "gate": {"passed": False, "reasons": reasons},
    }
    if len(used) < 2:
        result["gate"]["reasons"] = reasons or ["fewer than two points"]
        return result
    free = {"together": used} | _by_scale(used)
    result["free_fit"] = {name: free_fit(group) for name, group in free.items()}
    result["halved_over_full"] = scale_ratios(used)
    result["size_effect_at_one_shape"] = same_shape_exponents(points)
    # the error of the area lies anywhere within that of its calibration: a uniform distribution
    systematic = {"area": area_error / np.sqrt(3), **others}
    h_macro, h_prime, h_film = literature_samples(used, fit.h_macro_GPa, systematic)
    if fit.h_macro == "free":
        h_macro, h_prime = free_samples(used, systematic)
    result["inputs"] = {
        "h_macro": {"distribution": "uniform", **_range(h_macro, fit), "unit": "GPa"},
        "h_prime": {
            "distribution": "uniform",
            "a": float(np.quantile(h_prime, INTERVAL[0])),
            "b": float(np.quantile(h_prime, INTERVAL[1])),
            "unit": "GPa nm^0.5",
            "correlation": {"h_macro": spearman(h_macro, h_prime)},
        },
        "h_film": {
            "distribution": "uniform",
            "a": float(np.quantile(h_film, INTERVAL[0])),
            "b": float(np.quantile(h_film, INTERVAL[1])),
            "unit": "GPa",
        },
    }
    result["H_macro_GPa"] = summary(h_macro)
    result["H_prime_GPa_nm0.5"] = summary(h_prime)
    result["budget"] = variance_budget(used, fit.h_macro_GPa, systematic)
    result["curve"] = band(h_macro, h_prime, result["budget"]["statistical"]["std"])
    if result["inputs"]["h_prime"]["a"] <= 0 or result["inputs"]["h_macro"]["a"] <= 0:
        reasons.append("the fit allows a hardness that falls with decreasing size or is negative: not identifiable")
    result["gate"] = {"passed": not reasons, "reasons": reasons}
    return result


def cost_of(points: Sequence[Point]) -> dict[str, float]:
    """What the runs took, and the share of the Python around LAMMPS in it."""
    total = {key: sum(float(point[key]) for point in points) for key in ("atom_steps", "lammps_cpu_s", "python_cpu_s")}
    return {**total, "python_cpu_share": total["python_cpu_s"] / (total["lammps_cpu_s"] + total["python_cpu_s"])}


def literature_samples(
    points: Sequence[Point], h_macro_GPa: tuple[float, float], systematic: Mapping[str, float], count: int = BOOTSTRAP
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Joint samples of H_macro (uniform in its range), H' and the hardness (from the points, energy scales alike)."""
    rng = _rng(11)
    hardness, spread, length, scale = _columns(points)
    scales = np.unique(scale)
    weight = np.array([1 / np.sum(scale == one) for one in scale]) / len(scales)
    chosen = rng.choice(len(points), size=count, p=weight)
    h_macro = rng.uniform(*h_macro_GPa, count)
    drawn = (hardness[chosen] + spread[chosen] * rng.normal(size=count)) * _shared(systematic, count)
    return h_macro, (drawn - h_macro) * np.sqrt(length[chosen]), drawn


def free_samples(points: Sequence[Point], systematic: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Bootstrap over runs of the straight line H against A^-0.25."""
    rng = _rng(12)
    hardness, spread, length, _ = _columns(points)
    x = 1 / np.sqrt(length)
    chosen = rng.integers(0, len(points), (BOOTSTRAP, len(points)))
    shared = _shared(systematic, BOOTSTRAP)[:, None]
    drawn = (hardness[chosen] + spread[chosen] * rng.normal(size=chosen.shape)) * shared
    x = x[chosen]
    varies = np.ptp(x, axis=1) > 1e-6
    x, drawn = x[varies], drawn[varies]
    centred = x - x.mean(axis=1, keepdims=True)
    h_prime = np.sum(centred * drawn, axis=1) / np.sum(centred**2, axis=1)
    return drawn.mean(axis=1) - h_prime * x.mean(axis=1), h_prime


def _shared(systematic: Mapping[str, float], count: int) -> np.ndarray:
    """Factors on the hardness of all runs alike, one for each bootstrap sample."""
    draws = _rng(15).normal(size=(len(systematic), count))
    return 1 + np.array(list(systematic.values())) @ draws


def variance_budget(points: Sequence[Point], h_macro_GPa: tuple[float, float], systematic: Mapping[str, float]) -> dict:
    """Standard deviations of H' at H_macro of the literature, by source, in GPa nm^0.5.

    The runs are split by the law of total variance: between the energy scales, between the asperities of a scale,
    between the seeds of an asperity, and within a run.  Only the last two are scatter that more runs would average.
    """
    hardness, spread, length, scale = _columns(points)
    root, middle = np.sqrt(length), float(np.mean(h_macro_GPa))
    h_prime = (hardness - middle) * root
    asperity = np.array([point["asperity"] for point in points])
    between = {"energies": 0.0, "size": 0.0, "seed": 0.0, "run": 0.0}
    scales, weight = np.unique(scale), 1 / len(np.unique(scale))
    means = np.array([np.mean(h_prime[scale == one]) for one in scales])
    between["energies"] = float(np.var(means))
    for one, mean in zip(scales, means, strict=True):
        of_scale = scale == one
        for name in np.unique(asperity[of_scale]):
            group = of_scale & (asperity == name)
            share = weight * np.sum(group) / np.sum(of_scale)
            between["size"] += share * float(np.mean(h_prime[group]) - mean) ** 2
            between["seed"] += share * float(np.var(h_prime[group]))
        between["run"] += weight * float(np.mean((spread[of_scale] * root[of_scale]) ** 2))
    alike = np.array([weight / np.sum(scale == one) for one in scale])
    squares = float(np.sum(alike * (hardness * root) ** 2))
    shared = {name: deviation**2 * squares for name, deviation in systematic.items()}
    macro = float(np.ptp(h_macro_GPa) ** 2 / 12 * np.sum(alike * root) ** 2)
    statistical = {name: between.pop(name) for name in ("seed", "run")}
    parts = {"statistical": statistical, "systematic": {**between, **shared, "h_macro": macro}}
    total = sum(sum(part.values()) for part in parts.values())
    return {
        "unit": "GPa nm^0.5",
        "std": float(np.sqrt(total)),
        **{
            kind: {
                "std": float(np.sqrt(sum(part.values()))),
                "share": sum(part.values()) / total,
                "sources": {name: float(np.sqrt(variance)) for name, variance in part.items()},
            }
            for kind, part in parts.items()
        },
    }


def free_fit(points: Sequence[Point]) -> dict:
    """Both parameters from the points, with intervals; `identifiable` if both intervals are positive."""
    if len({point["contact_length_nm"] for point in points}) < 3:
        return {"points": len(points), "identifiable": False}
    h_macro, h_prime = free_samples(points, {})
    macro, prime = summary(h_macro), summary(h_prime)
    return {
        "points": len(points),
        "H_macro_GPa": macro,
        "H_prime_GPa_nm0.5": prime,
        "identifiable": bool(macro["low"] > 0 and prime["low"] > 0),
    }


def same_shape_exponents(points: Sequence[Point]) -> dict:
    """n in H ~ L^-n between runs whose contact takes up the same share of the wavelength, with its 68 % interval.

    There the runs of one shape differ by nothing but their size.  All that reached that share count, also those that
    the rule on n refuses.  Straight line through the logarithms, Student's t from the scatter about it.

    Returns
    -------
    by energy scale; empty for asperities of several shapes, and without a scale that has four runs of two sizes
    """
    slopes = [float(point["amplitude_nm"]) / float(point["wavelength_nm"]) for point in points]
    if max(slopes) > (1 + SHAPES_ALIKE) * min(slopes) or len({point["geometry"] for point in points}) > 1:
        return {}
    exponents = {}
    for scale, runs in _by_scale(points).items():
        group = [point for point in runs if np.isfinite(float(point["same_shape_GPa"]))]
        length, stress = (
            np.array([float(point[key]) for point in group]) for key in ("same_shape_length_nm", "same_shape_GPa")
        )
        if len(group) < 4 or len({point["asperity"] for point in group}) < 2 or np.any(stress <= 0):
            continue
        (slope, _), covariance = np.polyfit(np.log(length), np.log(stress), 1, cov=True)
        n, half = -float(slope), float(stdtrit(len(group) - 2, INTERVAL[1]) * np.sqrt(covariance[0, 0]))
        exponents[scale] = {
            "mean": n,
            "low": n - half,
            "high": n + half,
            "runs": len(group),
            "length_min_nm": length.min(),
            "length_max_nm": length.max(),
        }
    return exponents


def scale_ratios(points: Sequence[Point]) -> list[dict]:
    """Hardness at the lowest over that at the highest energy scale, per asperity, with its 68 % interval."""
    scales = sorted({float(point["energy_scale"]) for point in points})
    rows = []
    if len(scales) < 2:
        return rows
    for asperity in sorted({point["asperity"] for point in points}):
        groups = [
            _columns([p for p in _of_scale(points, scale) if p["asperity"] == asperity])
            for scale in (scales[0], scales[-1])
        ]
        if any(len(group[0]) == 0 for group in groups):
            continue
        rng = _rng(14)
        means = [
            np.mean(hardness) + rng.normal(size=2000) * np.sqrt(np.mean(spread**2) / len(hardness) + _scatter(hardness))
            for hardness, spread, _, _ in groups
        ]
        rows.append({"asperity": asperity, "scales": [scales[0], scales[-1]], **summary(means[0] / means[1])})
    return rows


def band(h_macro: np.ndarray, h_prime: np.ndarray, statistical: float) -> list[dict[str, float]]:
    """H(L), L = sqrt(A) from 1 to 20 nm, with its 68 % band and the part of that which more runs would narrow.

    Parameters
    ----------
    statistical : standard deviation of H' between the runs of an asperity, GPa nm^0.5.
    """
    rows = []
    for length in np.geomspace(1, 20, 40).tolist():
        hardness = h_macro + h_prime / np.sqrt(length)
        low, middle, high = np.quantile(hardness, [INTERVAL[0], 0.5, INTERVAL[1]]).tolist()
        half = statistical / float(np.sqrt(length))
        rows.append(
            {
                "contact_length_nm": length,
                "low_GPa": low,
                "median_GPa": middle,
                "high_GPa": high,
                "statistical_low_GPa": middle - half,
                "statistical_high_GPa": middle + half,
            }
        )
    return rows


def _columns(points: Sequence[Point]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Hardness, half its interval, contact length, energy scale."""

    def column(name: str) -> np.ndarray:
        return np.array([float(point[name]) for point in points])

    spread = 0.5 * (column("hardness_hi") - column("hardness_lo"))
    return column("hardness_GPa"), spread, column("contact_length_nm"), column("energy_scale")


def _by_scale(points: Sequence[Point]) -> dict[str, list[Point]]:
    """The points of each energy scale, lowest first, under the key of its entries in fit.json."""
    scales = sorted({float(point["energy_scale"]) for point in points})
    return {f"scale_{scale:g}": _of_scale(points, scale) for scale in scales}


def _of_scale(points: Sequence[Point], scale: float) -> list[Point]:
    return [point for point in points if float(point["energy_scale"]) == scale]


def _scatter(values: np.ndarray) -> float:
    """Variance of the mean between runs."""
    return float(np.var(values, ddof=1) / len(values)) if len(values) > 1 else 0.0


def _range(h_macro: np.ndarray, fit: FitSettings) -> dict[str, float]:
    if fit.h_macro == "literature":
        return {"a": fit.h_macro_GPa[0], "b": fit.h_macro_GPa[1]}
    return {"a": float(np.quantile(h_macro, INTERVAL[0])), "b": float(np.quantile(h_macro, INTERVAL[1]))}


def summary(samples: np.ndarray) -> dict[str, float]:
    """Median and 68 % interval."""
    low, middle, high = np.quantile(samples, [INTERVAL[0], 0.5, INTERVAL[1]]).tolist()
    return {"median": middle, "low": low, "high": high}


def spearman(first: np.ndarray, second: np.ndarray) -> float:
    """Rank correlation."""
    return float(np.corrcoef(rankdata(first), rankdata(second))[0, 1])


def _rng(stream: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence([stream]))
