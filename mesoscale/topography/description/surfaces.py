"""Are the measurements of one surface, or of several?

On one film ln C_kb = f_b + a_k + s_k x_b + error: a place k has a level and, less, a tilt of its
own over x = ln q. Levels and tilts scatter about one middle. On two films they fall into two heaps.
Which map is of which film is not told, so each cut of the ordered values into two heaps is asked
(for one variable the best two heaps are such a cut, doi:10.1080/01621459.1958.10501479): how far
are their means apart, over the scatter within? How large the largest answer is by chance says a
simulation of as many places of one film, with the scatter and the errors found here.

A scatter that is estimated hides two films whose places differ by as much as the films do. With six
maps the means must be about ten times the scatter apart (python -m evidence topography.surfaces has
the error rates).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mesoscale.topography.description.bands import BANDS_PER_DECADE, on_bands
from mesoscale.topography.description.doubts import Doubt
from mesoscale.topography.description.overlaps import MOST_MISFIT, Overlap
from mesoscale.topography.description.trusted_range import TrustedSpectrum

Array = np.ndarray
FALSE_ALARMS = 0.05
"""Of films of one surface, shared by level, tilt and the furthest pair."""
SIMULATED = 999
"""Sets of places behind a probability."""
FEWEST = 4
"""Measurements; of fewer no scatter within two heaps can be told from a difference."""


@dataclass(frozen=True)
class Cut:
    """Places in two heaps by one property of theirs.

    Attributes
    ----------
    score : distance of the means over its standard deviation, by errors and scatter within the
        heaps.
    apart : distance of the means.
    low, high : numbers of the places of each heap.
    """

    score: float
    apart: float
    low: Array
    high: Array


def levels_and_tilts(spectra: Sequence[TrustedSpectrum]) -> dict[str, tuple[Array, Array]]:
    """Level and tilt (n,) of the measurements about their means, with covariance."""
    bands = [on_bands(item) for item in spectra]
    band = np.concatenate([numbers for numbers, _, _ in bands])
    owner = np.repeat(np.arange(len(bands)), [len(numbers) for numbers, _, _ in bands])
    value = np.concatenate([levels for _, levels, _ in bands])
    variance = np.concatenate([variances for _, _, variances in bands])
    _, index, count = np.unique(band, return_inverse=True, return_counts=True)
    shared = count[index] > 1
    if not shared.any():
        return {}
    band = band[shared]
    owner = owner[shared]
    value = value[shared]
    variance = variance[shared]
    index = index[shared]
    x = band * np.log(10) / BANDS_PER_DECADE
    x = x - np.average(x, weights=1 / variance)
    film = np.eye(len(count))[index]
    places = np.eye(len(bands))[owner]
    mean_free = np.eye(len(bands)) - 1 / len(bands)
    estimates = {}
    systems = {"level": [film, places], "tilt": [film, places, places * x[:, None]]}
    for name, columns in systems.items():
        system = np.hstack(columns)
        prior = np.full(system.shape[1], 0.01)  # of a level that no shared band ties to the others
        prior[: len(count)] = 1e-6
        information = system.T @ (system / variance[:, None])
        covariance = np.linalg.inv(information + np.diag(prior))
        last = slice(-len(bands), None)
        solution = covariance @ (system.T @ (value / variance))
        estimates[name] = mean_free @ solution[last], mean_free @ covariance[last, last] @ mean_free
    return estimates


def best_cut(values: Array, covariance: Array) -> Cut:
    """The cut of n values, errors `covariance` (n, n), with heaps furthest apart."""
    n = len(values)
    order = np.argsort(values)
    values = values[order]
    covariance = covariance[np.ix_(order, order)]
    below = np.arange(1, n)
    above = n - below
    # sums over the first j values, and of the blocks of the covariance that a cut behind them makes
    summed = np.cumsum(values)
    squares = float(values @ values)
    block_sums = np.cumsum(np.cumsum(covariance, axis=0), axis=1)
    low = block_sums.diagonal()[:-1]
    across = np.cumsum(covariance.sum(axis=1))[:-1] - low
    high = covariance.sum() - low - 2 * across
    first = summed[:-1]
    second = summed[-1] - summed[:-1]
    apart = second / above - first / below
    within = squares - first**2 / below - second**2 / above
    expected = np.trace(covariance) - low / below - high / above
    scatter = np.maximum(within - expected, 0.0) / (n - 2)
    own_variance = low / below**2 + high / above**2 - 2 * across / (below * above)
    variance = own_variance + scatter * (1 / below + 1 / above)
    score = apart / np.sqrt(variance)
    best = int(np.argmax(score))
    heaps = order[: best + 1], order[best + 1 :]
    return Cut(float(score[best]), float(apart[best]), *heaps)


def by_chance(values: Array, covariance: Array, score: float) -> float:
    """Probability that places of one film give a best cut of `score` or more."""
    n = len(values)
    mean_free = np.eye(n) - 1 / n
    excess = float(values @ mean_free @ values - np.trace(mean_free @ covariance))
    scatter = max(excess, 0.0) / (n - 1)
    spread, vectors = np.linalg.eigh(covariance + scatter * np.eye(n))
    normals = np.random.default_rng(4).standard_normal((SIMULATED, n))
    drawn = normals @ (vectors * np.sqrt(np.maximum(spread, 0.0))).T
    return (1 + sum(best_cut(row, covariance).score >= score for row in drawn)) / (SIMULATED + 1)


def two_heaps(spectra: Sequence[TrustedSpectrum]) -> tuple[str, Cut, float] | None:
    """The property that parts two surfaces, the heaps, and the chance of one surface; else None."""
    if len(spectra) < FEWEST:
        return None
    estimates = levels_and_tilts(spectra)
    cuts = {name: best_cut(*estimate) for name, estimate in estimates.items()}
    # 0.2 of ln C is 10 % of the RMS height; the same of the slope of ln C over ln q
    cuts = {name: cut for name, cut in cuts.items() if cut.apart > 0.2}
    if not cuts:
        return None
    chances = {name: by_chance(*estimates[name], cut.score) for name, cut in cuts.items()}
    name = min(chances, key=lambda name: chances[name])
    if chances[name] > FALSE_ALARMS / 3:
        return None
    return name, cuts[name], chances[name]


def several_surfaces(
    spectra: Sequence[TrustedSpectrum], pairs: Sequence[Overlap], files: Mapping[str, str]
) -> list[Doubt]:
    """A doubt where the measurements do not look like places of one surface; it names the groups.

    Parameters
    ----------
    files : of the measurements, by name.
    """
    heaps = two_heaps(spectra)
    if heaps is not None:
        name, cut, chance = heaps
        groups = [[spectra[place].name for place in sorted(heap)] for heap in (cut.low, cut.high)]
        differ = f"by {cut.apart:.2g} in slope"
        if name == "level":
            differ = f"by a factor of {np.exp(cut.apart):.2g} in C"
        text = (
            f"{_listed(groups[0])} and {_listed(groups[1])} look like two surfaces: their spectra"
            f" differ {differ}, more than places of one surface do (by chance once in"
            f" {1 / chance:.0f})"
        )
        return [Doubt("several_surfaces", text, _apart(groups, files), fatal=True)]
    strangers = [pair for pair in pairs if not pair.one_surface(FALSE_ALARMS / 3 / len(pairs))]
    if strangers:
        worst = max(strangers, key=_distance)
        differ = f"by a factor of {max(worst.ratio, 1 / worst.ratio):.2g}"
        if worst.misfit > MOST_MISFIT:
            differ = f"in shape, by {np.sqrt(worst.misfit):.2g} times their errors"
        text = (
            f"{worst.first} and {worst.second} look like two surfaces: from {worst.low:.2g} to"
            f" {worst.high:.2g} /nm their spectra differ {differ}"
        )
        remedy = _apart([[worst.first], [worst.second]], files)
        return [Doubt("several_surfaces", text, remedy, fatal=True)]
    apart = [pair for pair in pairs if not pair.agrees]
    if apart and len(spectra) < FEWEST:
        worst = max(apart, key=lambda pair: abs(np.log(pair.ratio)))
        text = (
            f"{worst.first} and {worst.second} differ by a factor of"
            f" {max(worst.ratio, 1 / worst.ratio):.2g} in C; fewer than {FEWEST} measurements"
            " cannot tell two surfaces from places of one"
        )
        return [Doubt("few_places", text, "measure other places of the surface", "rms")]
    return []


def _distance(pair: Overlap) -> float:
    """How far two spectra are apart: in shape, or by a factor (ln)."""
    return max(pair.misfit, abs(np.log(pair.ratio)))


def _listed(names: Sequence[str]) -> str:
    more = len(names) - 6
    listed = ", ".join(names[:6])
    if more > 0:
        listed += f" and {more} more"
    return listed


def _apart(groups: Sequence[Sequence[str]], files: Mapping[str, str]) -> str:
    """How to run the groups apart: one line of a scene each, where no file belongs to both."""
    scans = [list(dict.fromkeys(files.get(name, name) for name in group)) for group in groups]
    if set(scans[0]) & set(scans[1]):
        return (
            "export each group to files of its scans; if they are one surface, set"
            " topography.on_doubt: warn"
        )
    scenes = " and ".join(f"topography: {{scans: [{', '.join(names)}]}}" for names in scans)
    return (
        f"run them apart, in scenes with {scenes}; if they are one surface, set"
        " topography.on_doubt: warn"
    )
