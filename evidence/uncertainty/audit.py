"""Which reading of the paper comes nearest to its Tables 2 and 3?

A reading is one choice for every ambiguity of the contact model (`CHOICES`) and of the law's fit (`LAW_READINGS`). Each
is computed at the 15 nodes of the paper's design on many surfaces. The distance of Table 2 is the root mean square
over outputs of (mean - paper's mean)/paper's deviation and ln(deviation/paper's); that of Table 3 is that of
(mu* - paper's)/(sqrt(12) paper's deviation) over outputs and inputs. Both use means over surfaces; of the labelings of
the doubtful columns the nearer one counts. Intervals (5 to 95 %) come from resampling the surfaces.

Hertz's area with the mean curvature is left out: the mean curvature of a flattened asperity says nothing about its
area, no asperity ever stops yielding and cycles do not converge. R = A/(2 pi delta) takes several times as long.

Rows `free_fit`, with d_c fitted to both forces together, are of a version that could: none is nearer than rank 20.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evidence.record import ROOT
from mesoscale.contact import Cycle
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import input_table
from mesoscale.law.branches import fit_cycle
from mesoscale.law.fit import fit_branch, separation_at_share
from mesoscale.law.parameters import LAW_OUTPUTS, OUTPUTS
from mesoscale.settings import ContactSettings
from mesoscale.tables import load_table
from mesoscale.uncertainty.collocation import elementary_effects, level1_response
from mesoscale.uncertainty.designs import collocation_runs
from mesoscale.uncertainty.paper_tables import table2, table3
from mesoscale.uncertainty.runs import compute_all

Array = NDArray[np.float64]

CHOICES: dict[str, tuple[str, ...]] = {
    "convention": ("profile", "areal"),
    "flow_pair": ("paper", "wide"),
    "prefactor": ("paper", "hertz"),
    "radius": ("curvature", "truncation"),
    "area": ("sites", "hertz"),
    "touching_attracts": ("true", "false"),
}
"""Ambiguities of the contact model, as keys of `contact.reading` with the values tried."""
COUPLED = "coupled"
"""Ends the name of a reading with all asperities on one half-space."""
LAW_READINGS = {"first_contact": 0.0, "force_0.01": 0.01, "force_0.03": 0.03, "force_0.1": 0.1}
"""Where d_c is: at first (last) contact, or where the repulsion reaches this share of its maximum."""
MISPRINT = 20.0
"""mu* of one input is at most sqrt(12) = 3.5 deviations of the linear response; an entry of Table 3 beyond
that many (delta_C_a, q0: 335.9) contradicts Table 2 under every labeling and is left out."""
RESAMPLES = 200


def arguments(parser: argparse.ArgumentParser) -> None:
    """Readings and surfaces."""
    parser.add_argument("--readings", nargs="*", default=contact_readings(), help="names (default: all)")
    parser.add_argument("--seeds", type=int, default=20, help="surfaces of each reading")
    parser.add_argument("--pixels", type=int, default=1024)


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Readings by their distance to the paper's tables, nearest first."""
    paper = ROOT / "config" / "paper"
    two, three = (load_table(paper / f"table{number}.csv") for number in (2, 3))
    jobs = list(product(given.readings, range(given.seeds), [given.pixels]))
    with ProcessPoolExecutor() as pool:
        outputs = list(pool.map(outputs_of, *zip(*jobs, strict=True)))
    by_reading = {
        (name, law): np.array([y[law] for (reading, *_), y in zip(jobs, outputs, strict=True) if reading == name])
        for name, law in product(given.readings, LAW_READINGS)
    }
    tables2 = [table2(two), table2(two, exchanged=True)]
    tables3 = [table3(three), table3(three, exchange_changes=True)]
    for row in rank(by_reading, input_table(), tables2, tables3):
        yield {**row, "pixels": given.pixels}


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Distances of the nearest reading, of the same with coupled asperities, and of the furthest."""
    rows = [row for row in rows if np.isfinite(float(row["distance"]))]
    single = [row for row in rows if not row["contact"].endswith(COUPLED) and row["pixels"] == "1024"]
    coupled = [row for row in rows if row["contact"].endswith(COUPLED)]
    ordered = sorted(single, key=lambda row: float(row["distance"]))

    def shown(row: Mapping[str, str]) -> str:
        low, high = (float(row[f"distance_{end}"]) for end in ("low", "high"))
        return f"{float(row['distance']):.2f} [{low:.2f}, {high:.2f}]"

    nearest_coupled = min(coupled, key=lambda row: float(row["distance"]))
    shown_rows = {"nearest": ordered[0], "furthest": ordered[-1], "coupled": nearest_coupled}
    return {"readings": str(len(single))} | {name: shown(row) for name, row in shown_rows.items()}


def contact_readings() -> list[str]:
    """Names of all readings of the contact model that can be computed, values joined by dots."""
    named = (".".join(values) for values in product(*CHOICES.values()))
    return [name for name in named if ".curvature.hertz." not in name]


def with_reading(name: str, settings: ContactSettings) -> ContactSettings:
    """Contact settings with the choices of a reading's name put in."""
    values = name.split(".")
    if values[-1] == COUPLED:
        settings, values = settings.model_copy(update={"mechanics": COUPLED}), values[:-1]
    chosen: dict[str, Any] = dict(zip(CHOICES, values, strict=True))
    chosen["touching_attracts"] = chosen["touching_attracts"] == "true"
    return settings.model_copy(update={"reading": settings.reading.model_copy(update=chosen)})


def outputs_of(reading: str, seed: int, pixels: int) -> dict[str, Array]:
    """Outputs at the nodes of one surface by each reading of the law, shape (15, len(OUTPUTS)); NaN where missing."""
    table = input_table()
    nodes = 2 * len(table.rows) + 1
    runs = collocation_runs(table, seed * nodes, (seed + 1) * nodes)
    found = {name: np.full((nodes, len(OUTPUTS)), np.nan) for name in LAW_READINGS}
    for run, cycle in compute_all(
        runs, with_reading(reading, ContactSettings(mechanics="asperity", pixels=pixels, attraction="clamped"))
    ):
        for name, share in LAW_READINGS.items():
            if not isinstance(cycle, str):
                found[name][run.node] = _outputs(cycle, share)
    return found


def _outputs(cycle: Cycle, share: float) -> Array:
    """The outputs with d_c by a share of the largest repulsion; 0: by contact."""
    if share == 0.0:
        return fit_cycle(cycle).outputs
    fits = []
    for branch in (cycle.closing, cycle.opening):
        d_c = separation_at_share(branch.separation_nm, branch.repulsive_nN, share)
        forces = branch.repulsive_nN, branch.attractive_nN
        fits.append(fit_branch(branch.separation_nm, *forces, cycle.cell_area_nm2, cycle.inputs.hamaker, d_c))
    return np.concatenate([fits[0].parameters, fits[1].parameters - fits[0].parameters])


def rank(
    by_reading: Mapping[tuple[str, str], Array],
    table: InputTable,
    tables2: Sequence[Mapping[str, tuple[float, float]]],
    tables3: Sequence[Mapping[str, Mapping[str, float]]],
) -> list[dict[str, Any]]:
    """Readings by their distance, nearest first.

    Parameters
    ----------
    by_reading : outputs by reading of contact and law, shape (seeds, nodes, len(OUTPUTS)).
    tables2, tables3 : the paper's tables under each labeling (same order).
    """
    ranges, rng, ranked = table.ranges(), np.random.default_rng(0), []
    for (contact, law), y in by_reading.items():
        moments = _moments(y, ranges)
        average = _over_seeds(moments)
        best = min(
            (_distance(average, table.names, two, three), label)
            for label, (two, three) in enumerate(zip(tables2, tables3, strict=True))
        )
        two, three = tables2[best[1]], tables3[best[1]]
        resampled = [
            _distance(_over_seeds(moments[rng.integers(len(y), size=len(y))]), table.names, two, three)[0]
            for _ in range(RESAMPLES)
        ]
        low, high = np.nanquantile(resampled, [0.05, 0.95]) if np.isfinite(resampled).any() else (np.nan, np.nan)
        ranked.append(
            {
                "contact": contact,
                "law": law,
                "distance": best[0][0],
                "distance_low": low,
                "distance_high": high,
                "distance_table2": best[0][1],
                "distance_table3": best[0][2],
                "labels": ("as printed", "exchanged")[best[1]],
                "seeds": len(y),
                "missing": int(np.isnan(y).any(axis=2).sum()),
                **{f"mean_{output.short}": average[0, k] for k, output in enumerate(LAW_OUTPUTS)},
                **{f"dev_{output.short}": average[1, k] for k, output in enumerate(LAW_OUTPUTS)},
            }
        )
    return sorted(ranked, key=lambda row: row["distance"] if np.isfinite(row["distance"]) else np.inf)


def _over_seeds(moments: Array) -> Array:
    """Mean over the seeds that have all nodes of an output, shape (2 + n, len(OUTPUTS))."""
    complete = np.asarray(np.isfinite(moments).all(axis=1))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(complete[:, None], moments, 0.0).sum(axis=0) / complete.sum(axis=0)


def _moments(y: Array, ranges: Array) -> Array:
    """Mean, deviation and mu* of every seed's linear response on uniform inputs, shape (seeds, 2 + n, len(OUTPUTS))."""
    inputs = len(ranges)
    moments = np.empty((len(y), 2 + inputs, y.shape[2]))
    for s in range(len(y)):
        for k in range(y.shape[2]):
            coefficients = level1_response(y[s, :, k], ranges).coefficients
            moments[s, 0, k] = coefficients[0]
            moments[s, 1, k] = np.sqrt((coefficients[1:] ** 2).sum() / 3)
            moments[s, 2:, k] = elementary_effects(y[s, :, k])
    return moments


def _distance(
    moments: Array,
    names: Sequence[str],
    two: Mapping[str, tuple[float, float]],
    three: Mapping[str, Mapping[str, float]],
) -> tuple[float, float, float]:
    """Distance to both tables together, to Table 2, to Table 3."""
    second, third = [], []
    for k, output in enumerate(LAW_OUTPUTS):
        mean, deviation = two[output.short]
        second += [(moments[0, k] - mean) / deviation, np.log(max(moments[1, k], 1e-300) / deviation)]
        third += [
            (moments[2 + i, k] - three[output.short][x]) / (np.sqrt(12) * deviation)
            for i, x in enumerate(names)
            if three[output.short][x] < MISPRINT * deviation
        ]
    at_two, at_three = (float(np.sqrt(np.mean(np.square(values)))) for values in (second, third))
    return float(np.hypot(at_two, at_three)), at_two, at_three
