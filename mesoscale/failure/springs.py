"""The least spring with which no more switches fail than allowed, all else varying.

A weaker spring makes those fail that nearly fail with more attraction. So some of these are solved
with other springs, and correct their probability as runs correct a response
(`mesoscale.failure.rate`). Their pads are pressed with the stiffest spring, which is asked for
first: a stiff switch that pulls in above its hold voltage presses its pad hardest. They serve all
weaker springs and all laws of attraction.
"""

from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mesoscale.answer.points import Point
from mesoscale.errors import InputError
from mesoscale.failure.population import FAILURE, Population, Pressed, surfaces_number
from mesoscale.switch.reserve import Attracted
from mesoscale.uncertainty.rare_events import Sampled

Array = NDArray[np.float64]


class Sprung:
    """Switches that nearly fail, each on one pad, with other springs.

    What is known of a switch tells more: one that fails also does with a weaker spring or more
    attraction.

    Parameters
    ----------
    likely : the failures with about the allowed probability by the response.
    """

    def __init__(self, population: Population, likely: Sampled, hold_V: float) -> None:
        rng = np.random.default_rng(np.random.SeedSequence([0, 0x5B1]))
        chosen = rng.permutation(len(likely.points))[: FAILURE.spring_runs]
        self.population = population
        self.hold_V = hold_V
        self.z = likely.points[chosen]
        self.chance = likely.chance[chosen]
        self.by_response = likely.probability
        self.own_spring = float(getattr(population.settings, population.spring))
        self._pads: list[tuple[float, Pressed] | None] = [None] * len(chosen)
        self._known: list[list[tuple[float, float, bool]]] = [[] for _ in chosen]
        self._refused = [np.inf] * len(chosen)
        self._stiffest = -np.inf

    def fails_too_often(self, logarithm: float, times: float, allowed: float) -> bool:
        """Whether more than allowed fail with a spring, by the logarithm of its share of the
        scene's. Switches are solved only until that is decided.
        """
        self._stiffest = max(self._stiffest, logarithm)
        weights = 1.0 / self.chance
        most = allowed / self.by_response * len(weights)
        outcomes = [self._foretold(k, logarithm, times) for k in range(len(weights))]
        failing = float(sum(weights[k] for k, failed in enumerate(outcomes) if failed))
        undecided = [k for k, failed in enumerate(outcomes) if failed is None]
        undecided_weight = float(weights[undecided].sum())
        points = self._points(logarithm)
        for k in undecided:
            if failing > most or failing + undecided_weight <= most:
                break
            undecided_weight -= float(weights[k])
            if self._solved(k, points[k], logarithm, times):
                failing += float(weights[k])
        return failing > most

    def _points(self, logarithm: float) -> list[Point]:
        """The switches with another spring."""
        changed = self.population.settings.model_copy(
            update={self.population.spring: self.own_spring * float(np.exp(logarithm))}
        )
        return replace(self.population, settings=changed).points(self.z, self.hold_V)

    def _foretold(self, k: int, logarithm: float, times: float) -> bool | None:
        """Whether a switch fails, by what is known of it; None where that does not tell."""
        if logarithm >= self._refused[k]:
            return True
        for stiffness, attraction, failed in self._known[k]:
            if failed and stiffness >= logarithm and attraction <= times:
                return True
            if not failed and stiffness <= logarithm and attraction >= times:
                return False
        return None

    def _solved(self, k: int, point: Point, logarithm: float, times: float) -> bool:
        """Whether a switch fails, solved on its pad."""
        try:
            curves = self._pad(k, point, logarithm).curves
            failed = Attracted(point.device, curves, self.population.release_V).fails(times)
        except InputError:  # as every stiffer one, which presses harder; it tells of no weaker one
            self._refused[k] = logarithm
            return True
        self._known[k].append((logarithm, times, failed))
        return failed

    def _pad(self, k: int, point: Point, logarithm: float) -> Pressed:
        """The pad of a switch, pressed for the stiffest spring so far, or where that is too hard
        for its own.
        """
        remembered = self._pads[k]
        if remembered is None and logarithm < self._stiffest:
            with suppress(InputError):
                stiffest = self._points(self._stiffest)[k]
                remembered = (self._stiffest, self._pressed(k, stiffest))
        if remembered is None or remembered[0] < logarithm:
            remembered = (logarithm, self._pressed(k, point))
        self._pads[k] = remembered
        return remembered[1]

    def _pressed(self, k: int, point: Point) -> Pressed:
        return self.population.press(point, 1, surfaces_number(self.z[k]))


def least_spring(sprung: Sprung, times: float, allowed: float) -> float | None:
    """Least spring, in the unit of its setting, with which no more switches fail than allowed.

    A stiff switch that pulls in above its hold voltage may press harder than its pad bears. Then
    weaker springs are tried, down to the scene's own. None where all of these fail too often, or
    where none nearly fails.
    """
    if not len(sprung.z):
        return None

    def too_many(logarithm: float) -> bool:
        return sprung.fails_too_often(logarithm, times, allowed)

    low, stiffest = np.log(FAILURE.springs).tolist()
    tried = np.linspace(stiffest, 0.0, FAILURE.stiff_springs).tolist()
    high = next((logarithm for logarithm in tried if not too_many(logarithm)), None)
    if high is None:
        return None
    while high - low > FAILURE.near:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if too_many(middle) else (low, middle)
    return sprung.own_spring * float(np.exp(high))
