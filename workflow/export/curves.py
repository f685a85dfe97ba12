"""Curves of a contact and of a pad as tables that finite-element codes read.

All numbers are in SI units, because these codes state none. The first column of a table rises, as
an interpolation needs it. Pressures push the two bodies apart.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.cycle import Branch
from mesoscale.contact.resistance import stiffness_of
from mesoscale.units import GPA, NM
from workflow.report.available import CsvRow, Results

Array = NDArray[np.float64]
NM2 = 1e-18  # m^2
NN = 1e-9  # N
MPA = 1e6  # Pa


@dataclass(frozen=True)
class ContactTable:
    """Columns over the first of them.

    Attributes
    ----------
    name : of its files and functions.
    meaning : in words.
    columns : by name with unit; the first rises.
    """

    name: str
    meaning: str
    columns: dict[str, Array]


def tables_of(results: Results) -> Iterator[ContactTable]:
    """Tables of all curves that a scene has: of one cell, and of its pad."""
    if results.has("contact/nominal.h5"):
        yield from _cell_tables(results)
    if results.has("pad/curves.csv"):
        yield from _pad_tables(results)


def _cell_tables(results: Results) -> Iterator[ContactTable]:
    groups, attributes, curve_attributes = results.h5("contact/nominal.h5")
    area_m2 = float(attributes["cell_area_nm2"]) * NM2
    for place, group in groups.items():
        curve, branch = place.split("/")
        force_nN = group["repulsive_nN"] + group["attractive_nN"]
        yield _over_gap(
            f"{curve}_{branch}",
            f"net pressure on one cell, {branch}, curve {curve}",
            group["separation_nm"] * NM,
            force_nN * NN / area_m2,
        )
        if branch == "opening":
            way = Branch(**{field.name: group[field.name] for field in fields(Branch)})
            yield from _conductance(curve, way, float(curve_attributes[curve]["e_star"]), area_m2)


def _pad_tables(results: Results) -> Iterator[ContactTable]:
    ways: dict[str, list[CsvRow]] = {}
    for row in results.csv("pad/curves.csv"):
        ways.setdefault(row["depth_nm"], []).append(row)
    for number, (depth_nm, rows) in enumerate(ways.items()):
        name = "pad_closing"
        meaning = "net pressure on the pad, closing"
        if depth_nm:
            name = f"pad_opening_{number}"
            meaning = f"net pressure on the pad, opening from {float(depth_nm):.5g} nm"
        gap_nm = np.array([float(row["separation_nm"]) for row in rows])
        repulsive_MPa = np.array([float(row["repulsive_MPa"]) for row in rows])
        attractive_MPa = np.array([float(row["attractive_MPa"]) for row in rows])
        yield _over_gap(name, meaning, gap_nm * NM, (repulsive_MPa + attractive_MPa) * MPA)


def _over_gap(name: str, meaning: str, gap_m: Array, pressure_Pa: Array) -> ContactTable:
    """Pressure and its slope over a rising gap; of equal gaps the first stays."""
    known = np.isfinite(gap_m) & np.isfinite(pressure_Pa)
    gap_m, first = np.unique(gap_m[known], return_index=True)
    pressure_Pa = pressure_Pa[known][first]
    stiffness = -np.gradient(pressure_Pa, gap_m)
    columns = {
        "gap_m": gap_m,
        "pressure_Pa": pressure_Pa,
        "stiffness_Pa_per_m": stiffness,
    }
    return ContactTable(name, meaning, columns)


def _conductance(
    curve: str, opening: Branch, e_star_GPa: float, area_m2: float
) -> Iterator[ContactTable]:
    """Conductance over the repulsive pressure and over the gap, by the stiffness of the elastic way
    back.

    Times the harmonic mean of the two conductivities it is the conductance of an area: electrical
    in S/m^2, thermal in W/(m^2 K). The equation is that of `mesoscale.contact.resistance`, for
    spots that are wide beside the mean free path.
    """
    way = stiffness_of(opening)
    stiffness = way.slope / area_m2
    pressure_Pa, first = np.unique(way.force_nN * NN / area_m2, return_index=True)
    columns = {
        "pressure_Pa": pressure_Pa,
        "gap_m": -way.approach_nm[first] * NM,
        "stiffness_Pa_per_m": stiffness[first],
        "conductance_per_m": stiffness[first] / (e_star_GPa * GPA),
    }
    meaning = f"conductance over conductivity of one cell, opening, curve {curve}"
    yield ContactTable(f"{curve}_conductance", meaning, columns)
    gap_m, first = np.unique(columns["gap_m"], return_index=True)
    over_gap = {"gap_m": gap_m, "conductance_per_m": columns["conductance_per_m"][first]}
    yield ContactTable(f"{curve}_conductance_of_gap", meaning, over_gap)


def write_comsol(folder: Path, tables: list[ContactTable]) -> None:
    """One text file a table, in COMSOL's spreadsheet format: comments behind %, columns.

    COMSOL Multiphysics Reference Manual, Interpolation: data source File, format Spreadsheet.
    """
    folder.mkdir()
    for table in tables:
        header = f"% {table.meaning}\n% {' '.join(table.columns)}\n"
        _write(folder / f"{table.name}.txt", header + _lines(table, " "))


def write_moose(folder: Path, tables: list[ContactTable]) -> None:
    """One CSV file a table, and functions of MOOSE that read them (`functions.i`).

    A `PiecewiseLinear` of MOOSE takes two columns of a file by their index.
    """
    folder.mkdir()
    blocks = []
    for table in tables:
        _write(folder / f"{table.name}.csv", f"{','.join(table.columns)}\n{_lines(table, ',')}")
        blocks.append(f"  # {table.meaning}\n")
        for number, (argument, column) in enumerate(_functions(table), start=1):
            blocks.append(
                f"  [{_function_name(table, column)}]  # over {argument}\n"
                "    type = PiecewiseLinear\n"
                f"    data_file = {table.name}.csv\n"
                "    format = columns\n"
                "    xy_in_file_only = false\n"
                "    x_index_in_file = 0\n"
                f"    y_index_in_file = {number}\n"
                "  []\n"
            )
    _write(folder / "functions.i", f"[Functions]\n{''.join(blocks)}[]\n")


def write_oofem(file: Path, tables: list[ContactTable]) -> None:
    """All tables as records of `PiecewiseLinFunction`, for the functions of an oofem input.

    oofem takes abscissae within 1e-12 for equal. So gaps are in nm here, not in m.
    """
    lines = []
    number = 0
    for table in tables:
        for argument, column in _functions(table):
            number += 1
            abscissae = table.columns[argument]
            unit = argument
            if argument == "gap_m":
                abscissae = abscissae / NM
                unit = "gap_nm"
            lines.append(f"# {number}: {_function_name(table, column)} over {unit}")
            count = abscissae.size
            lines.append(
                f"PiecewiseLinFunction {number} nPoints {count} t {count} {_numbers(abscissae)}"
                f" f(t) {count} {_numbers(table.columns[column])}"
            )
    _write(file, "\n".join(lines) + "\n")


def _functions(table: ContactTable) -> list[tuple[str, str]]:
    """The argument of a table with each of its other columns."""
    argument, *others = table.columns
    return [(argument, column) for column in others]


def _function_name(table: ContactTable, column: str) -> str:
    return f"{table.name}_{column}"


def _lines(table: ContactTable, separator: str) -> str:
    rows = np.column_stack(list(table.columns.values()))
    return "".join(f"{separator.join(map(repr, row))}\n" for row in rows.tolist())


def _numbers(values: Array) -> str:
    return " ".join(map(repr, values.tolist()))


def _write(file: Path, text: str) -> None:
    file.write_text(text, encoding="utf-8")
