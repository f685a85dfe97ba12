"""How often does the detector of yield err?

Made-up closing curves with a known truth go through `find_hardness`.  The noise is the median and
the largest of the runs of scene `reduced`: stress about its running mean over the window in which
stress is judged.  Curves are too short to tell the correlation of neighbours better than between
the two values here.  The bounds were set beforehand; the largest exponent of a plateau, its start
and the interval of its mean were chosen by such rates.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import product

import numpy as np

from atomistic.hardness.plateau import RULES, Hardness, Rows, find_hardness, may_stop

TRUTH_GPA = 10.0
WITHIN = 0.15  # of the true stress counts as found
Stress = Callable[[np.ndarray], np.ndarray]


def arguments(parser: ArgumentParser) -> None:
    """The noise, and how many curves there are of each case."""
    parser.add_argument(
        "--noise",
        type=float,
        nargs="+",
        default=[0.042, 0.064],
        help="of the stress, relative to it",
    )
    parser.add_argument(
        "--correlation", type=float, nargs="+", default=[0.0, 0.4], help="of neighbouring averages"
    )
    parser.add_argument(
        "--background", type=float, default=36.0, help="bond exchanges per snapshot before contact"
    )
    parser.add_argument("--trials", type=int, default=2000)


def rows(given: Namespace) -> Iterator[dict]:
    """Rates of yield found where there is none, and missed where there is one, against the bounds
    set beforehand.
    """
    for noise, correlation in product(given.noise, given.correlation):
        draw = Draw(
            np.random.default_rng(np.random.SeedSequence([21])),
            noise,
            correlation,
            given.background,
        )
        label = {"noise": noise, "correlation": correlation, "trials": given.trials}

        def rate(
            judge: Callable[[Hardness], bool], truth: Stress, bursts: float, onset_nm: float = 2.6
        ) -> float:
            made = (draw.run(truth, bursts, onset_nm) for _ in range(given.trials))  # noqa: B023
            return sum(judge(find_hardness(*run)) for run in made) / given.trials

        for case, truth, bursts in (
            ("elastic", elastic(1.0), 0.0),
            ("elastic_bent", elastic(0.7), 0.0),
            ("elastic_though_bonds_break", elastic(0.85), 40.0),
            ("bent_though_bonds_break", elastic(0.7), 40.0),
            ("plateau_without_broken_bonds", kink, 0.0),
        ):
            wrong = rate(lambda found: found.status == "yield", truth, bursts)
            yield {"case": case, "error": "yield found", "rate": wrong, "bound": 0.05, **label}
        for case, truth, onset_nm in (
            ("plateau", kink, 2.6),
            ("plateau_after_bonds_broke", late, 2.2),
        ):
            missed = 1 - rate(near_truth, truth, 40.0, onset_nm)
            yield {
                "case": case,
                "error": "missed, or more than 15 % off",
                "rate": missed,
                "bound": 0.2,
                **label,
            }
        lost = 1 - sum(draw.held() for _ in range(given.trials)) / given.trials
        yield {
            "case": "stopped_by_its_rule",
            "error": "interval misses the truth",
            "rate": lost,
            "bound": 0.42,
            **label,
        }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Largest rates at each noise, and how often the interval of a run that stops by its rule holds
    the truth.
    """
    found = {}
    noises = sorted({float(row["noise"]) for row in rows})
    for name, noise in (("median", noises[0]), ("largest", noises[-1])):
        for key, error in (("false", "yield found"), ("missed", "missed, or more than 15 % off")):
            rates = [
                float(row["rate"])
                for row in rows
                if float(row["noise"]) == noise and row["error"] == error
            ]
            found[f"{key}_{name}"] = f"{100 * max(rates):.1f} %"
    lost = [float(row["rate"]) for row in rows if row["case"] == "stopped_by_its_rule"]
    return {**found, "held": f"{100 * (1 - max(lost)):.0f} to {100 * (1 - min(lost)):.0f} %"}


def near_truth(found: Hardness) -> bool:
    """Was the plateau found?"""
    return found.status == "yield" and abs(found.hardness_GPa / TRUTH_GPA - 1) < WITHIN


def elastic(exponent: float) -> Stress:
    """A stress that never levels off."""
    return lambda length: TRUTH_GPA * (np.maximum(length, 1e-9) / 3.0) ** exponent


def kink(length: np.ndarray) -> np.ndarray:
    """Elastic to 2.6 nm, then a slope of a fifteenth."""
    slope = 1.5 * TRUTH_GPA / 2.6
    return TRUTH_GPA + np.where(length < 2.6, slope, slope / 15) * (length - 2.6)


def level(length: np.ndarray) -> np.ndarray:
    """Elastic to 2.6 nm, then level."""
    return TRUTH_GPA * np.minimum(length / 2.6, 1)


def late(length: np.ndarray) -> np.ndarray:
    """Level only beyond 3 nm, though bonds break from 2.2 nm on."""
    return TRUTH_GPA * np.minimum(length / 3, 1)


class Draw:
    """Made-up runs: 30 averages in the window, a snapshot every 0.1 nm of travel; each is curve,
    witness, cell area.
    """

    travel = np.arange(0.0125, 1.6, 0.025)
    length = np.maximum(0.0, 3.4 * (travel - 0.3))
    cell_nm2 = 4.2**2 / RULES.max_area_fraction

    def __init__(
        self, rng: np.random.Generator, noise: float, correlation: float, background: float
    ) -> None:
        self.rng, self.noise, self.correlation, self.background = (
            rng,
            noise * TRUTH_GPA,
            correlation,
            background,
        )

    def held(self) -> bool:
        """Does the interval of a run on a level plateau that stops by its rule hold the truth?"""
        curve, witness, cell = self.run(level, 40.0, 2.6)
        per = round(0.1 / 0.025)  # averages in a segment
        ends = range(per, len(curve), per)
        end = next(
            (k for k in ends if may_stop(curve[:k], witness[: k // per + 1], cell)), len(curve)
        )
        found = find_hardness(curve[:end], witness[: end // per + 1], cell)
        return found.hardness_lo <= TRUTH_GPA <= found.hardness_hi

    def run(self, truth: Stress, bursts: float, onset_nm: float) -> tuple[Rows, Rows, float]:
        """One run; `bursts`: bond exchanges per snapshot beyond the onset's length."""
        onset = float(np.interp(onset_nm, self.length, self.travel))
        witness: list[Mapping[str, float]] = []
        for k, travel in enumerate(np.arange(0.0, self.travel[-1], 0.1).tolist()):
            plastic = bursts > 0 and travel >= onset
            exchanges = self.rng.poisson(self.background + bursts * plastic) if k else 0
            # the top of a relaxed sample flickers by 0.05 Å
            lowering = 0.1 * plastic + self.rng.normal(0, 0.005)
            witness.append(
                {"displacement_nm": travel, "new_exchanges": exchanges, "lowering_nm": lowering}
            )
        noise = self.rng.normal(0, self.noise, len(self.length))
        for k in range(1, len(noise)):
            noise[k] = self.correlation * noise[k - 1] + np.sqrt(1 - self.correlation**2) * noise[k]
        stress = truth(self.length) + noise
        columns = {
            "time_ps": 0.5 * (1 + np.arange(len(stress))),
            "displacement_nm": self.travel,
            "contact_length_nm": self.length,
            "contact_area_nm2": self.length**2,
            "contact_stress_GPa": stress,
            "temperature_K": np.full(len(stress), 300.0),
            "energy_drift_meV_per_atom": np.zeros(len(stress)),
        }
        curve = [
            dict(zip(columns, values, strict=True))
            for values in zip(*columns.values(), strict=True)
        ]
        return curve, witness, self.cell_nm2
