"""Size dependence of hardness, H(A) = H_macro + H' A^-0.25 (Kim et al. 2013, eq. 4).

A series of sizes seldom identifies both parameters (`free_fit`). H_macro is therefore taken from a
stated distribution, and H' = (H - H_macro) A^0.25 from every run.

The form of the potential is not known. Its error stands for all energies times one factor, as in
the paper. Two ways bound the factor: the measured hardness of the glass, or twins of the runs with
other energies, each as likely.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

SYSTEMATIC = {
    "rate": 0.05,  # closing speed in use against rest
    "base": 0.04,  # base in use against a thicker one
    "potential": 0.1,  # one potential of silica against another
    # 4 % by another curve between the slopes that were pressed, 4 % by the glasses
    "steepness": 0.06,
}
"""What moves every run of a scene alike, as standard deviations relative to the hardness (study
`hardness.choices`).
"""
RUN_SCATTER = 0.11
"""Standard deviation between runs of one kind, relative to the hardness (study `hardness.choices`).
"""
SLOPES = {0.222: 0.55, 0.444: 1.0, 0.889: 1.31}
"""Hardness of asperities by their RMS slope, over that of the second (study `hardness.choices`, two
glasses).
"""
BERKOVICH = 0.358
"""Slope of a Berkovich tip: of the cone with the same area at each depth, whose half angle is 70.3
degrees.
"""
PointRow = Mapping[str, str]
"""A row of points.csv."""
Energies = Literal["measured", "scales"]


@dataclass(frozen=True)
class FitRules:
    """When a fit may be used, and how finely it is sampled.

    Attributes
    ----------
    interval : quantiles of the 68 % interval, as in the paper.
    least_runs, least_share : defended runs needed, and their share of all runs. Runs scatter by 11
        %, so that four leave their mean open by 6 %; errors that all runs share are 13 %.
    samples : of the joint distribution of H_macro and H'.
    identified : Student's t of H_macro and of H' from which on a free fit tells both.
    """

    interval: tuple[float, float] = (0.16, 0.84)
    least_runs: int = 4
    least_share: float = 0.5
    samples: int = 2000
    identified: float = 0.95


FIT_RULES = FitRules()


def fit_size_effect(
    points: Sequence[PointRow],
    glasses: Sequence[Mapping],
    area_error: float,
    h_macro: Callable[[np.ndarray], np.ndarray],
    energies: Energies = "measured",
    indentation_GPa: tuple[float, float] | None = None,
    systematic_errors: Mapping[str, float] = SYSTEMATIC,
) -> dict:
    """H' and the hardness of the runs with 68 % intervals, judged whether they may be used.

    Parameters
    ----------
    points : rows of points.csv.
    glasses : properties of the glasses, each with its gate.
    area_error : largest error of the contact area by its calibration, as a fraction.
    h_macro : quantiles of H_macro (GPa) by their probability.
    energies : of the settings: what bounds the energies of the potential.
    indentation_GPa : lowest and highest measured hardness of the glass; None: not known.
    others : errors that all runs share, as standard deviations relative to the hardness.

    Returns
    -------
    Content of fit.json (docs/hardness.md).
    """
    counted = points
    if energies != "scales":
        counted = [point for point in points if float(point["energy_scale"]) == 1.0]
    used = [point for point in counted if point["status"] == "yield"]
    reasons = [reason for glass in glasses for reason in glass["gate"]["reasons"]]
    reasons += _too_few(used, counted)
    result: dict = {
        "method": "literature",
        "energies_from": energies,
        "points_used": len(used),
        "points_total": len(counted),
        "points_rejected": refused_runs(points),
        "twins": twins(points),
        "free_fit": free_fit(used),
        "inputs": {},
        "gate": {"passed": False, "reasons": reasons},
    }
    if not used:
        return result
    # the error of the area lies anywhere within that of its calibration: a uniform distribution
    systematic = {"area": area_error / np.sqrt(3), **systematic_errors}
    slopes = steepness(used)
    if not slopes:
        reasons.append(
            f"asperities flatter or steeper than RMS slopes of {min(SLOPES):.2g} to"
            f" {max(SLOPES):.2g}"
        )
        return result
    ways = {}
    for source, (runs, bounds) in energy_ways(points, slopes, indentation_GPa).items():
        ways[source] = bounds, *hardness_samples(runs, systematic, bounds)
    bounds, length, h_film = ways[energies]
    h_macro_GPa = h_macro(_rng(13).random(FIT_RULES.samples))
    h_prime = (h_film - h_macro_GPa) * np.sqrt(length)
    typical = float(np.median(h_film))
    base = float(np.median(h_macro_GPa))
    of_h_prime = [(factor * typical - base) / (typical - base) for factor in slopes["factor"]]
    result["energies"] = list(bounds)
    result["inputs"] = {
        "h_prime": {
            **_uniform(h_prime, "GPa nm^0.5"),
            "correlation": (
                {"h_macro": spearman(h_macro_GPa, h_prime)} if np.ptp(h_macro_GPa) else {}
            ),
            "steepness": {**slopes, "factor": of_h_prime},
        },
        "h_film": {**samples_of(h_film, "GPa"), "steepness": slopes},
    }
    result["hardness_GPa"] = {source: summary(drawn) for source, (_, _, drawn) in ways.items()}
    result["H_macro_GPa"] = summary(h_macro_GPa)
    result["H_prime_GPa_nm0.5"] = summary(h_prime)
    result["curve"] = band(h_macro_GPa, h_prime)
    if result["inputs"]["h_prime"]["a"] <= 0 or np.min(h_macro_GPa) <= 0:
        reasons.append(
            "the fit allows a hardness that falls with decreasing size or is negative: not"
            " identifiable"
        )
    result["gate"]["passed"] = not reasons
    return result


def _too_few(used: Sequence[PointRow], counted: Sequence[PointRow]) -> list[str]:
    """Why the defended runs among those asked for are too few; empty where they are enough."""
    reasons = []
    if len(used) < FIT_RULES.least_runs:
        reasons.append(
            f"{len(used)} of {len(counted)} runs gave a defended hardness,"
            f" {FIT_RULES.least_runs} are"
            " needed"
        )
    elif len(used) < FIT_RULES.least_share * len(counted):
        share = f"gate {FIT_RULES.least_share:.0%}"
        reasons.append(
            f"only {len(used)} of {len(counted)} runs gave a defended hardness ({share})"
        )
    if missing := sorted(set(scales_of(counted)) - set(scales_of(used))):
        reasons.append(
            f"no defended hardness at energy scale {', '.join(f'{scale:g}' for scale in missing)}"
        )
    return reasons


def refused_runs(points: Sequence[PointRow]) -> list[dict[str, str]]:
    """Runs without a defended hardness, each with the reason."""
    return [
        {"run": point["run"], "status": point["status"]}
        for point in points
        if point["status"] != "yield"
    ]


def twins(points: Sequence[PointRow]) -> list[dict[str, Any]]:
    """Hardness of runs with scaled energies over that of their full twins, by energy scale.

    A pair has the same asperity and glass. Both of its runs scatter by `RUN_SCATTER`, which makes
    the 68 % interval.

    Returns
    -------
    `energy_scale`, `pairs`, `full_GPa`, `scaled_GPa` and `ratio` (median, low, high) of each scale
    with a pair.
    """
    hardness = {}
    for point in points:
        if point["status"] == "yield" and not point["film_nm"]:
            key = (point["asperity"], point["seed"], float(point["energy_scale"]))
            hardness[key] = float(point["hardness_GPa"])
    rows = []
    for scale in scales_of(points):
        if scale == 1.0:
            continue
        pairs = []
        for (asperity, seed, energies), scaled in hardness.items():
            if energies == scale and (asperity, seed, 1.0) in hardness:
                pairs.append((hardness[asperity, seed, 1.0], scaled))
        if not pairs:
            continue
        full, scaled = np.array(pairs).T
        ratio = float(np.exp(np.mean(np.log(scaled / full))))
        error = np.sqrt(2 / len(pairs)) * RUN_SCATTER
        low = ratio * np.exp(-error)
        high = ratio * np.exp(error)
        rows.append(
            {
                "energy_scale": scale,
                "pairs": len(pairs),
                "full_GPa": float(full.mean()),
                "scaled_GPa": float(scaled.mean()),
                "ratio": {"median": ratio, "low": low, "high": high},
            }
        )
    return rows


def free_fit(used: Sequence[PointRow]) -> dict[str, Any] | None:
    """Least squares of both parameters of eq. 4 as in the paper; whether runs tell both.

    The runs at full energies count alike: they scatter by more than each one's own interval.

    Returns
    -------
    `H_macro_GPa` and `H_prime_GPa_nm0.5` (mean, low, high: 68 %), `identified` and `verdict`; None
    below three runs.
    """
    from scipy.stats import t as student  # slow to import

    full = [point for point in used if float(point["energy_scale"]) == 1.0]
    if len(full) < 3:
        return None
    hardness, _, length, _ = _columns(full)
    model = np.column_stack([np.ones(len(full)), 1 / np.sqrt(length)])
    values, *_ = np.linalg.lstsq(model, hardness, rcond=None)
    freedom = len(full) - 2
    variance = np.sum((hardness - model @ values) ** 2) / freedom
    errors = np.sqrt(variance * np.diag(np.linalg.pinv(model.T @ model)))
    half = errors * student.ppf(FIT_RULES.interval[1], freedom)
    surely_positive = values - errors * student.ppf(FIT_RULES.identified, freedom) > 0
    names = ("H_macro_GPa", "H_prime_GPa_nm0.5")
    fitted = {}
    for name, value, width in zip(names, values.tolist(), half.tolist(), strict=True):
        fitted[name] = {"mean": value, "low": value - width, "high": value + width}
    sure_names = zip(names, surely_positive, strict=True)
    unknown = [name.partition("_GPa")[0] for name, sure in sure_names if not sure]
    verdict = f"{len(full)} runs tell both"
    if unknown:
        verdict = f"{len(full)} runs do not tell {' and '.join(unknown)} from zero"
    return {**fitted, "identified": not unknown, "verdict": verdict}


def energy_ways(
    points: Sequence[PointRow],
    slopes: Mapping[str, Sequence[float]],
    indentation_GPa: tuple[float, float] | None,
) -> dict[Energies, tuple[list[PointRow], tuple[float, float]]]:
    """Both ways to bound the energies: the runs that count, and the range of their factor.

    The second is left out where no run has scaled energies, the first where none with full ones is
    defended.
    """
    defended = [point for point in points if point["status"] == "yield"]
    full = [point for point in defended if float(point["energy_scale"]) == 1.0]
    ways: dict[Energies, tuple[list[PointRow], tuple[float, float]]] = {}
    if full:
        full_GPa = float(np.mean([float(point["hardness_GPa"]) for point in full]))
        ways["measured"] = full, energy_bounds(full_GPa, slopes, scales_of(points), indentation_GPa)
    if defended and len(scales_of(points)) > 1:
        ways["scales"] = defended, (1.0, 1.0)  # as they are
    return ways


def scales_of(points: Sequence[PointRow]) -> list[float]:
    """Energy scales of runs, rising."""
    return sorted({float(point["energy_scale"]) for point in points})


def energy_bounds(
    full_GPa: float,
    slopes: Mapping[str, Sequence[float]],
    scales: Sequence[float],
    indentation_GPa: tuple[float, float] | None,
) -> tuple[float, float]:
    """Factors on a potential's energies that bound its glass's measured hardness; 1 between.

    Hardness is proportional to the energies (`twins`).

    Parameters
    ----------
    full_GPa : mean hardness of the runs at full energies.
    slopes : of `steepness`.
    scales : energy scales that were run; their range counts where no hardness was measured.
    indentation_GPa : lowest and highest measured hardness; None: not known.
    """
    if indentation_GPa is None or not slopes:
        return min(scales), max(scales)
    factor = np.interp(np.log(BERKOVICH), np.log(slopes["rms_slope"]), slopes["factor"])
    low, high = np.array(indentation_GPa) / (factor * full_GPa)
    return min(float(low), 1.0), max(float(high), 1.0)


def hardness_samples(
    points: Sequence[PointRow],
    systematic: Mapping[str, float],
    energies: tuple[float, float],
    count: int = FIT_RULES.samples,
) -> tuple[np.ndarray, np.ndarray]:
    """Contact length (nm) and hardness (GPa) of runs drawn at random, each energy scale as often.

    Parameters
    ----------
    systematic : errors that all runs share, as standard deviations relative to the hardness.
    energies : of `energy_bounds`; the factor is uniform between them.
    """
    rng = _rng(11)
    hardness, spread, length, scale = _columns(points)
    _, of_scale, runs = np.unique(scale, return_inverse=True, return_counts=True)
    probability = 1 / (len(runs) * runs[of_scale])
    chosen = rng.choice(len(points), size=count, p=probability)
    # factors on the hardness of all runs alike
    normals = _rng(15).normal(size=(len(systematic), count))
    shared = 1 + np.array(list(systematic.values())) @ normals
    shared *= rng.uniform(*energies, count)
    drawn = hardness[chosen] + spread[chosen] * rng.normal(size=count)
    return length[chosen], drawn * shared


def relative_hardness(slope: float) -> float:
    """Hardness at an RMS slope over that at 0.444; NaN beyond the slopes that were pressed.

    Straight in the logarithm of the slope, as in an expanding cavity (Johnson, J. Mech. Phys.
    Solids 18, 115, 1970).
    """
    slopes = np.log(list(SLOPES))
    return float(np.interp(np.log(slope), slopes, list(SLOPES.values()), np.nan, np.nan))


def rms_slope(point: PointRow) -> float:
    """RMS slope of eq. 6: one of two sine waves, wherever it is the lower one."""
    amplitude = float(point["amplitude_nm"])
    return float(np.sqrt(2) * np.pi * amplitude / float(point["wavelength_nm"]))


def steepness(points: Sequence[PointRow]) -> dict[str, list[float]]:
    """Factors by which the hardness of the runs is that at other slopes.

    Returns
    -------
    `rms_slope` and `factor`, straight between them in the logarithm of the slope; empty where the
    runs themselves are flatter or steeper than the slopes that were pressed
    """
    of_runs = float(np.mean([relative_hardness(rms_slope(point)) for point in points]))
    if not np.isfinite(of_runs):
        return {}
    return {"rms_slope": list(SLOPES), "factor": [factor / of_runs for factor in SLOPES.values()]}


def band(h_macro: np.ndarray, h_prime: np.ndarray) -> list[dict[str, float]]:
    """H(L), L = sqrt(A) from 1 to 20 nm, with its 68 % band."""
    rows = []
    for length in np.geomspace(1, 20, 40).tolist():
        shares = [FIT_RULES.interval[0], 0.5, FIT_RULES.interval[1]]
        low, middle, high = np.quantile(h_macro + h_prime / np.sqrt(length), shares)
        rows.append(
            {"contact_length_nm": length, "low_GPa": low, "median_GPa": middle, "high_GPa": high}
        )
    return rows


def summary(samples: np.ndarray) -> dict[str, float]:
    """Median and 68 % interval."""
    low_quantile, high_quantile = FIT_RULES.interval
    low, middle, high = np.quantile(samples, [low_quantile, 0.5, high_quantile]).tolist()
    return {"median": middle, "low": low, "high": high}


def spearman(first: np.ndarray, second: np.ndarray) -> float:
    """Rank correlation."""
    from scipy.stats import rankdata  # slow to import

    return float(np.corrcoef(rankdata(first), rankdata(second))[0, 1])


def samples_of(values: np.ndarray, unit: str) -> dict[str, Any]:
    """An input's distribution: its quantiles, each as likely as the others."""
    shares = (np.arange(200) + 0.5) / 200
    return {"distribution": "samples", "values": np.quantile(values, shares).tolist(), "unit": unit}


def _uniform(samples: np.ndarray, unit: str) -> dict:
    """An input's distribution: uniform over the 68 % interval."""
    low, high = (float(np.quantile(samples, quantile)) for quantile in FIT_RULES.interval)
    return {"distribution": "uniform", "a": low, "b": high, "unit": unit}


def _columns(points: Sequence[PointRow]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Hardness, half its interval, contact length, energy scale."""

    def column(name: str) -> np.ndarray:
        return np.array([float(point[name]) for point in points])

    spread = 0.5 * (column("hardness_hi") - column("hardness_lo"))
    return column("hardness_GPa"), spread, column("contact_length_nm"), column("energy_scale")


def _rng(stream: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence([stream]))
