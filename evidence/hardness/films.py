"""Which law of hardness foretells films on titanium, and what of the paper's fall from 10 to 2 GPa
is the film's?

The dielectric of the paper, silica on silicon nitride, is pressed by scene `nitride`, its other
side by scene `titania`: titanium dioxide, alone and on titanium. Runs of halved energies are left
out. Rows of scenes `..._by_force` and `..._on_asperity` were pressed by controlled force and by an
asperity of silica, which the stage did until commit 884b5d7.

The closing runs of a scene with films, as `films`: oxide throughout, the metal by itself, and films
of some thicknesses. Each row is the mean stress of a run at a contact length. The constant and eq.
4 (`paper`) know only the contact length L; `film` has the thickness t, and the hardness of oxide
and metal by themselves. An error is the root mean square of ln(predicted / found) at a thickness
that the fit had not. `prediction` has k and m of a prototype, written down before any of these
runs.

`slope` is the paper's hardness of a run: the contact stress where the slope of stress against
contact length drops, by the two straight lines that fit best.
"""

import os
import subprocess
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from scipy.optimize import least_squares

from atomistic.hardness.film_law import (
    FILM_FIT,
    LAWS,
    FilmPoints,
    error_left_out,
    film,
    fit,
    left_out,
    likely,
    mean_stresses,
    paper,
)
from atomistic.hardness.size_effect import SYSTEMATIC
from evidence.hardness.metal import titanium
from evidence.record import ROOT, load, load_table

PREDICTION = (0.24, 1.2)  # k and m of a prototype with other films, written down before
SAMPLES = ROOT / "config" / "materials" / "silica_on_titanium.csv"  # k and m of scene reduced
KEPT = 400  # of the draws
MAIN, OTHER = "films", "nitride"  # scenes: the electrode, the dielectric
DIOXIDE = "titania"  # and the electrode with the paper's oxide
LENGTHS_NM = (3.0, 5.0, 10.0, 15.0, 30.0, 100.0)
OXIDE_NM = 5.0  # of TiO2 on the titanium of Kim et al. (2013)
# H_macro, and H' (GPa nm^0.5) of eq. 4 fitted to a glass
SOFT_GPA, SIZE_EFFECT = ((0.7, 3.2), (3.7, 16.7))
# points on either side of the drop of the slope; smaller contacts are noise
LEAST_SIDE, LEAST_LENGTH_NM = (4, 1.0)


def arguments(parser: ArgumentParser) -> None:
    """The scene: about an hour of one core."""
    parser.add_argument("scene", nargs="?", default=MAIN, help="name, or a file")
    parser.add_argument("--cores", type=int, default=os.cpu_count())


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """Run the scene and gather the mean stresses of every run."""
    name = given.scene.rpartition("/")[2].removesuffix(".yaml")
    command = ["snakemake", "--cores", str(given.cores), "--config", f"scene={given.scene}"]
    target = f"results/{name}/hardness/points.csv"
    subprocess.run([sys.executable, "-m", *command, "--", target], cwd=ROOT, check=True)
    folder = ROOT / "results" / name / "hardness"
    for point in load_table(folder / "points.csv"):
        if float(point["energy_scale"]) != 1.0:
            continue
        curve = [
            {key: float(row[key]) for key in row}
            for row in load_table(folder / "closing" / f"{point['run']}.csv")
        ]
        drop = slope_drop(curve)
        for length, stress in mean_stresses(curve, float(point["wavelength_nm"])):
            copied = ("seed", "film_nm", "sound", "status", "contact_length_nm", "hardness_GPa")
            yield {
                "scene": name,
                "geometry": "asperity-flat",
                **{key: point[key] for key in copied},
                **dict(zip(("slope_length_nm", "slope_GPa"), drop, strict=True)),
                "length_nm": length,
                "stress_GPa": stress,
            }


def slope_drop(curve: Sequence[Mapping[str, float]]) -> tuple[float, float]:
    """Contact length (nm) and stress (GPa) where the slope of stress against length drops; NaN
    where it does not.
    """
    length, stress = (
        np.array([row[f"contact_{key}"] for row in curve]) for key in ("length_nm", "stress_GPa")
    )
    touching = length > LEAST_LENGTH_NM
    x, y = length[touching], stress[touching]
    best, at = np.inf, (np.nan, np.nan)
    for k in range(LEAST_SIDE, len(x) - LEAST_SIDE):
        parts = (slice(None, k), slice(k, None))
        lines = [np.polyfit(x[part], y[part], 1) for part in parts]
        misfit = sum(
            np.sum((np.polyval(line, x[part]) - y[part]) ** 2)
            for line, part in zip(lines, parts, strict=True)
        )
        if misfit < best:
            best = misfit
            at = (
                (float(x[k]), float(np.polyval(lines[1], x[k])))
                if lines[1][0] < lines[0][0]
                else (np.nan, np.nan)
            )
    return at


def points_of(rows: Sequence[Mapping[str, str]], scene: str = MAIN) -> FilmPoints:
    """The points of the sound runs of a scene."""
    kept = [
        (
            float(row["seed"]),
            float(row["film_nm"] or "inf"),
            float(row["length_nm"]),
            float(row["stress_GPa"]),
        )
        for row in rows
        if row["scene"] == scene and row["sound"] == "True"
    ]
    return FilmPoints(*np.array(kept).reshape(-1, 4).T)


def prediction(others: FilmPoints, at: FilmPoints) -> np.ndarray:
    """The law with k and m of the prototype; oxide and metal by the other runs."""

    def misfit(logs: np.ndarray) -> np.ndarray:
        values = np.array([*np.exp(logs), *PREDICTION])
        return np.log(film(values, others.length_nm, others.thickness_nm) / others.stress_GPa)

    values = np.array([*np.exp(least_squares(misfit, np.log([9.0, 5.0])).x), *PREDICTION])
    return film(values, at.length_nm, at.thickness_nm)


@cache
def laws() -> dict[str, Any]:
    """Fit of the law `film`, its draws, and hardness over 5 nm in three cases."""
    points, rng = points_of(load("hardness.films")), np.random.default_rng(43)
    draws, area = likely(points, rng), titanium().below_films.area_error
    shared = np.exp(
        rng.normal(0, np.linalg.norm([area / np.sqrt(3), *SYSTEMATIC.values()]), len(draws))
    )
    soft, size = rng.uniform(*SOFT_GPA, len(draws)), rng.uniform(*SIZE_EFFECT, len(draws))
    h_film, h_base, *_ = draws.T
    k, m = joint(draws, rng).T
    hardness = {}
    for length in LENGTHS_NM:
        at = (np.array(length), np.array(OXIDE_NM))
        hardness[length] = {
            "metal_as_pressed": shared * film(np.array([h_film, h_base, k, m]), *at),
            "metal_of_H_macro": film(np.array([shared * h_film, soft, k, m]), *at),
            "eq_4": paper(np.array([soft, size]), *at),
        }
    return {"points": points, "draws": draws, "best": fit("film", points), "hardness": hardness}


def joint(draws: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Samples of k and m, the assumed bonds of film and metal counted, shape (draws, 2)."""
    return draws[:, 2:] * np.exp([[FILM_FIT.bond, 0.0]] * rng.normal(size=(len(draws), 1)))


def samples() -> str:
    """Content of `SAMPLES`: joint samples of k and m by the runs of scene `films`."""
    rng = np.random.default_rng(60)
    kept = joint(likely(points_of(load("hardness.films")), rng), rng)[:KEPT]
    lines = [
        (
            "# Joint samples of the law of films (docs/films.md): silica on titanium, 20 runs of"
            " scene films"
        ),
        (
            "# (python -m evidence hardness.films), with the error of the assumed bonds of film and"
            " metal"
        ),
        "k_film,m_film",
        *(f"{k:.4g},{m:.4g}" for k, m in kept),
    ]
    return "\n".join(lines) + "\n"


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Errors of the laws, values with 68 % intervals, and the paper's hardness over ours."""
    of = laws()
    runs = {(row["seed"], row["film_nm"]): row["sound"] for row in rows if row["scene"] == MAIN}
    found = {
        "runs": str(len(runs)),
        "sound": f"{list(runs.values()).count('True') / len(runs):.0%}",
    }
    points = points_of(rows)
    for name in LAWS:
        found[f"{name}_left_out"] = f"{100 * left_out(name, points):.0f} %"
    found["prediction_left_out"] = f"{100 * error_left_out(points, prediction, True):.0f} %"
    ratios = points.length_over_thickness
    found["range"] = f"{ratios.min():.1f} to {ratios.max():.1f}"
    for name, value, column in zip(
        ("H_film", "H_base", "k", "m"), of["best"], of["draws"].T, strict=True
    ):
        found[name] = f"{value:.2g}{_interval(column)}"
    for length, cases in of["hardness"].items():
        for case, values in cases.items():
            found[f"{case}_{length:g}_nm"] = f"{np.median(values):.2g}{_interval(values)}"
    for case, values in of["hardness"][3.0].items():
        fall = values / of["hardness"][15.0][case]
        found[f"{case}_fall"] = f"{np.median(fall):.2g}{_interval(fall)}"
    other = points_of(rows, OTHER)
    for name in ("film", "paper"):
        found[f"{OTHER}_{name}_left_out"] = f"{100 * left_out(name, other):.0f} %"
    for thickness, stresses in ends_of_bodies(other).items():
        found[f"{OTHER}_{thickness:g}".replace(".", "_")] = stresses
    dioxide = points_of(rows, DIOXIDE)
    for body, thickness in dioxide_bodies(dioxide).items():
        if ratios := over_flat(points, dioxide.take(thickness)):
            found[f"{DIOXIDE}_{body}"] = (
                f"{np.mean(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})"
            )
    for scene in sorted({row["scene"] for row in rows}):
        runs = {
            (row["seed"], row["film_nm"]): row
            for row in rows
            if row["scene"] == scene
            and row["status"] == "yield"
            and row["slope_GPa"] not in ("", "nan")
        }
        flat = other if scene.startswith(OTHER) else points
        if scene not in (MAIN, OTHER, DIOXIDE) and (
            ratios := over_flat(flat, points_of(rows, scene))
        ):
            span = f"{min(ratios):.2f} to {max(ratios):.2f}" if len(ratios) > 1 else "one run"
            found[f"{scene}_over_flat"] = f"{np.mean(ratios):.2f} ({span})"
        if runs:
            ratios = [float(row["slope_GPa"]) / float(row["hardness_GPa"]) for row in runs.values()]
            found[f"{scene}_slope_over_plateau"] = (
                f"{np.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})"
            )
    return found


def over_flat(flat: FilmPoints, other: FilmPoints) -> list[float]:
    """Mean stress over that of the same body pressed by a flat at constant speed, a ratio for each
    run.

    Both are taken at the contact lengths that both runs reached.
    """
    ratios = []
    for seed, thickness in sorted(set(zip(other.seed, other.thickness_nm, strict=True))):
        same = [of.take((of.seed == seed) & (of.thickness_nm == thickness)) for of in (other, flat)]
        if len(both := np.intersect1d(same[0].bin, same[1].bin)):
            means = [np.mean(of.stress_GPa[np.isin(of.bin, both)]) for of in same]
            ratios.append(float(means[0] / means[1]))
    return ratios


def dioxide_bodies(points: FilmPoints) -> dict[str, np.ndarray]:
    """Which points are of titanium dioxide alone, on titanium, and of the titanium below."""
    return {
        "alone": np.isinf(points.thickness_nm),
        "film": np.isfinite(points.thickness_nm) & (points.thickness_nm > 0.0),
        "metal": points.thickness_nm == 0.0,
    }


def ends_of_bodies(points: FilmPoints) -> dict[float, str]:
    """Stress of each body at its smallest and its largest contacts, by thickness of its film: means
    over runs, GPa.
    """
    ends = {}
    for thickness in np.unique(points.thickness_nm):
        same = points.take(points.thickness_nm == thickness)
        means = [
            np.mean(same.stress_GPa[same.bin == one]) for one in (same.bin.min(), same.bin.max())
        ]
        ends[float(thickness)] = " to ".join(f"{mean:.0f}" for mean in means) + " GPa"
    return ends


def _interval(values: np.ndarray) -> str:
    low, high = np.quantile(values, [0.16, 0.84])
    return f" [{low:.2g}, {high:.2g}]"


def draw(axes: Axes) -> None:
    """Mean stress over seeds with its standard error; what the law says of 5 nm, and what was said
    before.
    """
    of = laws()
    colors = ("#20242b", "#b5482a", "#d99a2b", "#4c9a5b", "#1f5fa8")
    on_nitride = points_of(load("hardness.films"), OTHER)
    # its silica is that of the other scene
    on_nitride = on_nitride.take(np.isfinite(on_nitride.thickness_nm))
    for points, base, style in (
        (of["points"], "titanium", "o-"),
        (on_nitride, "silicon nitride", "s:"),
    ):
        for thickness, color in zip(np.unique(points.thickness_nm), colors, strict=False):
            name = {0: base, np.inf: "silica"}.get(
                thickness, f"{thickness:g} nm of silica on {base}"
            )
            same = points.take(points.thickness_nm == thickness)
            each = [
                same.take(same.bin == one)
                for one in np.unique(same.bin)
                if np.sum(same.bin == one) > 1
            ]
            error = [np.std(of_bin.stress_GPa, ddof=1) / len(of_bin.seed) ** 0.5 for of_bin in each]
            length = [np.mean(of_bin.length_nm) for of_bin in each]
            stress = [np.mean(of_bin.stress_GPa) for of_bin in each]
            axes.errorbar(length, stress, error, fmt=style, ms=3, color=color, label=name)
    for case, color in (("metal_as_pressed", "#b5482a"), ("metal_of_H_macro", "#8a8f98")):
        low, high = np.array(
            [np.quantile(of["hardness"][at][case], [0.16, 0.84]) for at in LENGTHS_NM]
        ).T
        axes.fill_between(
            LENGTHS_NM, low, high, color=color, alpha=0.2, label=f"5 nm, {case.replace('_', ' ')}"
        )
    lengths, said = np.array(LENGTHS_NM), np.array([10.5, 0.7, *PREDICTION])
    axes.plot(
        lengths,
        film(said, lengths, np.full(6, OXIDE_NM)),
        "--",
        color="#8a8f98",
        label="said before, 0.7 GPa",
    )
