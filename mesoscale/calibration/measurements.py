"""Tables of measurements: the CSV files, their units, and what is refused."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.observables import CURVES
from mesoscale.errors import InputError
from mesoscale.settings.measurements import MeasurementTable
from mesoscale.tables import foreign_table

Array = NDArray[np.float64]

UNITS = {
    "length": {"nm": 1.0, "um": 1e3, "pm": 1e-3, "A": 0.1},
    "force": {"nN": 1.0, "uN": 1e3, "mN": 1e6, "pN": 1e-3},
    "area": {"nm2": 1.0, "um2": 1e6},
    "pressure": {"GPa": 1.0, "MPa": 1e-3},
    "voltage": {"V": 1.0, "mV": 1e-3},
    "count": {"": 1.0},
    "time": {"s": 1.0, "min": 60.0, "h": 3600.0, "days": 86400.0},
    "temperature": {"C": 1.0},
    "humidity": {"percent": 0.01},
}
"""Units by quantity with their factor to the first one."""
CURVE = {
    "separation": "length",
    "force": "force",
    "separation_error": "length",
    "force_error": "force",
}
COLUMNS: dict[str, dict[str, str]] = {
    "closing_curves": CURVE,
    "opening_curves": CURVE,
    "contact_begin": {"contact_begin": "length", "contact_begin_error": "length"},
    "pull_off": {"pull_off": "force", "pull_off_error": "force"},
    "hardness": {"hardness": "pressure", "hardness_error": "pressure", "area": "area"},
    "modulus": {"e_star": "pressure", "e_star_error": "pressure"},
    "release": {"release": "voltage", "release_error": "voltage"},
    "pull_in": {"pull_in": "voltage", "pull_in_error": "voltage"},
    "sticking": {"stuck": "count", "switches": "count"},
    "drift": {
        "hold": "voltage",
        "time": "time",
        "shift": "voltage",
        "shift_error": "voltage",
        "rest": "time",
        "temperature": "temperature",
        "humidity": "humidity",
    },
}
"""Quantities of each kind of table with what they measure; the column's name ends with the unit."""
CURVE_ERRORS = ("separation_error", "force_error")
"""One of them is needed."""
OPTIONAL = (*CURVE_ERRORS, "rest", "temperature", "humidity")


@dataclass(frozen=True)
class Measurements:
    """The data of one table, in nm, nN, nm^2, GPa, V, s and degrees Celsius.

    Attributes
    ----------
    kind, columns : by quantity, shape (rows,).
    specimens : specimen of every row; made up where the table names none.
    zero_known : curves: whether separations count from the mean plane.
    discrepancy : See `MeasurementTable.discrepancy`.
    file : as it is named in messages.
    source : where the measurements come from, in words.
    """

    kind: str
    columns: dict[str, Array]
    specimens: tuple[str, ...]
    zero_known: bool
    discrepancy: float
    file: str
    source: str = ""

    def __len__(self) -> int:
        return len(self.specimens)


def load_measurements(table: MeasurementTable, path: str | Path | None = None) -> Measurements:
    """Load one table.

    Parameters
    ----------
    path : where the file lies, if not at `table.file`.

    Raises
    ------
    InputError : the file is missing, a column or its unit is missing or unknown, a value is no
        number, an error is not positive, columns look swapped, or a curve has fewer points than
        unknowns.
    """
    file = table.file
    header, table_rows = foreign_table(path or file, file)
    rows = []
    for row in table_rows:
        values = [value for value in row.values() if not isinstance(value, list)]
        rows.append([(value or "").strip() for value in values])
    if not rows:
        raise InputError(f"{file}: has no rows; give a header and at least one measurement")
    places = _places(file, table.kind, header)
    columns = {}
    for quantity, (place, factor) in places.items():
        name = header[place]
        numbers = [_number(file, line, name, row, place) for line, row in enumerate(rows, 1)]
        columns[quantity] = factor * np.array(numbers)
    if "specimen" in header:
        place = header.index("specimen")
        specimens = tuple(row[place] for row in rows)
    elif table.kind in CURVES:
        raise InputError(
            f"{file}: no column specimen; name the specimen of every point, one curve each"
        )
    else:
        specimens = tuple(f"{table.kind} {line}" for line in range(1, len(rows) + 1))
    zero_known = table.zero == "known"
    loaded = Measurements(
        table.kind, columns, specimens, zero_known, table.discrepancy, file, table.source
    )
    _check(loaded)
    return loaded


def _places(file: str, kind: str, header: Sequence[str]) -> dict[str, tuple[int, float]]:
    """Column and factor of every quantity."""
    places = {}
    for quantity, measure in COLUMNS[kind].items():
        names = {
            f"{quantity}_{unit}".removesuffix("_"): factor
            for unit, factor in UNITS[measure].items()
        }
        matches = [(place, names[name]) for place, name in enumerate(header) if name in names]
        near = [
            name
            for name in header
            if name.startswith(quantity) and not name.startswith(f"{quantity}_error")
        ]
        if len(matches) > 1:
            raise InputError(f"{file}: column {quantity} stands there twice; leave one")
        if matches:
            places[quantity] = matches[0]
        elif near:
            fault = "has no unit" if near[0] == quantity else "has an unknown unit"
            raise InputError(f"{file}: column {near[0]} {fault}; name it {' or '.join(names)}")
        elif quantity not in OPTIONAL:
            raise InputError(
                f"{file}: no column {quantity} with its unit; name it {' or '.join(names)}"
            )
    if kind in CURVES and not any(name in places for name in CURVE_ERRORS):
        raise InputError(f"{file}: no errors; give separation_error_nm or force_error_nN or both")
    return places


def _number(file: str, line: int, name: str, row: Sequence[str], place: int) -> float:
    text = row[place] if place < len(row) else ""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(
            f"{file}: row {line}, column {name} = {text[:40]!r}: accepted is a finite number"
        )
    return value


def _check(data: Measurements) -> None:
    columns = data.columns
    for name in columns:
        if name.endswith("_error"):
            # of a curve, one of the two errors may be zero
            wrong = columns[name] < 0
            if data.kind not in CURVES:
                wrong = columns[name] <= 0
            _refuse(data, wrong, "an error is positive; give one standard deviation", name)
    if data.kind in CURVES:
        nothing = 0 * columns["force"]
        no_error = [columns.get(name, nothing) == 0 for name in CURVE_ERRORS]
        _refuse(data, np.all(no_error, axis=0), "both errors are zero")
        for specimen, points in by_specimen(data).items():
            _check_curve(
                f"{data.file}: curve {specimen}",
                columns["separation"][points],
                columns["force"][points],
            )
    elif data.kind == "sticking":
        stuck = columns["stuck"]
        switches = columns["switches"]
        broken = (stuck % 1 > 0) | (switches % 1 > 0)
        wrong = (switches < 1) | (stuck < 0) | (stuck > switches) | broken
        _refuse(
            data,
            wrong,
            "accepted are whole numbers, stuck at most switches; are the columns swapped?",
            "stuck",
        )
    elif data.kind == "drift":
        _check_drift(data)
    else:
        value = next(iter(COLUMNS[data.kind]))
        stuck = ""
        if data.kind == "release":
            stuck = "; a switch that stuck belongs to a table of kind sticking"
        _refuse(data, columns[value] <= 0, f"accepted is a positive number{stuck}", value)
        if (columns[f"{value}_error"] > columns[value]).all():
            raise InputError(
                f"{data.file}: {value}_error exceeds {value} in every row; are the columns swapped?"
            )


def _check_drift(data: Measurements) -> None:
    holds_V = data.columns["hold"]
    _refuse(data, holds_V <= 0, "a hold is above 0 V; give the shift its sign instead", "hold")
    for name in ("time", "rest"):
        if name in data.columns:
            _refuse(data, data.columns[name] < 0, "a time is not below zero", name)
    if "temperature" in data.columns:
        wrong = data.columns["temperature"] <= -273.15
        _refuse(data, wrong, "accepted is a temperature above -273.15 degrees", "temperature")
    if "humidity" in data.columns:
        humidity = data.columns["humidity"]
        _refuse(data, (humidity < 0) | (humidity > 1), "accepted is 0 to 100 percent", "humidity")
    if np.unique(holds_V).size < 2:
        raise InputError(
            f"{data.file}: all rows are of a hold of {holds_V[0]:g} V; one voltage does not tell"
            " injection from emission: give rows of at least two"
        )


def _refuse(
    data: Measurements, wrong: NDArray[np.bool_], why: str, column: str | None = None
) -> None:
    """Refuse the first row that is wrong, with its value in a column."""
    if np.any(wrong):
        row = int(np.argmax(wrong))
        value = ""
        if column is not None:
            value = f", {column} = {data.columns[column][row]:g}"
        raise InputError(f"{data.file}: row {row + 1}{value}: {why}")


def _check_curve(curve: str, separation: Array, force: Array) -> None:
    if len(separation) < 5:  # its law has four numbers, one more tells whether they fit
        raise InputError(
            f"{curve} has {len(separation)} points; a curve has four unknowns, so at least 5 are"
            " needed"
        )
    if np.ptp(separation) == 0 or np.ptp(force) == 0:
        raise InputError(f"{curve}: separation or force does not change; give a curve")
    if np.corrcoef(separation, force)[0, 1] > 0:
        raise InputError(
            f"{curve}: force rises with separation; count repulsion positive and separation away"
            " from the contact, and look whether columns are swapped"
        )


def by_specimen(data: Measurements) -> Mapping[str, NDArray[np.int_]]:
    """Rows of every specimen, in order of appearance."""
    rows: dict[str, list[int]] = {}
    for row, specimen in enumerate(data.specimens):
        rows.setdefault(specimen, []).append(row)
    return {specimen: np.array(places) for specimen, places in rows.items()}
