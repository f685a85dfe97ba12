"""Size dependence of hardness, H(A) = H_macro + H' A^-0.25 (Kim et al. 2013, eq. 4).

A series of sizes cannot identify both parameters. H_macro is therefore taken from a stated range, and
H' = (H - H_macro) A^0.25 from every run.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

SYSTEMATIC = {
    "rate": 0.05,  # closing speed in use against rest
    "base": 0.04,  # base in use against a thicker one
    "potential": 0.1,  # one potential of silica against another
    "steepness": 0.06,  # 4 % by another curve between the slopes that were pressed, 4 % by the glasses
}
"""What moves every run of a scene alike, as standard deviations relative to the hardness (study `hardness.choices`)."""
H_MACRO_GPA = (0.7, 3.2)
"""Range of H_macro, from which H' follows (Kim et al. 2013, Table 1)."""
SLOPES = {0.222: 0.55, 0.444: 1.0, 0.889: 1.31}
"""Hardness of asperities by their RMS slope, over that of the second (study `hardness.choices`, two glasses)."""
BERKOVICH = 0.358
"""Slope of a Berkovich tip: of the cone with the same area at each depth, whose half angle is 70.3 degrees."""
PointRow = Mapping[str, str]
"""A row of points.csv."""


@dataclass(frozen=True)
class FitRules:
    """When a fit may be used, and how finely it is sampled.

    Attributes
    ----------
    interval : quantiles of the 68 % interval, as in the paper.
    least_runs, least_share : defended runs needed, and their share of all runs. Runs scatter by 9 %, so that four leave
        their mean open by 5 %; errors that all runs share are 13 %.
    samples : of the joint distribution of H_macro and H'.
    """

    interval: tuple[float, float] = (0.16, 0.84)
    least_runs: int = 4
    least_share: float = 0.5
    samples: int = 2000


FIT_RULES = FitRules()


def fit_size_effect(
    points: Sequence[PointRow],
    glasses: Sequence[Mapping],
    energy_scales: Sequence[float],
    area_error: float,
    others: Mapping[str, float] = SYSTEMATIC,
    indentation_GPa: tuple[float, float] | None = None,
) -> dict:
    """H' and the hardness of the runs with 68 % intervals, judged whether they may be used.

    Parameters
    ----------
    points : rows of points.csv.
    glasses : properties of the glasses, each with its gate.
    area_error : largest error of the contact area by its calibration, as a fraction.
    others : errors that all runs share, as standard deviations relative to the hardness.
    indentation_GPa : lowest and highest measured hardness of the glass; None: not known.

    Returns
    -------
    Content of fit.json (docs/hardness.md).
    """
    used = [point for point in points if point["status"] == "yield"]
    refused = [{"run": point["run"], "status": point["status"]} for point in points if point["status"] != "yield"]
    reasons = [reason for glass in glasses for reason in glass["gate"]["reasons"]]
    rules = FIT_RULES
    if len(used) < rules.least_runs:
        reasons.append(f"{len(used)} of {len(points)} runs gave a defended hardness, {rules.least_runs} are needed")
    elif len(used) < rules.least_share * len(points):
        share = f"gate {rules.least_share:.0%}"
        reasons.append(f"only {len(used)} of {len(points)} runs gave a defended hardness ({share})")
    scales = {float(point["energy_scale"]) for point in used}
    if missing := sorted(set(energy_scales) - scales):
        reasons.append(f"no defended hardness at energy scale {', '.join(f'{scale:g}' for scale in missing)}")
    result: dict = {
        "method": "literature",
        "points_used": len(used),
        "points_total": len(points),
        "points_rejected": refused,
        "inputs": {},
        "gate": {"passed": False, "reasons": reasons},
    }
    if len(used) < 2:
        result["gate"]["reasons"] = reasons or ["fewer than two points"]
        return result
    # the error of the area lies anywhere within that of its calibration: a uniform distribution
    systematic = {"area": area_error / np.sqrt(3), **others}
    slopes = steepness(used)
    hardness, _, _, scales = _columns(used)
    energies = energy_range(float(np.mean(hardness / scales)), slopes, indentation_GPa, scales)
    h_macro, h_prime, h_film = literature_samples(used, H_MACRO_GPA, systematic, energies)
    low, high = H_MACRO_GPA
    result["energies"] = list(energies)
    if not slopes:
        reasons.append(f"asperities flatter or steeper than RMS slopes of {min(SLOPES):.2g} to {max(SLOPES):.2g}")
        result["gate"]["reasons"] = reasons
        return result
    typical, base = float(np.median(h_film)), 0.5 * (low + high)
    of_h_prime = [(factor * typical - base) / (typical - base) for factor in slopes["factor"]]
    result["inputs"] = {
        "h_macro": {"distribution": "uniform", "a": low, "b": high, "unit": "GPa"},
        "h_prime": {
            **_uniform(h_prime, "GPa nm^0.5"),
            "correlation": {"h_macro": spearman(h_macro, h_prime)},
            "steepness": {**slopes, "factor": of_h_prime},
        },
        "h_film": {**samples_of(h_film, "GPa"), "steepness": slopes},
    }
    result["H_macro_GPa"] = summary(h_macro)
    result["H_prime_GPa_nm0.5"] = summary(h_prime)
    result["curve"] = band(h_macro, h_prime)
    if result["inputs"]["h_prime"]["a"] <= 0 or low <= 0:
        reasons.append("the fit allows a hardness that falls with decreasing size or is negative: not identifiable")
    result["gate"] = {"passed": not reasons, "reasons": reasons}
    return result


def energy_range(
    hardness_GPa: float,
    slopes: Mapping[str, Sequence[float]],
    indentation_GPa: tuple[float, float] | None,
    scales: Sequence[float] | np.ndarray = (1.0,),
) -> tuple[float, float]:
    """Factors on the energies of a potential that bound the measured hardness of its glass, and 1 between them.

    Hardness is proportional to the energies: twins with halved ones have 0.48 to 0.52 of it.

    Parameters
    ----------
    hardness_GPa : of the runs at full energies. slopes : of `steepness`.
    indentation_GPa : lowest and highest measured hardness; None: the range is that of the scene's energy scales.
    """
    if indentation_GPa is None or not slopes:
        return float(np.min(scales)), float(np.max(scales))
    factor = np.interp(np.log(BERKOVICH), np.log(slopes["rms_slope"]), slopes["factor"])
    low, high = np.array(indentation_GPa) / (factor * hardness_GPa)
    return min(float(low), 1.0), max(float(high), 1.0)


def literature_samples(
    points: Sequence[PointRow],
    h_macro_GPa: tuple[float, float],
    systematic: Mapping[str, float],
    energies: tuple[float, float],
    count: int = FIT_RULES.samples,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Joint samples of H_macro (uniform in its range), H' and the hardness (from the points, energies in their range).

    A run with scaled energies counts as one of its hardness over their scale.
    """
    rng = _rng(11)
    hardness, spread, length, scale = _columns(points)
    chosen = rng.choice(len(points), size=count)
    h_macro = rng.uniform(*h_macro_GPa, count)
    # factors on the hardness of all runs alike
    shared = 1 + np.array(list(systematic.values())) @ _rng(15).normal(size=(len(systematic), count))
    shared *= rng.uniform(*energies, count) / scale[chosen]
    drawn = (hardness[chosen] + spread[chosen] * rng.normal(size=count)) * shared
    return h_macro, (drawn - h_macro) * np.sqrt(length[chosen]), drawn


def relative_hardness(slope: float) -> float:
    """Hardness at an RMS slope over that at 0.444; NaN beyond the slopes that were pressed.

    Straight in the logarithm of the slope, as in an expanding cavity (Johnson, J. Mech. Phys. Solids 18, 115, 1970).
    """
    return float(np.interp(np.log(slope), np.log(list(SLOPES)), list(SLOPES.values()), np.nan, np.nan))


def rms_slope(point: PointRow) -> float:
    """RMS slope of eq. 6: one of two sine waves, wherever it is the lower one."""
    return float(np.sqrt(2) * np.pi * float(point["amplitude_nm"]) / float(point["wavelength_nm"]))


def steepness(points: Sequence[PointRow]) -> dict[str, list[float]]:
    """Factors by which the hardness of the runs is that at other slopes.

    Returns
    -------
    `rms_slope` and `factor`, straight between them in the logarithm of the slope; empty where the runs themselves are
    flatter or steeper than the slopes that were pressed
    """
    of_runs = float(np.mean([relative_hardness(rms_slope(point)) for point in points]))
    if not np.isfinite(of_runs):
        return {}
    return {"rms_slope": list(SLOPES), "factor": [factor / of_runs for factor in SLOPES.values()]}


def band(h_macro: np.ndarray, h_prime: np.ndarray) -> list[dict[str, float]]:
    """H(L), L = sqrt(A) from 1 to 20 nm, with its 68 % band."""
    rows = []
    for length in np.geomspace(1, 20, 40).tolist():
        low, middle, high = np.quantile(
            h_macro + h_prime / np.sqrt(length), [FIT_RULES.interval[0], 0.5, FIT_RULES.interval[1]]
        )
        rows.append({"contact_length_nm": length, "low_GPa": low, "median_GPa": middle, "high_GPa": high})
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
