"""Units of length as instruments, programs and people write them."""

import re

from mesoscale.errors import InputError

WORDS = {  # spellings that the table of SurfaceTopography lacks, in m
    1e-3: ("millimeter", "millimeters", "millimetre", "millimetres", "mms", "мм", "毫米"),
    1e-6: (
        *(
            "\u03bcm",
            "\u339b",
            "\u00c2\u00b5m",
            "micron",
            "microns",
            "micrometer",
            "micrometers",
            "micrometre",
        ),
        *(
            "micrometres",
            "mikrometer",
            "micromètre",
            "micromètres",
            "micrómetro",
            "micrómetros",
            "micrometri",
        ),
        *("mikron", "mikrometr", "mum", "мкм", "мкм.", "微米", "マイクロメートル"),
    ),
    1e-9: (
        *(
            "\u339a",
            "nanometer",
            "nanometers",
            "nanometre",
            "nanometres",
            "nanomètre",
            "nanomètres",
            "nanómetro",
        ),
        *("nanómetros", "nanometri", "nanometr", "нм", "纳米", "ナノメートル"),
    ),
    1e-10: ("angstrom", "angstroms", "ångström", "ångstrom", "ang", "\u212b"),
    1e-12: ("picometer", "picometers", "picometre", "picometres"),
    1.0: ("meter", "meters", "metre", "metres", "mètre", "mètres"),
}
"""The third of those of 1e-6 is UTF-8 that was read as Latin-1."""
BRACKETS = re.compile(r"[(\[]\s*([^()\[\]]*?)\s*[)\]]")


def teach_units() -> None:
    """Add spellings of lengths to SurfaceTopography's table, by which its readers tell heights."""
    from SurfaceTopography.Support.UnitConversion import length_units

    for metres, names in WORDS.items():
        length_units |= dict.fromkeys((*names, *(name.capitalize() for name in names)), metres)


def nm_of(where: str, unit: str) -> float:
    """Length of a unit in nm.

    Raises
    ------
    InputError : it is no unit of length.
    """
    from SurfaceTopography.Support.UnitConversion import (
        get_unit_conversion_factor,
        mangle_length_unit_utf8,
    )

    try:
        return float(get_unit_conversion_factor(mangle_length_unit_utf8(unit), "nm"))
    except ValueError:
        raise InputError(
            f"{where}: unit {unit!r} is not a length; save heights and size in nm, um or m"
        ) from None


def unit_of_head(head: str) -> str | None:
    """The unit of length that the head of a column names; None where it names none."""
    from SurfaceTopography.Support.UnitConversion import find_length_unit_in_string, length_units

    for text in (*BRACKETS.findall(head), head.replace("_", " ")):
        unit = find_length_unit_in_string(text)
        if unit is None:
            small = (word.lower() for word in re.split(r"[\s()\[\]{},;:=/-]+", text))
            unit = next((word for word in small if len(word) > 2 and word in length_units), None)
        if unit is not None:
            return unit
    return None


def without_unit(head: str) -> str:
    """The head of a column without what stands in brackets."""
    return BRACKETS.sub(" ", head).strip() or head
