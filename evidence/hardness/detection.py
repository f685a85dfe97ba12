"""How often the detector of yield errs, at the noise of given runs: yield where there is none, yield missed.

Noise is taken from the runs themselves: stress about its running mean over the window in which stress is judged,
bond exchanges per relaxed snapshot before contact.  Made-up closing curves with that noise and a known truth go through
`find_hardness`.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from atomistic.hardness.plateau import Rows, find_hardness, may_stop
from atomistic.settings import HardnessSettings

TRUTH_GPA = 10.0
WITHIN = 0.15  # of the true stress counts as found
TRIALS = 300
NOMINAL, COVERAGE_BOUND = 0.68, 0.1  # of the interval of a run that stopped on the interval's own width


def noise_of(curve: Rows, settings: HardnessSettings, cell_area_nm2: float) -> tuple[float, float] | None:
    """Standard deviation (relative to the mean stress) and neighbour correlation of the stress; None if short."""
    rules = settings.plasticity
    stress = np.array(
        [
            row["contact_stress_GPa"]
            for row in curve
            if row["contact_length_nm"] >= rules.min_length_nm
            and row["contact_area_nm2"] <= rules.max_area_fraction * cell_area_nm2
        ]
    )
    if len(stress) < 8:
        return None
    place = np.linspace(-1, 1, len(stress))
    residual = stress - np.polyval(np.polyfit(place, stress, 3), place)
    deviation = np.sqrt(np.sum(residual**2) / (len(stress) - 4))
    correlation = np.sum(residual[1:] * residual[:-1]) / np.sum(residual**2)
    return float(deviation / stress.mean()), float(np.clip(correlation, 0, 0.9))


def detection_points(
    curves: Sequence[Rows], witnesses: Sequence[Rows], cell_areas_nm2: Sequence[float], settings: HardnessSettings
) -> list[dict]:
    """Accuracy points of the detector: rates of false and of missed yield against the bounds asked for."""
    measured = [noise_of(curve, settings, area) for curve, area in zip(curves, cell_areas_nm2, strict=True)]
    noises = [noise for noise in measured if noise is not None]
    backgrounds = [
        find_hardness(curve, witness, area, settings.closing, settings.plasticity).exchanges_before
        for curve, witness, area in zip(curves, witnesses, cell_areas_nm2, strict=True)
    ]
    if not noises or np.all(np.isnan(backgrounds)):
        return []
    noise = float(np.median([deviation for deviation, _ in noises]))
    largest = float(np.max([deviation for deviation, _ in noises]))
    correlation = float(np.median([value for _, value in noises]))
    background = float(np.nanmax(backgrounds))
    rows = []
    for label, deviation in (("median", noise), ("largest", largest)):
        rng = np.random.default_rng(np.random.SeedSequence([21]))
        draw = _Draw(rng, deviation * TRUTH_GPA, correlation, background, settings)
        for case, what, rate, least in (
            ("elastic", "false yield", draw.rate(_elastic(1.0), 0.0, _gave_yield), False),
            ("elastic_bent", "false yield", draw.rate(_elastic(0.7), 0.0, _gave_yield), False),
            ("elastic_though_bonds_break", "false yield", draw.rate(_elastic(0.85), 40.0, _gave_yield), False),
            ("bent_though_bonds_break", "false yield", draw.rate(_elastic(0.7), 40.0, _gave_yield), False),
            ("plateau", "found within 15 %", draw.rate(_plateau, 40.0, _near_truth), True),
            ("plateau_without_broken_bonds", "false yield", draw.rate(_plateau, 0.0, _gave_yield), False),
            ("plateau_after_bonds_broke", "found within 15 %", draw.rate(_late, 40.0, _near_truth, 2.2), True),
        ):
            bound = 0.8 if least else 0.05
            rows.append(
                {
                    "case": case,
                    "knob": f"noise, {label} of the runs",
                    "value": deviation,
                    "error": 1 - rate if least else rate,
                    "error_metric": "share missed" if least else f"share with a {what}",
                    "reference": f"{what}: {'at least 80 %' if least else 'at most 5 %'}",
                    "bound": 1 - bound if least else bound,
                    "passed": rate >= bound if least else rate <= bound,
                    "trials": TRIALS,
                    "noise_GPa": deviation * TRUTH_GPA,
                    "correlation": correlation,
                    "background": background,
                }
            )
        held, used = draw.coverage()
        rows.append(
            {
                **rows[-1],
                "case": "plateau_stopped_by_its_rule",
                "error": abs(held - NOMINAL),
                "error_metric": f"share of intervals that hold the truth is {held:.2f}, after {used:.0f} averages",
                "reference": f"{NOMINAL:.0%} of intervals hold it",
                "bound": COVERAGE_BOUND,
                "passed": abs(held - NOMINAL) <= COVERAGE_BOUND,
            }
        )
    return rows


Stress = Callable[[np.ndarray], np.ndarray]


def _elastic(exponent: float) -> Stress:
    return lambda length: TRUTH_GPA * (np.maximum(length, 1e-9) / 3.0) ** exponent


def _plateau(length: np.ndarray) -> np.ndarray:
    """Elastic to 2.6 nm, then a slope of a fifteenth."""
    slope = 1.5 * TRUTH_GPA / 2.6
    return TRUTH_GPA + np.where(length < 2.6, slope, slope / 15) * (length - 2.6)


def _level(length: np.ndarray) -> np.ndarray:
    """Elastic to 2.6 nm, then level."""
    return TRUTH_GPA * np.minimum(length / 2.6, 1)


def _late(length: np.ndarray) -> np.ndarray:
    """Elastic to 3 nm, then level."""
    return TRUTH_GPA * np.minimum(length / 3, 1)


def _gave_yield(status: str, hardness: float) -> bool:
    return status == "yield"


def _near_truth(status: str, hardness: float) -> bool:
    return status == "yield" and abs(hardness / TRUTH_GPA - 1) < WITHIN


class _Draw:
    """Made-up runs: 30 averages in the window, a snapshot every 0.1 nm of travel."""

    def __init__(
        self,
        rng: np.random.Generator,
        noise_GPa: float,
        correlation: float,
        background: float,
        settings: HardnessSettings,
    ) -> None:
        self.rng, self.noise, self.correlation, self.background = rng, noise_GPa, correlation, background
        self.settings = settings
        self.travel = np.arange(0.0125, 1.6, 0.025)
        self.length = np.maximum(0.0, 3.4 * (self.travel - 0.3))

    def stress(self, truth: Stress) -> np.ndarray:
        shocks = self.rng.normal(0, self.noise * np.sqrt(1 - self.correlation**2), len(self.length))
        noise = np.empty_like(shocks)
        noise[0] = self.rng.normal(0, self.noise)
        for k in range(1, len(shocks)):
            noise[k] = self.correlation * noise[k - 1] + shocks[k]
        return truth(self.length) + noise

    def rate(self, truth: Stress, bursts: float, judge: Callable[[str, float], bool], onset_nm: float = 2.6) -> float:
        """Share of runs for which `judge` holds; `bursts`: bond exchanges per snapshot beyond the onset's length."""
        return sum(judge(*self._run(truth, bursts, onset_nm)) for _ in range(TRIALS)) / TRIALS

    def coverage(self) -> tuple[float, float]:
        """Of runs on a level plateau that stop by their rule: share whose interval holds the truth, averages used."""
        held, used = 0, []
        for _ in range(TRIALS):
            curve, witness, cell = self._made(_level, 40.0, 2.6)
            per = round(0.1 / 0.025)  # averages in a segment
            rules = (cell, self.settings.closing, self.settings.plasticity)
            ends = range(per, len(curve), per)
            end = next((k for k in ends if may_stop(curve[:k], witness[: k // per + 1], *rules)), len(curve))
            hardness = find_hardness(curve[:end], witness[: end // per + 1], *rules)
            held += hardness.hardness_lo <= TRUTH_GPA <= hardness.hardness_hi
            used.append(hardness.plateau_points)
        return held / TRIALS, float(np.mean(used))

    def _run(self, truth: Stress, bursts: float, onset_nm: float) -> tuple[str, float]:
        hardness = find_hardness(*self._made(truth, bursts, onset_nm), self.settings.closing, self.settings.plasticity)
        return hardness.status, hardness.hardness_GPa

    def _made(self, truth: Stress, bursts: float, onset_nm: float) -> tuple[Rows, Rows, float]:
        """Curve, witness and area of the cell of a made-up run."""
        onset = float(np.interp(onset_nm, self.length, self.travel))
        snapshots = np.arange(0.0, self.travel[-1], 0.1)
        witness: list[Mapping[str, float]] = []
        for k, travel in enumerate(snapshots.tolist()):
            plastic = bursts > 0 and travel >= onset
            exchanges = self.rng.poisson(self.background + bursts * plastic) if k else 0
            lowering = 0.1 * plastic + self.rng.normal(0, 0.005)  # the top of a relaxed sample flickers by 0.05 Å
            witness.append({"displacement_nm": travel, "new_exchanges": exchanges, "lowering_nm": lowering})
        stress = self.stress(truth)
        curve = [
            {
                "time_ps": 0.5 * (k + 1),
                "displacement_nm": float(self.travel[k]),
                "contact_length_nm": float(self.length[k]),
                "contact_area_nm2": float(self.length[k] ** 2),
                "contact_stress_GPa": float(stress[k]),
                "temperature_K": 300.0,
                "energy_drift_meV_per_atom": 0.0,
            }
            for k in range(len(stress))
        ]
        cell = 4.2**2 / self.settings.plasticity.max_area_fraction
        return curve, witness, cell
