"""How strongly a top of atoms attracts a smooth body, as the cut-off D0 of the law.

Every atom of the top attracts a smooth rigid half-space by a 9-3 potential
(Steele 1973, doi:10.1016/0039-6028(73)90264-1)

    u(d) = -C [1 / d^3 - r^6 / (3 d^9)],   C = A_H / (6 pi n),

whose tail is that of a continuum with the Hamaker constant A_H; n is the number of atoms a volume.
The contact distance r is the one that gives a flat stack of layers of the glass's density the work
A_H / (12 pi D^2) with D = 0.165 nm, the distance at which dense solids touch (Israelachvili,
Intermolecular and Surface Forces, 3rd ed., section 13.13).

A real top is no stack of layers: its highest atoms keep the others away. The cut-off D0 of a top is
the one with which the law A_H / (6 pi (g + D0)^3) separates a flat of the same contact area with
the same work. A_H cancels. Only atoms below the contact count: what lies beside it attracts in the
contact model, too.

By the largest force, D0 would be another one: 0.208 instead of 0.165 nm for the flat stack itself.
The work counts, because a body whose gap differs from place to place is pulled off by it: a sphere
of radius R by 2 pi R w (Derjaguin). Summed over the stack, spheres, waves and flattened tops that
sprang back pull off within 7 % of the law with D0 by work where they are 5 nm wide or more. By
force, the law misses 38 %. Only one rigid flat pulls off by its largest force
(tests/atomistic/hardness/test_top_attraction.py).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from asperity.guards.errors import InputError
from atomistic.hardness.size_effect import FIT_RULES, samples_of

DENSE_CUTOFF_A = 1.65
"""D of flat dense solids, Å (Israelachvili, section 13.13)."""
FOLLOW = (0.905, 0.037)
"""D0 of tops whose atoms follow the pull over that of rigid ones: mean of eight tops and its
standard error (study `hardness.tops`, columns free_work and whole_work)."""
RIM_ERROR = 0.045
"""Change of ln D0 where the rim of the contact area lies 0.7 Å farther out or in, as other
definitions have it.
"""
STEP_A = 0.02
"""Between the gaps at which force and energy are looked at; their extremes are then refined."""
SCATTERS = np.geomspace(0.03, 10.0, 40)
"""Standard deviations that are weighed: of runs, over what all runs have; of glasses, over that of
runs.
"""


@dataclass(frozen=True)
class TopAttraction:
    """Attraction of one top, for a Hamaker constant of 1.

    Attributes
    ----------
    area_A2 : contact area, Å².
    force_per_A : largest attractive force, over A_H, 1/Å.
    work : of separation from rest, over A_H.
    """

    area_A2: float
    force_per_A: float
    work: float


def gap_cutoff(
    witnesses: Mapping[str, Sequence[Mapping[str, float]]], glasses: Mapping[str, int]
) -> dict[str, Any] | None:
    """The cut-off D0 of all tops of some runs: its distribution, and what each run says.

    It is that of the work; the one of the largest force stands beside it. The mean over all glasses
    is known as far as runs and glasses scatter. Two factors multiply it: `FOLLOW`, since atoms of a
    top follow the pull, and `RIM_ERROR`, since the area decides how much work a flat of it has.

    Parameters
    ----------
    witnesses : rows of `Closing.witness`, by run.
    glasses : seed of each run's glass.

    Returns
    -------
    `distribution`, `values`, `unit` as an input has them, and `runs`; None where a fit needs more
    runs with a top.
    """
    runs = {run: tops for run, rows in witnesses.items() if (tops := tops_of(rows))}
    if len(runs) < FIT_RULES.least_runs:
        return None
    by_run = np.array([combined_cutoffs_nm(tops) for tops in runs.values()])
    by_work = combined_cutoffs_nm(top for tops in runs.values() for top in tops)[1]
    logs = np.log(by_run[:, 1])
    rng = np.random.default_rng(0)
    of_runs = [glasses[run] for run in runs]
    errors = mean_over_glasses(logs, of_runs, FIT_RULES.samples, rng) - logs.mean()
    follow = rng.normal(*FOLLOW, FIT_RULES.samples)
    rim = np.exp(rng.uniform(-RIM_ERROR, RIM_ERROR, FIT_RULES.samples))
    cutoffs = by_work * np.exp(errors) * follow * rim
    rows = []
    for (run, tops), (force, work) in zip(runs.items(), by_run.tolist(), strict=True):
        row = {"run": run, "snapshots": len(tops), "by_force_nm": force, "by_work_nm": work}
        rows.append(row)
    return {**samples_of(cutoffs, "nm"), "runs": rows}


def tops_of(witness: Sequence[Mapping[str, float]]) -> list[TopAttraction]:
    """Tops of the snapshots of a run with a contact; rows of `Closing.witness`."""
    tops = []
    for row in witness:
        if row["top_area_nm2"] > 0:
            force = row["top_force_over_hamaker"] / 10
            work = row["top_work_over_hamaker"]
            tops.append(TopAttraction(100 * row["top_area_nm2"], force, work))
    return tops


def mean_over_glasses(
    values: np.ndarray, glasses: Sequence[int], count: int, rng: np.random.Generator
) -> np.ndarray:
    """Samples of the mean over all glasses, of which a few were made and used repeatedly.

    Runs scatter within a glass, and glasses differ. Two glasses leave open by how much. So all
    standard deviations count, each by its restricted likelihood; that of glasses over that of runs
    has a half-Cauchy prior of scale 1 (Gelman 2006, doi:10.1214/06-BA117A).

    Parameters
    ----------
    values : of the runs, shape (runs,).
    glasses : seed of each run's glass.
    """
    of_glass = np.unique(glasses, return_inverse=True)[1]
    runs = np.bincount(of_glass)
    means = np.bincount(of_glass, values) / runs
    within = np.sum((values - means[of_glass]) ** 2)
    freedom = len(values) - len(runs)
    scale = max(float(values.std()), np.finfo(float).eps)
    of_runs, ratio = (grid[..., None] for grid in np.meshgrid(scale * SCATTERS, SCATTERS))
    weights = 1 / (of_runs**2 * (ratio**2 + 1 / runs))
    total = weights.sum(axis=-1)
    centre = weights @ means / total
    squares = weights * (means - centre[..., None]) ** 2
    logs = 0.5 * (np.log(weights) - squares).sum(axis=-1) - 0.5 * np.log(total)
    logs += (-freedom * np.log(of_runs) - 0.5 * within / of_runs**2)[..., 0]
    logs += (np.log(ratio) - np.log1p(ratio**2))[..., 0]  # even steps of the logarithm
    shares = np.exp(logs - logs.max()).ravel()
    chosen = rng.choice(shares.size, count, p=shares / shares.sum())
    error = rng.normal(size=count) / np.sqrt(total.ravel()[chosen])
    return centre.ravel()[chosen] + error


def combined_cutoffs_nm(tops: Iterable[TopAttraction]) -> tuple[float, float]:
    """Cut-offs D0 of contacts that pull side by side, nm: by their forces, and by works.

    Forces, works and areas add up, so that each contact counts with its area.
    """
    tops = list(tops)
    area = sum(top.area_A2 for top in tops)
    force = sum(top.force_per_A for top in tops)
    work = sum(top.work for top in tops)
    by_force = (area / (6 * np.pi * force)) ** (1 / 3)
    by_work = (area / (12 * np.pi * work)) ** 0.5
    return by_force / 10, by_work / 10


def attract_top(
    heights_A: np.ndarray, shares: np.ndarray, area_A2: float, density_per_A3: float
) -> TopAttraction:
    """Largest force and work between the atoms of a rigid top and a smooth half-space above them.

    Parameters
    ----------
    heights_A : of the atoms, shape (atoms,).
    shares : of each atom, between 0 and 1: how much of it counts.
    area_A2 : contact area.
    density_per_A3 : atoms a volume of the glass.

    Raises
    ------
    InputError : no atom counts, or there is no contact area.
    """
    if not shares.any() or area_A2 <= 0:
        raise InputError("the top has no atoms below its contact: its attraction cannot be told")
    counted = shares > 0
    depths = heights_A[counted].max() - heights_A[counted]
    shares = shares[counted]
    contact = contact_distance_A(density_per_A3)

    def energy(gap: float) -> float:
        return float(shares @ _energy(gap + depths, contact))

    def pull(gap: float) -> float:
        return float(shares @ _pull(gap + depths, contact))

    gaps = np.arange(0.5 * contact, 3 * contact, STEP_A)
    resting = _lowest(energy, gaps)
    apart = np.arange(resting, 3 * contact, STEP_A)
    strongest = _lowest(lambda gap: -pull(gap), apart)
    of_hamaker = 1 / (6 * np.pi * density_per_A3)
    return TopAttraction(area_A2, of_hamaker * pull(strongest), -of_hamaker * energy(resting))


@lru_cache
def contact_distance_A(density_per_A3: float) -> float:
    """Distance r at which an atom rests above a half-space, Å; see the module's docstring."""
    # what lies deeper enters as a continuum
    spacing = density_per_A3 ** (-1 / 3)
    layers = 400
    work = 0.5 / (DENSE_CUTOFF_A**2 * spacing)  # of one atom of the uppermost layer, in units of C

    def excess(contact: float) -> float:
        depths = spacing * np.arange(layers)
        deeper = 0.5 / (spacing * (spacing * (layers - 0.5) + contact) ** 2)
        gaps = np.arange(0.5 * contact, 1.5 * contact, STEP_A)

        def energy(gap: float) -> float:
            return float(_energy(gap + depths, contact).sum())

        return deeper - energy(_lowest(energy, gaps)) - work

    root: Any = brentq(excess, 0.5 * DENSE_CUTOFF_A, 4 * DENSE_CUTOFF_A)
    return float(root)


def bulk_density_per_A3(positions_A: np.ndarray, area_A2: float) -> float:
    """Atoms a volume of the base, from positions (atoms, 3) over a cell of `area_A2`."""
    heights = positions_A[:, 2] - positions_A[:, 2].min()
    low, high = 6.0, 18.0  # above the frozen bottom's lowest atom: glass without a surface
    inside = (heights >= low) & (heights < high)
    return float(np.sum(inside) / (area_A2 * (high - low)))


def _energy(distances_A: np.ndarray, contact_A: float) -> np.ndarray:
    """Energy of atoms above a half-space, in units of C."""
    return contact_A**6 * distances_A**-9.0 / 3.0 - distances_A**-3.0


def _pull(distances_A: np.ndarray, contact_A: float) -> np.ndarray:
    """Attractive force on atoms above a half-space, in units of C."""
    return 3.0 * (distances_A**-4.0 - contact_A**6 * distances_A**-10.0)


def _lowest(function: Callable[[float], float], places: np.ndarray) -> float:
    """Place of the lowest value: that of the grid, refined between its neighbours."""
    k = int(np.argmin([function(place) for place in places]))
    between = places[max(k - 1, 0)], places[min(k + 1, len(places) - 1)]
    minimum: Any = minimize_scalar(
        function, bounds=between, method="bounded", options={"xatol": 1e-8}
    )
    return float(minimum.x)
