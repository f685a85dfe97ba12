"""Which law of hardness foretells the films that it was not fitted to, and what follows for wider contacts?

The runs are those of study `hardness.stack`. `constant` and eq. 4 (`paper`) know only the contact length L; `film` has
the thickness t, and the hardness of glass and metal by themselves, which are the film of no and of all softening. An
error is the root mean square of ln(predicted / found), one point (L, t) or one thickness left out of the fit; seeds are
averaged. `prediction` has k and m of a prototype, written down before these runs. Uncertainty is by the
likelihood of all runs, since seeds are too few for a bootstrap; cross terms enter by the k of runs that change them.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from scipy.optimize import least_squares
from scipy.stats import rankdata

from atomistic.errors import InputError
from atomistic.hardness.size_effect import INTERVAL, SYSTEMATIC
from evidence.hardness.metal import DEPTHS_A, LEAST_NM, MOST_SHARE
from evidence.hardness.stack import calibrated_depth
from evidence.record import load
from mesoscale.inputs.hardness import HardnessLaw

PREDICTION = {"k": 0.24, "m": 1.2}  # of a prototype with other films, written down before
MAIN = {"wavelength_nm": "5.6", "metal": "polycrystal", "bond_eV": "0.28"}
OTHERS = {"strong bond": {"bond_eV": "0.45"}}  # not one crystal: as hard as the glass, it leaves no share of the film
LENGTHS_NM = (3.0, 5.0, 10.0, 15.0, 30.0, 100.0)
OXIDE_NM = 5.0  # of TiO2 on the titanium of Kim et al. (2013)
SOFT_GPA, SIZE_EFFECT = (0.7, 3.2), (3.7, 16.7)  # H_macro and H' (GPa nm^0.5) of scene reduced
DRAWS, TRIALS, LEAST_POINTS = 2000, 1_000_000, 3
PRIOR = ((5, 15), (2, 10), (1e-3, 10), (0.5, 4))  # of H_film, H_base, k, m
Law = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


class Points(NamedTuple):
    """Mean stress of the contact at its length, by seed and thickness (0: metal alone, inf: glass alone).

    Attributes
    ----------
    seed, thickness_nm, length_nm, stress_GPa : shape (points,).
    """

    seed: np.ndarray
    thickness_nm: np.ndarray
    length_nm: np.ndarray
    stress_GPa: np.ndarray

    def take(self, kept: np.ndarray) -> "Points":
        """Some of the points."""
        return Points(*(column[kept] for column in self))

    @property
    def film(self) -> np.ndarray:
        """Which are of films."""
        return (self.thickness_nm > 0) & np.isfinite(self.thickness_nm)


def points_of(rows: Sequence[Mapping[str, str]], changed: Mapping[str, str] | None = None) -> Points:
    """The points of `MAIN`, or of runs that differ from it; every body read with the depth calibrated on its kind.

    Raises
    ------
    InputError : too few runs for a law, or no calibration of the area.
    """
    which, found = {**MAIN, **(changed or {})}, []
    widest = float(which["wavelength_nm"]) * MOST_SHARE**0.5
    labels = {}
    for body in ("glass", "metal", "film"):
        depth, _ = calibrated_depth(body)
        labels[body] = "" if depth == f"{DEPTHS_A[0]:g}" else f"depth_{depth}_A_"
    for row in rows:
        case, name = row["case"], row["quantity"]
        start = f"stress_{labels.get(case, '')}"
        if case not in labels or not (name.startswith(start) and name.endswith("_nm_GPa")):
            continue
        length = name.removeprefix(start).removesuffix("_nm_GPa")
        needed = {"glass": ("wavelength_nm",), "metal": ("wavelength_nm", "metal")}.get(case, tuple(which))
        if "_" in length or any(row[key] != which[key] for key in needed):
            continue
        if LEAST_NM < float(length) < widest:
            thickness = {"glass": np.inf, "metal": 0.0}.get(case, float(row["thickness_nm"]))
            found.append((float(row["seed"]), thickness, float(length), float(row["value"])))
    points = Points(*np.array(found).reshape(-1, 4).T)
    points = points.take(np.isin(points.seed, points.seed[points.film]))
    if points.film.sum() < LEAST_POINTS:
        raise InputError(
            f"a law of films on {which['metal']} ({which['bond_eV']} eV): {points.film.sum()} points of films between "
            f"{LEAST_NM:g} and {widest:.1f} nm, {LEAST_POINTS} are needed; run `python -m evidence hardness.stack`"
        )
    return points


def constant(values: np.ndarray, length: np.ndarray, thickness: np.ndarray) -> np.ndarray:
    """Values: H."""
    return np.broadcast_to(values[0], length.shape)


def paper(values: np.ndarray, length: np.ndarray, thickness: np.ndarray) -> np.ndarray:
    """Values: H_macro, H'."""
    return HardnessLaw(*values).pressure(length**2)


def film(values: np.ndarray, length: np.ndarray, thickness: np.ndarray) -> np.ndarray:
    """Values: H_film, H_base, k, m."""
    h_film, h_base, k, m = values
    return HardnessLaw(h_base, 0.0, h_film, np.maximum(thickness, 1e-9), k, m).pressure(length**2)


def prediction(values: np.ndarray, length: np.ndarray, thickness: np.ndarray) -> np.ndarray:
    """Values: H_film, H_base."""
    return film(np.array([*values, *PREDICTION.values()]), length, thickness)


LAWS: dict[str, tuple[Law, tuple[float, ...]]] = {
    "constant": (constant, (6.0,)),
    "paper": (paper, (3.0, 5.0)),
    "film": (film, (9.0, 5.0, 0.3, 1.2)),
    "prediction": (prediction, (9.0, 5.0)),
}


def fit(name: str, points: Points) -> np.ndarray:
    """Values of a law by least squares of ln H; all are positive."""
    law, start = LAWS[name]

    def misfit(logs: np.ndarray) -> np.ndarray:
        found = law(np.exp(logs), points.length_nm, points.thickness_nm)
        return np.log(found / points.stress_GPa)

    return np.exp(least_squares(misfit, np.log(start), bounds=(np.log(1e-3), np.log(50.0))).x)


def left_out(name: str, points: Points, by: str, alike: bool = False) -> float:
    """Error of a law, of ln H, at points that its fit had not.

    Parameters
    ----------
    by : what is left out at a time: point or thickness.
    alike : fit the films of the left-out thickness alone; else all films.
    """
    law, errors = LAWS[name][0], []
    knows = name in ("film", "prediction")
    for thickness in np.unique(points.thickness_nm[points.film]):
        same = points.thickness_nm == thickness
        for length in np.unique(points.length_nm[same]):
            here = same & (points.length_nm == length)
            others = ~(same if by == "thickness" else here) & (knows | (same if alike else points.film))
            values = fit(name, points.take(others))
            found = law(values, np.array([length]), np.array([thickness]))[0]
            errors.append(np.log(found / points.stress_GPa[here].mean()))
    return float(np.sqrt(np.mean(np.square(errors))))


def likely(points: Points, rng: np.random.Generator) -> np.ndarray:
    """Values of the law `film`, shape (draws, 4), by their likelihood; `PRIOR` is flat in the logarithms and in m.

    The misfits of a run are one error, so that N runs of unknown scatter have the likelihood S^(-N/2), S the sum of
    squares (the scatter's own prior is Jeffreys's).
    """
    low, high = np.array(PRIOR).T
    values = rng.uniform([*np.log(low[:3]), low[3]], [*np.log(high[:3]), high[3]], (TRIALS, 4))
    values[:, :3] = np.exp(values[:, :3])
    squares = np.zeros(TRIALS)
    for length, thickness, stress in zip(points.length_nm, points.thickness_nm, points.stress_GPa, strict=True):
        squares += np.log(film(values.T, np.array(length), np.array(thickness)) / stress) ** 2
    runs = len(set(zip(points.seed, points.thickness_nm, strict=True)))
    weights = (squares / squares.min()) ** (-runs / 2)
    return values[rng.choice(TRIALS, DRAWS, p=weights / weights.sum())]


def changed_k(rows: Sequence[Mapping[str, str]], changed: Mapping[str, str]) -> float:
    """k of runs that differ from `MAIN`, over that of the same seeds and thicknesses of `MAIN`; m as in `MAIN`."""
    main, other = points_of(rows), points_of(rows, changed)
    m = fit("film", main)[3]
    pairs = set(zip(other.seed[other.film], other.thickness_nm[other.film], strict=True))

    def alike(points: Points) -> Points:
        seeds = [seed for seed, _ in pairs]
        both = list(zip(points.seed, points.thickness_nm, strict=True))
        return points.take(np.isin(points.seed, seeds) & (~points.film | np.array([pair in pairs for pair in both])))

    def k_of(points: Points) -> float:
        ends = [points.stress_GPa[points.thickness_nm == t].mean() for t in (np.inf, 0.0)]
        of = points.take(points.film)

        def misfit(log: np.ndarray) -> np.ndarray:
            values = np.array([*ends, np.exp(log[0]), m])
            return np.log(film(values, of.length_nm, of.thickness_nm) / of.stress_GPa)

        return float(np.exp(least_squares(misfit, [np.log(0.3)], bounds=(-7, 4)).x[0]))

    return k_of(alike(other)) / k_of(alike(main))


def rows(given: object) -> Iterator[dict[str, Any]]:
    """Errors of the laws; values of `film`; hardness against contact length."""
    of_stack, rng = load("hardness.stack"), np.random.default_rng(43)
    points = points_of(of_stack)
    seeds = len(np.unique(points.seed))

    def row(quantity: str, of: str, value: float, low: Any = "", high: Any = "") -> dict[str, Any]:
        return {"quantity": quantity, "of": of, "value": value, "low": low, "high": high, "seeds": seeds}

    means = points.take(points.film)
    spread = [
        np.std(np.log(means.stress_GPa[here]), ddof=1) / np.sqrt(here.sum())
        for pair in sorted(set(zip(means.thickness_nm, means.length_nm, strict=True)))
        if (here := (means.thickness_nm == pair[0]) & (means.length_nm == pair[1])).sum() > 1
    ]
    yield row("standard_error", "mean over seeds", float(np.sqrt(np.mean(np.square(spread)))))
    for name in LAWS:
        yield row("left_out_point", name, left_out(name, points, "point"))
        yield row("left_out_thickness", name, left_out(name, points, "thickness"))
    for name in ("constant", "paper"):
        yield row("left_out_point", f"{name}, each thickness by itself", left_out(name, points, "point", alike=True))
    factors = {}
    for case, changed in OTHERS.items():
        if any(all(r[key] == value for key, value in changed.items()) and r["case"] == "film" for r in of_stack):
            factors[case] = changed_k(of_stack, changed)
            yield row("k_over_main", case, factors[case])
    best = fit("film", points)
    draws = likely(points, rng)
    draws[:, 2] *= np.exp(rng.normal(0, np.linalg.norm([np.log(factor) for factor in factors.values()]), DRAWS))
    for name, value, column in zip(("H_film", "H_base", "k", "m"), best, draws.T, strict=True):
        yield row("film", name, float(value), *np.quantile(column, INTERVAL).tolist())
    yield row("film", "rank correlation of k and m", float(np.corrcoef(rankdata(draws[:, 2:], axis=0).T)[0, 1]))
    area = max(calibrated_depth(body)[1] for body in ("glass", "metal", "film")) / np.sqrt(3)
    shared = np.exp(rng.normal(0, np.linalg.norm([area, *SYSTEMATIC.values()]), DRAWS))
    soft, size = rng.uniform(*SOFT_GPA, DRAWS), rng.uniform(*SIZE_EFFECT, DRAWS)
    h_film, h_base, k, m = draws.T

    def hardness(length: float) -> dict[str, np.ndarray]:
        at = partial(film, length=np.array(length), thickness=np.array(OXIDE_NM))
        return {
            "metal as pressed": shared * at(np.array([h_film, h_base, k, m])),
            "metal of H_macro": at(np.array([shared * h_film, soft, k, m])),
            "eq. 4": soft + size / np.sqrt(length),
        }

    found = {f"hardness_{length:g}_nm": hardness(length) for length in LENGTHS_NM}
    found["fall_3_to_15_nm"] = {case: values / hardness(15.0)[case] for case, values in hardness(3.0).items()}
    for quantity, cases in found.items():
        for case, values in cases.items():
            low, middle, high = np.quantile(values, [INTERVAL[0], 0.5, INTERVAL[1]]).tolist()
            yield row(quantity, case, middle, low, high)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Errors in per cent, values with their 68 % intervals; of the last run."""
    found = {"seeds": rows[-1]["seeds"]}
    for row in rows:
        name = f"{row['of']}_{row['quantity']}".replace(",", "").replace(".", "").replace(" ", "_")
        if row["quantity"].startswith(("left_out", "standard")):
            found[name] = f"{100 * float(row['value']):.0f} %"
        else:
            ends = f" [{float(row['low']):.2g}, {float(row['high']):.2g}]" if row["low"] else ""
            found[name] = f"{float(row['value']):.2g}{ends}"
    return found


def draw(axes: Axes) -> None:
    """Mean stress of each body with its standard error over seeds; what the law and its prediction say of 5 nm."""
    points, of_law = points_of(load("hardness.stack")), load("hardness.laws")
    colors = ("#20242b", "#b5482a", "#d99a2b", "#4c9a5b", "#1f5fa8")
    for thickness, color in zip(np.unique(points.thickness_nm), colors, strict=True):
        name = {0: "titanium", np.inf: "silica"}.get(thickness, f"{thickness:g} nm of silica on titanium")
        lengths = np.unique(points.length_nm)
        of = [points.stress_GPa[(points.thickness_nm == thickness) & (points.length_nm == at)] for at in lengths]
        error = [np.std(values, ddof=1) / len(values) ** 0.5 for values in of]
        axes.errorbar(lengths, [np.mean(values) for values in of], error, fmt="o-", ms=3, color=color, label=name)
    for case, color in (("metal as pressed", "#b5482a"), ("metal of H_macro", "#8a8f98")):
        found = [row for row in of_law if row["of"] == case and row["quantity"].startswith("hardness")]
        low, high = ([float(row[end]) for row in found] for end in ("low", "high"))
        axes.fill_between(LENGTHS_NM, low, high, color=color, alpha=0.2, label=f"5 nm on {case}, law")
    lengths, said = np.array(LENGTHS_NM), np.array([10.5, 0.7])
    thickness = np.full_like(lengths, OXIDE_NM)
    axes.plot(
        lengths, prediction(said, lengths, thickness), "--", color="#8a8f98", label="5 nm on 0.7 GPa, said before"
    )
