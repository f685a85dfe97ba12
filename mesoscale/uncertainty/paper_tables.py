"""The paper's Tables 2 and 3 in base units, under both readings of the doubtful column labels.

In Table 3 the closing columns "C_a" and "C_r" fit Table 2 only when their labels are exchanged (dev
= sqrt(sum mu*^2 / 12) holds to 1 % for the other outputs); both are then in 1e-5 GPa. For the
changes delta_C_a and delta_C_r neither reading is certain, in Table 2 as in Table 3: both are
given.
"""

from collections.abc import Iterable, Mapping

SCALE_TABLE_2 = {"C_a": 1e-5, "C_r": 1e-4, "delta_C_a": 1e-5, "delta_C_r": 1e-4}
SCALE_TABLE_3 = {"C_a": 1e-5, "C_r": 1e-5, "delta_C_a": 1e-5, "delta_C_r": 1e-4}
"""Units of the columns as printed; Table 3 prints 1e-5 over delta_C_r, but only 1e-4 fits Table 2.
"""
EXCHANGED = {"C_a": "C_r", "C_r": "C_a"}


def table2(
    rows: Iterable[Mapping[str, str]], exchanged: bool = False
) -> dict[str, tuple[float, float]]:
    """Mean and deviation by output of Table 2; `exchanged` swaps delta_C_a and delta_C_r."""
    values = {}
    for row in rows:
        scale = SCALE_TABLE_2.get(row["output"], 1.0)
        values[row["output"]] = (float(row["mean"]) * scale, float(row["dev"]) * scale)
    if exchanged:
        values |= {"delta_C_a": values["delta_C_r"], "delta_C_r": values["delta_C_a"]}
    return values


def table3(
    rows: Iterable[Mapping[str, str]], as_printed: bool = False
) -> dict[str, dict[str, float]]:
    """mu* by output and input of config/paper/table3.csv (its row of units is skipped).

    By default the closing labels C_a and C_r are exchanged, as argued above; `as_printed` keeps
    them.
    """
    values: dict[str, dict[str, float]] = {}
    for row in rows:
        if row["parameter"].startswith("unit"):
            continue
        for column, text in row.items():
            if column == "parameter":
                continue
            output = column if as_printed else EXCHANGED.get(column, column)
            scale = SCALE_TABLE_3.get(column, 1.0)
            values.setdefault(output, {})[row["parameter"]] = float(text) * scale
    return values
