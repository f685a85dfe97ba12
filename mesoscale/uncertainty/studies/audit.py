"""Reproduction audit: which readings of the paper come closest to its Tables 2 and 3.

A reading is one choice for every ambiguity of the contact model (`CHOICES`) and of the law's fit
(`LAW_READINGS`); docs/contact_reference.md lists them, docs/uncertainty_reference.md the ranking.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.inputs.distributions import InputTable
from mesoscale.law.branches import fit_cycle
from mesoscale.law.parameters import LAW_OUTPUTS, OUTPUTS
from mesoscale.settings import ContactSettings, LawSettings
from mesoscale.uncertainty.collocation import elementary_effects, level1_response
from mesoscale.uncertainty.designs import Run
from mesoscale.uncertainty.runs import compute_all
from mesoscale.uncertainty.studies.readings import CHOICES, COUPLED, MENDED

Array = NDArray[np.float64]

LAW_READINGS: dict[str, dict[str, Any]] = {
    "first_contact": {"contact_definition": "first_contact"},
    "first_contact_relative": {"contact_definition": "first_contact", "weights": "relative"},
    "force_0.01": {"contact_definition": "force_fraction", "force_fraction": 0.01},
    "force_0.03": {"contact_definition": "force_fraction", "force_fraction": 0.03},
    "force_0.1": {"contact_definition": "force_fraction", "force_fraction": 0.1},
    "free_fit": {"contact_definition": "free_fit"},
}
"""Ways of fitting the law."""


def with_reading(name: str, settings: ContactSettings) -> ContactSettings:
    """Contact settings with the choices of a reading's name put in."""
    values = name.split(".")
    if values[-1] == COUPLED:
        settings, values = settings.model_copy(update={"mechanics": COUPLED}), values[:-1]
    keys = (*CHOICES, *MENDED) if len(values) > len(CHOICES) else CHOICES
    chosen: dict[str, Any] = dict(zip(keys, values, strict=True))
    chosen["touching_attracts"] = chosen["touching_attracts"] == "true"
    return settings.model_copy(update=chosen)


def audit_rows(
    reading: str,
    runs: Sequence[Run],
    contact: ContactSettings,
    law: LawSettings,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[dict[str, Any]]:
    """The outputs of every run under one reading of the contact and all readings of the law."""
    laws = {name: law.model_copy(update=update) for name, update in LAW_READINGS.items()}
    settings = with_reading(reading, contact)
    for run, cycle in compute_all(runs, settings, progress):
        for name, law_settings in laws.items():
            row: dict[str, Any] = {"contact": reading, "law": name, "seed": run.seed, "node": run.node}
            if isinstance(cycle, str):
                yield {**row, "converged": False}
                continue
            outcome = fit_cycle(cycle, law_settings)
            numbers = outcome.outputs.tolist()
            yield {
                **row,
                "converged": cycle.converged,
                **{key: x if np.isfinite(x) else "" for key, x in zip(OUTPUTS, numbers, strict=True)},
            }


MISPRINT = 20.0
"""mu* of one input is at most sqrt(12) = 3.5 deviations of the linear response; an entry of Table 3 beyond
that many (delta_C_a, q0: 335.9) contradicts Table 2 under every labeling and is left out."""
RESAMPLES = 200
AUDIT_COLUMNS = ("contact", "law", "seed", "node", "converged", *OUTPUTS)


def rank(
    rows: Sequence[Mapping[str, str]],
    table: InputTable,
    central_share: float,
    tables2: Sequence[Mapping[str, tuple[float, float]]],
    tables3: Sequence[Mapping[str, Mapping[str, float]]],
) -> list[dict[str, Any]]:
    """Readings by their distance to the paper's tables, nearest first.

    The distance of Table 2 is the root mean square, over outputs, of (mean - paper's mean)/paper's deviation
    and ln(deviation/paper's); that of Table 3 of (mu* - paper's)/(sqrt(12) paper's deviation) over outputs
    and inputs, without the entry that cannot be right (MISPRINT). Both use means over seeds; the smallest
    over the labelings of the doubtful columns counts. Intervals (5 to 95 %) come from resampling the seeds.

    Parameters
    ----------
    tables2, tables3 : the paper's tables under each labeling (same order).
    """
    ranges = table.ranges(central_share)
    inputs = len(table.rows)
    short = [output.short for output in LAW_OUTPUTS]
    rng = np.random.default_rng(np.random.SeedSequence([len(rows)]))
    ranked = []
    for contact, law in dict.fromkeys((row["contact"], row["law"]) for row in rows):
        chosen = [row for row in rows if (row["contact"], row["law"]) == (contact, law)]
        y = _arrange(chosen)
        moments = _moments(y, ranges)
        # mean, deviation, mu*: averages over the seeds that have all nodes
        average, scatter = _over_seeds(moments)
        best = min(
            (_distance(average, short, table.names, two, three), label)
            for label, (two, three) in enumerate(zip(tables2, tables3, strict=True))
        )
        two, three = tables2[best[1]], tables3[best[1]]
        resampled = [
            _distance(_over_seeds(moments[rng.integers(len(y), size=len(y))])[0], short, table.names, two, three)[0]
            for _ in range(RESAMPLES)
        ]
        low, high = np.nanquantile(resampled, [0.05, 0.95]) if np.isfinite(resampled).any() else (np.nan, np.nan)
        seeds = [
            _distance(moments[s], short, table.names, two, three)[0]
            for s in range(len(y))
            if np.isfinite(moments[s]).all()
        ]
        ranked.append(
            {
                "contact": contact,
                "law": law,
                "distance": best[0][0],
                "distance_low": low,
                "distance_high": high,
                "distance_one_seed_sd": float(np.std(seeds, ddof=1)) if len(seeds) > 1 else np.nan,
                "distance_table2": best[0][1],
                "distance_table3": best[0][2],
                "labels": ("as printed", "exchanged")[best[1]],
                "seeds": len(y),
                "missing": int(np.isnan(y).any(axis=2).sum()),
                "unconverged": sum(row["converged"] != "True" for row in chosen),
                "d_c_centre_nm": float(np.nanmean(y[:, 0, 0])),
                **{f"mean_{name}": average[0, k] for k, name in enumerate(short)},
                **{f"dev_{name}": average[1, k] for k, name in enumerate(short)},
                **{f"mean_seed_sd_{name}": scatter[0, k] for k, name in enumerate(short)},
                **{f"dev_seed_sd_{name}": scatter[1, k] for k, name in enumerate(short)},
                **{
                    f"mu_star_rms_{name}": average[2 + inputs - 1, k]
                    for k, name in enumerate(short)
                    if table.names[-1] == "rms" and name in ("d_c", "rho_r")
                },
            }
        )
    return sorted(ranked, key=lambda row: row["distance"] if np.isfinite(row["distance"]) else np.inf)


def _arrange(rows: Sequence[Mapping[str, str]]) -> Array:
    """Outputs by seed and node, shape (seeds, nodes, len(OUTPUTS))."""
    seeds = sorted({int(row["seed"]) for row in rows})
    y = np.full((len(seeds), max(int(row["node"]) for row in rows) + 1, len(OUTPUTS)), np.nan)
    for row in rows:
        numbers = [float(row[name]) if row.get(name) else np.nan for name in OUTPUTS]
        y[seeds.index(int(row["seed"])), int(row["node"])] = numbers
    return y


def _over_seeds(moments: Array) -> tuple[Array, Array]:
    """Mean and standard deviation over the seeds that have all nodes of an output, shape (2 + n, len(OUTPUTS))."""
    complete = np.asarray(np.isfinite(moments).all(axis=1))
    usable = complete.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        average = np.where(complete[:, None], moments, 0.0).sum(axis=0) / usable
        squares = np.where(complete[:, None], (moments - average) ** 2, 0.0).sum(axis=0)
        return average, np.sqrt(squares / (usable - 1))


def _moments(y: Array, ranges: Array) -> Array:
    """Mean, deviation and mu* of every seed's linear response on uniform inputs, shape (seeds, 2 + n, len(OUTPUTS))."""
    inputs = len(ranges)
    moments = np.empty((len(y), 2 + inputs, y.shape[2]))
    for s in range(len(y)):
        for k in range(y.shape[2]):
            coefficients = level1_response(y[s, :, k], ranges).coefficients
            moments[s, 0, k] = coefficients[0]
            moments[s, 1, k] = np.sqrt((coefficients[1:] ** 2).sum() / 3)
            moments[s, 2:, k] = elementary_effects(y[s, :, k], inputs)
    return moments


def _distance(
    moments: Array,
    short: Sequence[str],
    names: Sequence[str],
    table2: Mapping[str, tuple[float, float]],
    table3: Mapping[str, Mapping[str, float]],
) -> tuple[float, float, float]:
    """Distance to both tables together, to Table 2, to Table 3."""
    second, third = [], []
    for k, name in enumerate(short):
        mean, deviation = table2[name]
        second += [(moments[0, k] - mean) / deviation, np.log(max(moments[1, k], 1e-300) / deviation)]
        third += [
            (moments[2 + i, k] - table3[name][x]) / (np.sqrt(12) * deviation)
            for i, x in enumerate(names)
            if table3[name][x] < MISPRINT * deviation
        ]
    two, three = (float(np.sqrt(np.mean(np.square(values)))) for values in (second, third))
    return float(np.hypot(two, three)), two, three
