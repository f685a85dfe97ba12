"""The table of uncertain inputs in use (Table 1): each row from literature or a stage."""

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from mesoscale.errors import InputError
from mesoscale.inputs.distributions import (
    Distribution,
    InputTable,
    UncertainInput,
    correlation_matrix,
)
from mesoscale.settings import TABLE_1, DistributionRow, InputRow, InputsSettings
from mesoscale.settings.contact import AttractionLaw
from mesoscale.settings.definitions import BY_NAME, RMS_SCATTER
from mesoscale.tables import foreign_columns

NUMBERS = ("a", "b", "low", "high")
"""Of a distribution, in the order of `InputRow.values`; columns of inputs.csv."""


def collect(
    settings: InputsSettings,
    stages: Mapping[str, Mapping[str, Any]],
    files: Mapping[str, str],
    law: AttractionLaw = "offset",
) -> InputTable:
    """The inputs in use.

    Parameters
    ----------
    settings : origin of each row, and the distributions of the literature rows.
    stages : content of the result file of each stage that a row wants: `inputs` (by name:
        distribution, a, b and perhaps low, high, correlation) and `gate` (`passed`, `reasons`).
    files : name of that file, for messages and the table.
    law : `contact.attraction`, by which a stated work and range become A_H and D0.

    Raises
    ------
    InputError : a stage's gate failed and is not accepted, a stage lacks an input, or a range
        crosses a physical bound.
    """
    rows = []
    pairs = dict(settings.pairs)
    for names, rank in joint_samples(settings.rows(law)).items():
        pairs.setdefault(names, rank)
    for name, row in settings.rows(law).items():
        if row.origin == "literature":
            distribution = stated_distribution(name, row)
            source = row.source or "scene"
            where = f"inputs.{name}"
        else:
            source = files[row.origin]
            accepted = row.origin in settings.accepted_gates
            entry = _from_stage(name, row.origin, stages[row.origin], source, accepted)
            where = f"{source}: inputs.{name}"
            distribution = distribution_of(entry, where)
            for other, rank in entry.get("correlation", {}).items():
                partner = settings.rows(law).get(other)
                # a posterior has its own correlations, among its own inputs
                if row.origin == "calibration":
                    if partner is not None and partner.origin == "calibration":
                        pairs.pop((other, name), None)
                        pairs[name, other] = float(rank)
                elif partner is not None and partner.varies == row.varies:
                    pairs.setdefault((name, other), float(rank))
        _check_range(name, distribution, where)
        rows.append(
            UncertainInput(name, BY_NAME[name].unit, distribution, row.origin, source, row.varies)
        )
    names = [row.name for row in rows]
    return InputTable(tuple(rows), correlation_matrix(names, pairs))


def film_table(
    table: InputTable, film: Mapping[str, Any], scatter: Sequence[float] | None
) -> InputTable:
    """The inputs of a pad, which holds all places of a film, from those of a cell anywhere.

    Parameters
    ----------
    film : what topography found of the film as a whole, by name: distributions of its typical
        place, and of the standard deviation of ln RMS between places.
    scatter : range of that deviation; None: topography's, where the RMS height comes from there.

    Raises
    ------
    InputError : a range crosses a physical bound.
    """
    rows = []
    for row in table.rows:
        if row.origin == "topography" and row.name in film:
            where = f"{row.source}: film.{row.name}"
            row = replace(row, distribution=distribution_of(film[row.name], where))
        rows.append(row)
    rms = rows[table.names.index("rms")]
    name = RMS_SCATTER.name
    if scatter is not None:
        stated = Distribution("uniform", a=scatter[0], b=scatter[1])
        rows.append(UncertainInput(name, "1", stated, "literature", "pad.rms_scatter"))
    elif rms.origin == "topography":
        distribution = distribution_of(film[name], f"{rms.source}: film.{name}")
        rows.append(UncertainInput(name, "1", distribution, rms.origin, rms.source))
    for row in rows:
        _check_range(row.name, row.distribution, f"{row.source}: film.{row.name}")
    correlation = np.eye(len(rows))
    correlation[: len(table.rows), : len(table.rows)] = table.correlation
    return InputTable(tuple(rows), correlation)


def check_literature(settings: InputsSettings) -> dict[str, tuple[float, float]]:
    """Check what needs no stage: literature rows, priors among them, and stated correlations.

    Returns
    -------
    Span of each such row over the central share, by name.

    Raises
    ------
    InputError : as `collect` does for these rows.
    """
    rows = settings.priors().rows()
    spans = {}
    for name, row in rows.items():
        if row.origin == "literature":
            spans[name] = _check_range(name, stated_distribution(name, row), f"inputs.{name}")
    correlation_matrix(list(rows), joint_samples(rows) | settings.pairs)
    return spans


def check_resolved(table: InputTable, nyquist_per_nm: float) -> None:
    """Check that a grid resolves the short-wave cut-off.

    Raises
    ------
    InputError : the cut-off goes beyond the largest wave vector of the grid.
    """
    for row in table.rows:
        _, high = row.distribution.span()
        if row.name == "q1" and high > nyquist_per_nm * (1 + 1e-9):
            raise InputError(
                f"{row.source}: q1 reaches {high:.4g} 1/nm, beyond what contact.pixels and"
                f" contact.length_nm resolve ({nyquist_per_nm:.4g} 1/nm); raise contact.pixels, or"
                " set inputs.q1.origin to literature with values"
            )


PAPER_ROWS = {
    "e_star": InputRow(distribution="normal", values=(91, 3.8), source=TABLE_1),
    "h_prime": InputRow(values=(1.95, 14.8), source=TABLE_1),
    "q0": InputRow(values=(0.015, 0.035), source=TABLE_1),
    "hurst": InputRow(values=(0.5, 1.0), source=TABLE_1),
    "rms": InputRow(values=(2, 15), source=TABLE_1),
}
"""The paper's rows of the inputs that stages compute; the settings' defaults hold the others."""


def input_table(topography: Mapping[str, Any] | None = None, **rows: InputRow) -> InputTable:
    """The paper's Table 1 with some rows exchanged.

    Parameters
    ----------
    topography : content of topography/parameters.json: gives q0, hurst, rms and q1.
    rows : distributions by name of the input (`InputsSettings`), for instance
        ``e_star=InputRow(distribution="normal", values=(70, 5))`` in GPa.

    Raises
    ------
    InputError : unknown name, a range that crosses a physical bound, or roughness that the scans do
        not determine.
    """
    paper: dict[str, InputRow | None] = dict(PAPER_ROWS)
    stages = {}
    if rows.get("hardness", "paper") != "paper":
        paper["h_prime"] = None
    if topography is not None:
        paper |= {name: InputRow(origin="topography") for name in ("q0", "hurst", "rms", "q1")}
        stages["topography"] = topography
    settings = InputsSettings(**(paper | rows))
    return collect(settings, stages, {"topography": "measured roughness"})


def stated_distribution(name: str, row: DistributionRow, section: str = "inputs") -> Distribution:
    """The distribution that a row of a section of the scene states.

    Raises
    ------
    InputError : samples that cannot be read.
    """
    if isinstance(row.values, tuple):
        return Distribution(row.distribution, **dict(zip(NUMBERS, row.values, strict=False)))
    return Distribution(
        "samples", values=np.sort(_read_samples(name, row.values or "", f"{section}.{name}"))
    )


def joint_samples(rows: Mapping[str, InputRow]) -> dict[tuple[str, str], float]:
    """Rank correlations of inputs whose samples stand in one file, a joint sample a row.

    Raises
    ------
    InputError : a file has samples of an input in use that takes its own from elsewhere, or joint
        samples of one that is common to all devices and one that varies with each.
    """
    files: dict[str, list[str]] = {}
    for name, row in rows.items():
        if isinstance(row.values, str):
            files.setdefault(os.path.realpath(row.values), []).append(name)  # ./g.csv is g.csv
    pairs = {}
    for file, names in files.items():
        key = f"inputs.{names[0]}.values = {rows[names[0]].values}"
        if partners := sorted((set(foreign_columns(file, key)) & set(rows)) - set(names)):
            raise InputError(
                f"{key}: holds samples of {partners[0]} beside; give inputs.{partners[0]} the same"
                " file"
            )
        if len(names) < 2:
            continue
        if len({rows[name].varies for name in names}) > 1:
            raise InputError(
                f"{key}: joint samples of {', '.join(names)}, of which some are common to all"
                " devices and others vary with each (varies); give these a file of their own"
            )
        from scipy.stats import spearmanr  # slow to import

        columns = {name: _read_samples(name, file, f"inputs.{name}") for name in names}
        for first, second in combinations(names, 2):
            if np.ptp(columns[first]) and np.ptp(columns[second]):
                rank: Any = spearmanr(columns[first], columns[second])
                pairs[first, second] = float(rank.statistic)
    return pairs


def distribution_of(entry: Mapping[str, Any], where: str) -> Distribution:
    """The distribution of an input as the result file `where` of a stage has it.

    Raises
    ------
    InputError : it is none.
    """
    if entry.get("distribution") == "samples":  # of the calibration
        return Distribution("samples", values=np.sort(np.asarray(entry["values"], float)))
    stated = [key for key in NUMBERS if entry.get(key) is not None]
    numbers: dict[str, Any] = {key: float(entry[key]) for key in stated}
    kinds = ("uniform", "log_uniform", "normal", "truncated_normal", "fixed")
    if entry.get("distribution") not in kinds or "a" not in numbers:
        raise InputError(
            f"{where}: distribution {entry.get('distribution')} with {numbers} is not usable;"
            " accepted: uniform, log_uniform, normal (a, b), truncated_normal (a, b, low, high),"
            " fixed (a)"
        )
    return Distribution(str(entry["distribution"]), **numbers)


def _from_stage(
    name: str, origin: str, content: Mapping[str, Any], source: str, accepted: bool
) -> Mapping[str, Any]:
    gate = content.get("gate", {})
    if not (gate.get("passed", False) or accepted):
        reasons = "; ".join(gate.get("reasons", [])) or "no reason given"
        raise InputError(
            f"{source}: its gate failed ({reasons}), so {name} cannot be taken from {origin}; "
            f"improve that stage's settings or set inputs.{name}.origin to literature with values"
        )
    entry = content.get("inputs", {}).get(name)
    if entry is None:
        raise InputError(
            f"{source}: holds no inputs.{name}; set inputs.{name}.origin to literature with values"
        )
    return entry


def _read_samples(name: str, file: str, key: str) -> np.ndarray:
    columns = foreign_columns(file, f"{key}.values = {file}")
    try:
        values = np.array([float(value) for value in columns[name]])  # type: ignore[arg-type]  # None: refused below
    except (KeyError, TypeError, ValueError):
        raise InputError(
            f"{key}.values = {file}: needs a column {name} with one number a row"
        ) from None
    if values.size < 2 or not np.isfinite(values).all():
        raise InputError(
            f"{key}.values = {file}: {values.size} samples; at least 2, all finite, are needed"
        )
    return values


def _check_range(name: str, distribution: Distribution, where: str) -> tuple[float, float]:
    low, high = distribution.span()
    row = BY_NAME[name]
    if not (row.accepts(low) and row.accepts(high) and low <= high):
        raise InputError(
            f"{where}: spans {low:g} .. {high:g} {row.unit}; accepted is "
            f"{row.accepted}: narrow or truncate its distribution"
        )
    return low, high


def to_rows(table: InputTable) -> list[dict[str, Any]]:
    """The table as rows of inputs.csv."""
    rows = []
    for k, row in enumerate(table.rows):
        distribution = row.distribution
        partners = {}
        for j in range(k):
            if table.correlation[k, j]:
                partners[table.names[j]] = table.correlation[k, j]
        numbers = {key: getattr(distribution, key) for key in NUMBERS}
        # samples travel inside the table, so that inputs.csv alone defines the inputs in use
        kind = distribution.kind
        if kind == "samples":
            kind = "samples " + json.dumps(distribution.values.tolist())
        rows.append(
            {
                "parameter": row.name,
                "unit": row.unit,
                "distribution": kind,
                **{key: value for key, value in numbers.items() if np.isfinite(value)},
                "correlation": json.dumps(partners) if partners else "",
                "origin": row.origin,
                "varies": row.varies,
                "file": row.source,
            }
        )
    return rows


def from_rows(rows: Iterable[Mapping[str, str]]) -> InputTable:
    """The table from the rows of inputs.csv."""
    inputs = []
    pairs = {}
    for row in rows:
        kind, _, samples = row["distribution"].partition(" ")
        numbers: dict[str, Any] = {key: float(row[key]) for key in NUMBERS if row.get(key)}
        values = np.array(json.loads(samples)) if samples else np.empty(0)
        distribution = Distribution(kind, **numbers, values=values)
        name = row["parameter"]
        inputs.append(
            UncertainInput(
                name, row["unit"], distribution, row["origin"], row["file"], row["varies"]
            )
        )
        for other, rank in json.loads(row.get("correlation") or "{}").items():
            pairs[row["parameter"], other] = rank
    return InputTable(tuple(inputs), correlation_matrix([row.name for row in inputs], pairs))


def medians(rows: Iterable[Mapping[str, str]]) -> dict[str, float]:
    """Central inputs by name (means of symmetric distributions) from the rows of inputs.csv."""
    return from_rows(rows).medians()
