"""Do rare-event intervals of the failure rate hold what brute force finds, and what does each cost?

`repeat`: a plate on pads of a known closed form fails with a probability near 1e-2 or 1e-3, by
attraction. The same switches are drawn and solved one by one (`brute_force`), and the rare-event
method is repeated with new random numbers. `exact`: a reserve whose probability is known to be one
in a million, by independent runs of subset simulation.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from evidence.pad.closed_form import ClosedForm
from mesoscale.answer.points import Point, point_of, values_at
from mesoscale.failure.population import Population
from mesoscale.failure.rate import corrected, learn
from mesoscale.inputs.distributions import Distribution, InputTable, UncertainInput
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import SPREAD, SpreadSettings
from mesoscale.switch import switch_of
from mesoscale.switch.reserve import Attracted
from mesoscale.uncertainty.rare_events import sample_event

PLATE = DeviceSettings(spring_N_per_m=170.0, spread=SpreadSettings(**dict.fromkeys(SPREAD)))
TABLE = InputTable(
    tuple(
        UncertainInput(name, "", distribution, "literature", "")
        for name, distribution in {
            "hamaker": Distribution("uniform", 0.18, 0.25),
            "e_star": Distribution("normal", 90.0, 4.0),
            "rms": Distribution("normal", 9.0, 0.8),
        }.items()
    ),
    np.eye(3),
)
CUTOFFS_NM = (0.165, 0.265)
ATTRACTIONS = {"1e-2": 1.42, "1e-3": 1.29}
"""Factors on the attraction with which so many switches fail."""
METHODS = ("brute_force", "rare_event")
EXACT_P, DIMENSION, CONFIDENCE = 1e-6, 12, 0.9
"""Of a reserve that is a plane, whose probability is known, and the interval that is judged."""


@dataclass(frozen=True)
class KnownPad:
    """A pad whose curves are known, so that all its cells agree."""

    curves: PadCurves

    @property
    def halves(self) -> tuple[PadCurves, PadCurves]:
        """The same curves twice."""
        return self.curves, self.curves


def known_pad(point: Point, *_: int) -> KnownPad:
    """The pad of a point, of a closed form with numbers near those of Table 1, as hard as its
    switch presses.
    """
    rms, z = point.values["rms"], (point.values["e_star"] - 90.0) / 10.0
    size, hamaker = np.log(rms / 9.0), point.values["hamaker"]
    strength = -1.5 + 0.1 * z - 1.2 * np.log(point.gap_cutoff_nm / 0.165)
    form = ClosedForm(
        c0=-4.0 + 0.2 * z + 0.3 * size,
        c1_per_nm=3.0 / rms,
        c2_per_nm2=0.05 / rms**2,
        b0_per_nm=(3.5 + 0.3 * z) / rms,
        b1_per_nm2=0.2 / rms**2,
        b2_per_nm2=0.05 / rms**2,
        beta=float(np.exp(strength)) * hamaker,
        m=0.95,
        n=0.5,
        lifted=0.0,
        hamaker=hamaker,
        offset_nm=point.gap_cutoff_nm,
    )
    s = np.linspace(0.05, 12.0, 1200) * rms
    return KnownPad(form.pressed(switch_of(point.device).least_GPa(s), s))


def population(points: int = 128) -> Population:
    """The plates of the study, so many of them solved before."""
    names = [*TABLE.names, "gap_cutoff_nm"]
    units = qmc.LatinHypercube(len(names), rng=0).random(points)
    rows = values_at(units, TABLE, PLATE, CUTOFFS_NM)
    pads = [known_pad(point_of(row, TABLE.names, PLATE)) for row in rows]
    return Population(TABLE, PLATE, CUTOFFS_NM, 0.0, known_pad, (units, pads))


def arguments(parser: ArgumentParser) -> None:
    """Options on the command line."""
    parser.add_argument("--repeats", type=int, default=20)
    parser.add_argument(
        "--brute-force", type=int, default=40_000, help="plates; 0: those of a run before stand"
    )


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for brute force, and one for each repetition, of each probability."""
    plates = population()
    z = np.random.default_rng(1).normal(size=(given.brute_force, plates.dimension))
    failed, started = dict.fromkeys(ATTRACTIONS, 0), process_time()
    for point in plates.points(z, plates.hold_V):
        plate = Attracted(point.device, known_pad(point).curves, 0.0, coarse=True)
        for name, times in ATTRACTIONS.items():
            failed[name] += plate.fails(times)
    for name, count in failed.items() if len(z) else ():
        share = count / len(z)
        error = (share * (1.0 - share) / len(z)) ** 0.5
        yield _row(
            name,
            "brute_force",
            0,
            share,
            (share - 1.96 * error, share + 1.96 * error),
            len(z),
            started,
        )
    for seed in range(given.repeats):
        started = process_time()
        response = learn(plates, lambda *_: None, seed)
        for name, times in ATTRACTIONS.items():
            found = corrected(response, times, plates.hold_V, seed)
            solved = response.switches + found.runs
            yield _row(
                name,
                "rare_event",
                seed,
                found.probability,
                (found.low, found.high),
                solved,
                started,
            )
    distance = -float(ndtri(EXACT_P))
    for seed in range(given.repeats):
        started = process_time()
        found = sample_event(
            lambda z: (distance + z.sum(axis=1) / np.sqrt(DIMENSION), np.full(len(z), 1e-9)),
            DIMENSION,
            0.0,
            seed,
        )
        ends = found.interval(CONFIDENCE)
        yield _row("1e-6", "exact", seed, found.probability, ends, 0, started) | {
            "variation": found.variation
        }


def _row(
    wanted: str,
    method: str,
    seed: int,
    value: float,
    interval: tuple[float, float],
    switches: int,
    started: float,
) -> dict[str, Any]:
    return {
        "wanted": wanted,
        "method": method,
        "seed": seed,
        "probability": value,
        "low": interval[0],
        "high": interval[1],
        "switches": switches,
        "cpu_s": process_time() - started,
        "variation": "",
    }


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """In how many repetitions brute force lies in the interval, and how many switches both need."""
    shown = {}
    for wanted in ATTRACTIONS:
        by = {
            kind: [row for row in table if (row["wanted"], row["method"]) == (wanted, kind)]
            for kind in METHODS
        }
        truth = float(by["brute_force"][-1]["probability"])
        held = [float(row["low"]) <= truth <= float(row["high"]) for row in by["rare_event"]]
        shown[f"held_{wanted[-1]}"] = f"{sum(held)} of {len(held)}"
        shown[f"truth_{wanted[-1]}"] = f"{truth:.2g}"
    exact = [row for row in table if row["method"] == "exact"]
    shares = np.array([float(row["probability"]) for row in exact])
    held = [float(row["low"]) <= EXACT_P <= float(row["high"]) for row in exact]
    stated = np.array([float(row["variation"]) for row in exact])
    shown["held_exact"] = f"{sum(held)} of {len(held)}"
    shown["variation_true"] = f"{shares.std(ddof=1) / shares.mean():.2f}"
    shown["variation_stated"] = f"{np.sqrt(np.mean(stated**2)):.2f}"
    return shown
