"""Hardness of a film on a body, H = H_base + (H_film - H_base) / (1 + k (L/t)^m), from runs.

L is the contact length and t the thickness of the film. Runs of oxide throughout are films of
infinite thickness, runs of the base by itself films of none. Beside it stand the two laws that know
no film, a constant and eq. 4 of Kim et al. (2013), each judged by the runs that its fit had not.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from asperity.guards.errors import InputError
from atomistic.hardness.plateau import RULES
from atomistic.hardness.size_effect import (
    FIT_RULES,
    SLOPES,
    SYSTEMATIC,
    Energies,
    PointRow,
    energy_bounds,
    samples_of,
    scales_of,
    spearman,
    steepness,
    summary,
    twins,
)


@dataclass(frozen=True)
class FilmFit:
    """How the law of films is fitted."""

    bond: float = 0.5
    """Standard deviation of ln k by the assumed bonds of film and metal.

    Films with bonds half and 1.5 times as deep have stresses that differ by 4 % with a scatter of
    10 % (runs of scene films, commit 9151035b), seven times as much in k."""

    bin_nm: float = 0.5
    """Of contact length: a run has one mean stress in each."""

    least_points: int = 3
    """Mean stresses of films."""

    least_thicknesses: int = 2
    """Of films."""

    trials: int = 200_000
    """Values drawn from the prior."""

    draws: int = 2000
    """Values of these that their likelihood leaves."""

    negligible: float = 1e-4
    """Likelihood over the largest that need not be drawn again."""

    prior: tuple[tuple[float, float], ...] = ((2, 20), (0.5, 100), (1e-3, 10), (0.5, 4))
    """Ranges of H_film, H_base, k, m."""


FILM_FIT = FilmFit()
LawOfHardness = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


class FilmPoints(NamedTuple):
    """Mean stress of contacts at a length, by seed and thickness (0: base, inf: oxide alone).

    Attributes
    ----------
    seed, thickness_nm, length_nm, stress_GPa : shape (points,).
    """

    seed: np.ndarray
    thickness_nm: np.ndarray
    length_nm: np.ndarray
    stress_GPa: np.ndarray

    def take(self, chosen: np.ndarray) -> "FilmPoints":
        """Some of the points."""
        return FilmPoints(*(column[chosen] for column in self))

    @property
    def film(self) -> np.ndarray:
        """Which are of films."""
        return (self.thickness_nm > 0) & np.isfinite(self.thickness_nm)

    @property
    def bin(self) -> np.ndarray:
        """Which bin of contact length each is of."""
        return (self.length_nm // FILM_FIT.bin_nm).astype(int)

    @property
    def length_over_thickness(self) -> np.ndarray:
        """L/t of the points of films."""
        return (self.length_nm / np.where(self.film, self.thickness_nm, np.inf))[self.film]


def points_of(
    points: Sequence[PointRow], curves: Mapping[str, Sequence[Mapping[str, float]]]
) -> FilmPoints:
    """The mean stresses of sound runs with full energies.

    Parameters
    ----------
    points : rows of points.csv. curves : rows of the closing runs, by run.
    """
    rows = []
    for point in points:
        if point["sound"] == "True" and float(point["energy_scale"]) == 1.0:
            thickness = float(point["film_nm"]) if point["film_nm"] else np.inf
            stresses = mean_stresses(curves[point["run"]], float(point["wavelength_nm"]))
            rows += [(float(point["seed"]), thickness, *mean) for mean in stresses]
    return FilmPoints(*np.array(rows).reshape(-1, 4).T)


def mean_stresses(
    curve: Sequence[Mapping[str, float]], wavelength_nm: float
) -> list[tuple[float, float]]:
    """Mean contact length (nm) and stress (GPa) per bin of length, while it is judged."""
    length = np.array([row["contact_length_nm"] for row in curve])
    stress = np.array([row["contact_stress_GPa"] for row in curve])
    widest = RULES.max_area_fraction**0.5 * wavelength_nm
    means = []
    for low in np.arange(RULES.min_length_nm, widest, FILM_FIT.bin_nm):
        end = min(low + FILM_FIT.bin_nm, widest)
        inside = (length >= low) & (length < end) & (stress > 0)
        if inside.any():
            means.append((float(np.mean(length[inside])), float(np.mean(stress[inside]))))
    return means


def too_few(points: FilmPoints) -> str | None:
    """Why no law of films can be fitted; None where it can."""
    films = int(points.film.sum())
    thicknesses = len(np.unique(points.thickness_nm[points.film]))
    if films < FILM_FIT.least_points or thicknesses < FILM_FIT.least_thicknesses:
        return (
            f"{films} mean stresses of films of {thicknesses} thicknesses: a law of films needs"
            f" {FILM_FIT.least_points} of {FILM_FIT.least_thicknesses}; add thicknesses (film_nm)"
            " or seeds"
        )
    for thickness, name, how in (
        (np.inf, "oxide throughout", "without film_nm"),
        (0.0, "base", "with film_nm: 0"),
    ):
        if not np.any(points.thickness_nm == thickness):
            return (
                f"no defended run of the {name}: a law of films lies between both; add an asperity"
                f" {how}"
            )
    return None


def constant(values: np.ndarray, length: np.ndarray, thickness: np.ndarray) -> np.ndarray:
    """Values: H."""
    return np.broadcast_to(values[0], length.shape)


def paper(values: np.ndarray, length: np.ndarray, thickness: np.ndarray) -> np.ndarray:
    """Eq. 4 of Kim et al. (2013); values: H_macro, H'."""
    return values[0] + values[1] / np.sqrt(length)


def film(values: np.ndarray, length: np.ndarray, thickness: np.ndarray) -> np.ndarray:
    """Values: H_film, H_base, k, m."""
    h_film, h_base, k, m = values
    return h_base + (h_film - h_base) / (1 + k * (length / np.maximum(thickness, 1e-9)) ** m)


LAWS: dict[str, tuple[LawOfHardness, tuple[float, ...]]] = {
    "constant": (constant, (6.0,)),
    "paper": (paper, (3.0, 5.0)),
    "film": (film, (9.0, 5.0, 0.3, 1.2)),
}


def fit(name: str, points: FilmPoints) -> np.ndarray:
    """Values of a law by least squares of ln H; all are positive.

    Raises
    ------
    InputError : they do not settle.
    """
    law, start = LAWS[name]

    def misfit(logs: np.ndarray) -> np.ndarray:
        foretold = law(np.exp(logs), points.length_nm, points.thickness_nm)
        return np.log(foretold / points.stress_GPa)

    bounds = (np.log(1e-3), np.log(50.0))
    solution = least_squares(misfit, np.log(start), bounds=bounds)
    if not solution.success:
        raise InputError(
            f"hardness: the law {name} of films does not settle in {solution.nfev} steps; give more"
            " runs"
        )
    return np.exp(solution.x)


def left_out(name: str, points: FilmPoints) -> float:
    """Root mean square error of ln H of a law at films that its fit had not, one at a time.

    The laws without film are fitted to the other films, `film` to oxide and base besides. Seeds are
    averaged.
    """

    def foretell(fitted: FilmPoints, points_left: FilmPoints) -> np.ndarray:
        return LAWS[name][0](fit(name, fitted), points_left.length_nm, points_left.thickness_nm)

    return error_left_out(points, foretell, name == "film")


def error_left_out(
    points: FilmPoints, foretell: Callable[[FilmPoints, FilmPoints], np.ndarray], knows_bodies: bool
) -> float:
    """`left_out` of any prediction.

    Parameters
    ----------
    foretell : hardness (GPa) at the second points, from the first.
    knows_bodies : whether it takes runs of oxide and base besides films.
    """
    errors = []
    for thickness in np.unique(points.thickness_nm[points.film]):
        same = points.thickness_nm == thickness
        points_left = points.take(same)
        predicted = foretell(points.take(~same & (points.film | knows_bodies)), points_left)
        wrong = np.log(predicted / points_left.stress_GPa)
        bins = points_left.bin
        errors += [float(np.mean(wrong[bins == number])) for number in np.unique(bins)]
    return float(np.sqrt(np.mean(np.square(errors))))


def likely(points: FilmPoints, rng: np.random.Generator) -> np.ndarray:
    """H_film, H_base, k and m by their likelihood, (draws, 4); prior flat in logarithms and m.

    The mean misfit of a run is one error, so that N runs of unknown scatter have the likelihood
    S^(-N/2), S the sum of squares (the scatter's own prior is Jeffreys's): seeds are too few for a
    bootstrap. Every bin counted would make intervals too wide: study `hardness.film_coverage`,
    where those of this likelihood hold 88 to 91 %. A second round draws where the first found a
    likelihood that counts.
    """
    low, high = np.array(FILM_FIT.prior).T
    low = np.array([*np.log(low[:3]), low[3]])
    high = np.array([*np.log(high[:3]), high[3]])
    drawn, weights = _weighed(points, rng.uniform(low, high, (FILM_FIT.trials, 4)))
    counts = drawn[weights > FILM_FIT.negligible]
    narrowed = rng.uniform(counts.min(axis=0), counts.max(axis=0), drawn.shape)
    drawn, weights = _weighed(points, narrowed)
    picks = rng.choice(FILM_FIT.trials, FILM_FIT.draws, p=weights / weights.sum())
    chosen = drawn[picks]
    return np.column_stack([np.exp(chosen[:, :3]), chosen[:, 3]])


def _weighed(points: FilmPoints, drawn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Draws of ln H_film, ln H_base, ln k and m, (n, 4), with likelihoods over the largest."""
    runs = np.column_stack([points.seed, points.thickness_nm])
    _, run = np.unique(runs, axis=0, return_inverse=True)
    run = run.ravel()
    per_run = np.bincount(run)
    values = np.vstack([np.exp(drawn[:, :3].T), drawn[:, 3]])
    misfits = np.zeros((per_run.size, len(drawn)))
    for number, _, thickness, length, stress in zip(run, *points, strict=True):
        misfit = np.log(film(values, length, thickness) / stress)
        misfits[number] += misfit / per_run[number]
    squares = (misfits**2).sum(axis=0)
    return drawn, (squares / squares.min()) ** (-per_run.size / 2)


def fit_films(
    points: Sequence[PointRow],
    curves: Mapping[str, Sequence[Mapping[str, float]]],
    glasses: Sequence[Mapping[str, Any]],
    area_error: float,
    energies: Energies = "measured",
    indentation_GPa: tuple[float, float] | None = None,
) -> dict[str, Any]:
    """Fit the law to the runs of a scene with films, and judge whether it may be used.

    Parameters
    ----------
    points, curves : of `points_of`.
    glasses : properties of the glasses, each with its gate.
    area_error : largest error of the contact area by the calibrations in use, as a fraction.
    energies : of the settings: what bounds the energies of the oxide.
    indentation_GPa : lowest and highest measured hardness of the oxide; None: not known.

    Returns
    -------
    Content of fit.json (docs/hardness.md): the inputs H_film, k and m with their rank correlations,
    and in `film` what the runs say of the base, how well each law foretells a thickness that its
    fit had not, and the range of L/t.
    """
    reasons = [reason for glass in glasses for reason in glass["gate"]["reasons"]]
    unsound = []
    for point in points:
        if point["sound"] != "True":
            unsound.append({"run": point["run"], "status": point["status"]})
    sound = len(points) - len(unsound)
    if sound < FIT_RULES.least_share * len(points):
        reasons.append(
            f"only {sound} of {len(points)} runs are sound (gate {FIT_RULES.least_share:.0%})"
        )
    stresses = points_of(points, curves)
    if few := too_few(stresses):
        reasons.append(few)
    throughout = [point for point in points if point["sound"] == "True" and not point["film_nm"]]
    slopes = steepness(throughout) if throughout else {}
    if throughout and not slopes:
        reasons.append(
            f"asperities flatter or steeper than RMS slopes of {min(SLOPES):.2g} to"
            f" {max(SLOPES):.2g}"
        )
    counts = {"points_used": sound, "points_total": len(points), "points_rejected": unsound}
    result = {
        "method": "film",
        "energies_from": energies,
        **counts,
        "twins": twins(points),
        "inputs": {},
        "gate": {"passed": not reasons, "reasons": reasons},
    }
    if few:
        return result
    rng = np.random.default_rng(np.random.SeedSequence([43]))
    draws = likely(stresses, rng)
    errors = [area_error / 3**0.5, *SYSTEMATIC.values()]
    scatters = [[np.linalg.norm(errors)], [FILM_FIT.bond]]
    of_area, of_bond = rng.normal(size=(2, FILM_FIT.draws)) * scatters
    draws *= np.exp([of_area, of_area, of_bond, 0 * of_bond]).T
    h_film, base, k, m = draws.T
    scales = scales_of(throughout)
    if energies == "measured":
        low, high = energy_bounds(float(np.median(h_film)), slopes, scales, indentation_GPa)
        h_film *= rng.uniform(low, high, len(h_film))
    else:
        low = scales[0]
        high = scales[-1]
        h_film *= rng.choice(scales, len(h_film))
    result["energies"] = [low, high]
    with_h_film = {"h_film": spearman(h_film, k)}
    with_both = {"h_film": spearman(h_film, m), "k_film": spearman(k, m)}
    result["inputs"] = {
        "h_film": {**samples_of(h_film, "GPa"), "steepness": slopes},
        "k_film": samples_of(k, "1") | {"correlation": with_h_film},
        "m_film": samples_of(m, "1") | {"correlation": with_both},
    }
    ratio = stresses.length_over_thickness
    result["film"] = {
        "base_GPa": summary(base),
        "left_out": {name: left_out(name, stresses) for name in LAWS},
        "length_over_thickness": [float(ratio.min()), float(ratio.max())],
    }
    return result
