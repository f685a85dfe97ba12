"""Words of the command line for a material and a device: numbers with units, choices, bodies."""

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any, get_args

from asperity.film import MATERIAL
from asperity.guards.bundle import ROOT
from asperity.guards.foreign_text import did_you_mean
from asperity.guards.foreign_yaml import load_mapping
from asperity.guards.settings import Settings, key
from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings, InputRow
from mesoscale.settings.contact import MaterialSettings, base_modulus
from mesoscale.settings.definitions import BY_NAME, definition
from mesoscale.settings.device import MEASURABLE, unit_of

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"
KINDS = {None: "fixed", ":": "uniform", "+-": "normal"}
SUBSTRATE_PPM_C = 2.6
"""Thermal expansion of silicon, on which the beam is taken to be anchored."""
SCALAR_KEYS = tuple(
    name
    for name, field in DeviceSettings.model_fields.items()
    if not any(
        isinstance(kind, type) and issubclass(kind, Settings)
        for kind in (field.annotation, *get_args(field.annotation))
    )
)
"""Keys of the device that a word can state; departures are rows of a scene."""
OTHER_WORDS = {
    "E": "youngs_modulus_GPa",
    "modulus": "youngs_modulus_GPa",
    "nu": "poisson_ratio",
    "height": "gap_um",
    "span": "length_um",
    "insulator": "dielectric_nm",
    "eps": "permittivity",
    "epsilon": "permittivity",
    "stiffness": "spring_N_per_m",
    "voltage": "hold_voltage_V",
    "sigma": "residual_stress_MPa",
    "T": "temperature_C",
    "metal": "material",
}
"""Words that engineers use for keys of the device, and that resemble none of them."""
OTHER_WORDS_OF_INPUTS = {
    "hardness": "h_macro",
    "H": "h_macro",
    "E": "e_star",
    "modulus": "e_star",
    "roughness": "rms",
    "D0": "gap_cutoff",
    "RH": "humidity",
}
"""The same for inputs of the contact."""


class Body(Settings):
    """A material of config/bodies.yaml."""

    names: tuple[str, ...] = key(..., "other words for it")
    young_GPa: float = key(..., "Young's modulus", "[0.001, 2000] GPa")
    poisson: float = key(..., "Poisson's ratio", "[0, 0.5)")
    density_g_cm3: float = key(..., "density", "[0.01, 30] g/cm^3")
    expansion_ppm_C: float = key(..., "thermal expansion", "[-1000, 1000] 1e-6/C")
    beams_are_plated: bool = key(False, "whether its beams have the modulus of plated nickel")
    source: str = key(..., "where the numbers are from")

    @property
    def of_a_beam(self) -> dict[str, float]:
        """Keys of a device whose beam is of it; the modulus of plated nickel is the device's own
        default, with its scatter.
        """
        keys = {
            "poisson_ratio": self.poisson,
            "density_g_cm3": self.density_g_cm3,
            "excess_expansion_ppm_C": round(self.expansion_ppm_C - SUBSTRATE_PPM_C, 6),
        }
        if not self.beams_are_plated:
            keys["youngs_modulus_GPa"] = self.young_GPa
        return keys


@cache
def bodies() -> dict[str, Body]:
    """The materials by their names, other words for them included."""
    listed = load_mapping(ROOT / "config" / "bodies.yaml", "list of materials")
    known = {name: Body(**content) for name, content in listed.items()}
    also = {other: body for body in known.values() for other in body.names}
    return known | also


def body_of(word: str, name: str) -> Body:
    """The material that part of a word names.

    Raises
    ------
    InputError : nobody named it.
    """
    by_lower_case = {other.lower(): body for other, body in bodies().items()}
    if name.lower() not in by_lower_case:
        meant = did_you_mean(name.lower(), by_lower_case)
        raise InputError(
            f"{word}: no material {name!r} is known; known are {', '.join(bodies())}{meant}"
        )
    return by_lower_case[name.lower()]


def with_u_for_micro(text: str) -> str:
    """Text with a u in place of the micro sign and of the Greek letter."""
    return re.sub("[\u00b5\u03bc]", "u", text)


def number_of(word: str, text: str, unit: str) -> float:
    """A number, with or without its unit; a share may be in per cent.

    Raises
    ------
    InputError : a decimal comma, another unit, or no number.
    """
    name = word.partition("=")[0]
    plain = with_u_for_micro(text)
    if re.fullmatch(NUMBER, plain):
        return float(plain)
    if re.fullmatch(NUMBER.replace(r"\.", ","), plain) and "," in plain:
        raise InputError(f"{word}: a decimal comma; write {name}={plain.replace(',', '.')}")
    with_unit = re.fullmatch(rf"({NUMBER}) ?([^\W\d_].*|%)", plain)
    if with_unit is None:
        raise InputError(f"{word}: {text!r} is no number; write for instance {name}=2.5")
    number, stated = with_unit.groups()
    if stated == unit:
        return float(number)
    if stated == "%" and unit == "1":
        return float(number) / 100.0
    counted = "has no unit" if unit == "1" else f"is in {unit}"
    raise InputError(f"{word}: {name} {counted}, not in {stated}; write the number alone")


def material_of(words: Sequence[str]) -> dict[str, InputRow]:
    """Rows of inputs from words such as e_star=75, h_macro=1:1.6 (range), e_star=75+-4 (deviation)
    and e_star=gold/silicon_nitride (two bodies).

    Raises
    ------
    InputError : none of these forms, an unknown input or body.
    """
    rows: dict[str, InputRow] = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals:
            raise InputError(f"{word}: accepted is NAME=VALUE, such as e_star=75")
        if name in SCALAR_KEYS or name == "material":
            raise InputError(f"{word}: the device's, not the contact's; write --device {word}")
        if name in OTHER_WORDS_OF_INPUTS:
            raise InputError(
                f"{word}: {name} is no input; did you mean {OTHER_WORDS_OF_INPUTS[name]}?"
            )
        unit = definition(name).unit
        if name in rows:
            raise InputError(f"{word}: {name} is given twice; leave one of them out")
        if name == "e_star" and re.match("[A-Za-z]", value):
            rows[name] = _modulus_of_bodies(word, value)
            continue
        first, sign, second = re.fullmatch(r"(.*?)(?:(:|\+-)(.*))?", value).groups()  # pyright: ignore[reportOptionalMemberAccess]
        if not first or second == "" or re.search(r":|\+-", second or ""):
            raise InputError(
                f"{word}: accepted are {name}=75, {name}=70:80 (from, to) and {name}=75+-4"
                " (deviation)"
            )
        values = tuple(number_of(word, text, unit) for text in (first, second) if text is not None)
        _check_accepted(word, values[:1] if sign == "+-" else values)
        _check_order(word, sign, values)
        stated: Any = {"distribution": KINDS[sign], "values": values, "source": "command line"}
        rows[name] = InputRow(**stated)
    return rows


def _check_accepted(word: str, values: Sequence[float]) -> None:
    """See that an input may have these values, before a scene is written.

    Raises
    ------
    InputError
    """
    about = definition(word.partition("=")[0])
    for value in values:
        if not about.accepts(value):
            unit = "" if about.unit == "1" else f" {about.unit}"
            meant = ""
            if about.unit == "1" and about.accepts(value / 100.0) and not word.endswith("%"):
                meant = f"; per cent are written {word}%"
            raise InputError(
                f"{word}: is {value:g}{unit}; accepted is {about.accepted}{unit}{meant}"
            )


def _check_order(word: str, sign: str | None, values: Sequence[float]) -> None:
    """See that a range rises, and that a deviation is none below 0.

    Raises
    ------
    InputError
    """
    name = word.partition("=")[0]
    if sign == ":" and values[0] > values[1]:
        raise InputError(
            f"{word}: its first number is the larger; write {name}={values[1]:g}:{values[0]:g}"
        )
    if sign == "+-" and values[1] < 0.0:
        raise InputError(f"{word}: a deviation of {values[1]:g}; accepted is 0 or more")


def _modulus_of_bodies(word: str, names: str) -> InputRow:
    """E* of two bodies by their names."""
    pair = names.split("/")
    if len(pair) != 2:
        raise InputError(f"{word}: accepted is a number, or two materials: e_star=gold/silica")
    both = [body_of(word, name) for name in pair]
    bases = [(MaterialSettings(young_GPa=body.young_GPa, poisson=body.poisson),) for body in both]
    stated: Any = {"distribution": "fixed", "values": (round(base_modulus(bases), 3),)}
    sources = "; ".join(dict.fromkeys(body.source for body in both))
    return InputRow(**stated, source=f"{pair[0]} on {pair[1]}: {sources}")


def device_of(words: Sequence[str]) -> dict[str, Any]:
    """Keys of the section `device` from words such as gap_um=2, ends=cantilever,
    electrode=0.2:0.8 and material=aluminium; measured is pull_in_V=72+-2.

    Raises
    ------
    InputError : an unknown key or material, or a value of another shape.
    """
    keys: dict[str, Any] = {}
    of_material: dict[str, float] = {}
    measured: dict[str, tuple[float, float]] = {}
    for word in words:
        name, _, value = word.partition("=")
        if name == "material" and not of_material:
            of_material = body_of(word, value).of_a_beam
            continue
        if name in keys or name == "material":
            raise InputError(f"{word}: {name} is given twice; leave one of them out")
        if name in measured:
            raise InputError(f"{word}: {name} is given twice; leave one of them out")
        if name in MEASURABLE:
            measured[name] = _value_and_error(word, name, value)
            continue
        if name not in SCALAR_KEYS:
            known = "material", *SCALAR_KEYS, *MEASURABLE
            if name in BY_NAME:
                whose = {"humidity": "air"}.get(name, "contact")
                raise InputError(
                    f"{word}: the {whose}'s, not the device's; write --material {word}"
                )
            meant = did_you_mean(name, known)
            if name in OTHER_WORDS:
                meant = f"; did you mean {OTHER_WORDS[name]}?"
            if meant:
                raise InputError(f"{word}: {name} is no key of the device{meant}")
            raise InputError(f"{word}: accepted is KEY=VALUE, with a key of {', '.join(known)}")
        keys[name] = _device_value(word, name, value)
    stated = of_material | keys
    if measured:
        stated["measured"] = measured
    try:
        DeviceSettings(**stated)
    except InputError as error:
        raise InputError(str(error).replace("DeviceSettings:", "device:")) from None
    return stated


def beam_of(words: Sequence[str]) -> str:
    """The material that the words of a device name, as they write it; empty where they do not."""
    stated = (word.partition("=") for word in words)
    return next((value for name, _, value in stated if name == "material"), "")


def beam_is_plated(words: Sequence[str]) -> bool:
    """Whether words name a material whose beams are plated, and no modulus."""
    name = beam_of(words)
    stated = any(word.startswith("youngs_modulus_GPa=") for word in words)
    return bool(name) and not stated and body_of(f"material={name}", name).beams_are_plated


def _value_and_error(word: str, name: str, text: str) -> tuple[float, float]:
    """A measured value and its standard error."""
    value, sign, error = text.replace("±", "+-").partition("+-")
    if not sign:
        raise InputError(f"{word}: measured; accepted are value and standard error, {name}=72+-2")
    unit = name.rpartition("_")[2]
    return number_of(word, value, unit), number_of(word, error, unit)


def _device_value(word: str, name: str, value: str) -> Any:
    """A value in the shape that the key of the device has."""
    kind = DeviceSettings.model_fields[name].annotation
    choices = [choice for choice in _choices(kind) if isinstance(choice, str)]
    or_number = float in _choices(kind) and re.fullmatch(NUMBER, value)
    if choices and not or_number:
        if value not in choices:
            meant = did_you_mean(value, choices)
            if float in _choices(kind):
                choices.append(f"a number such as {name}=0.5")
            raise InputError(f"{word}: accepted are {', '.join(choices)}{meant}")
        return value
    if name in ("electrode", "contact"):
        start, _, end = value.partition(":")
        if not start or not end or ":" in end:
            raise InputError(f"{word}: accepted are two shares of the length: {name}=0.2:0.8")
        return (number_of(word, start, "1"), number_of(word, end, "1"))
    if range_of := re.fullmatch(rf"({NUMBER})(:|\+-)({NUMBER})", value):
        raise InputError(
            f"{word}: accepted is one number, such as {name}={range_of[1]}; departures from it"
            " stand in a scene (device.spread)"
        )
    return number_of(word, value, unit_of(name))


def _choices(kind: Any) -> Iterator[Any]:
    """The words that a literal type accepts, also where None is accepted besides."""
    for member in get_args(kind):
        yield from _choices(member) if get_args(member) else (member,)


def assumed_lines(
    material: Mapping[str, Any], device: Mapping[str, Any], beam: str = ""
) -> Iterator[str]:
    """What nobody stated, a line each for material and device, with values and sources.

    Parameters
    ----------
    beam : the material that the device is said to be of; its contact has a second body.
    """
    missing = {name: row for name, row in MATERIAL.items() if name not in material}
    if missing:
        words = []
        for name, row in missing.items():
            between = " +- " if row.distribution == "normal" else " to "
            values = between.join(f"{value:g}" for value in row.values or ())
            words.append(f"{name} {values} ({row.source})")
        yield f"not stated, taken (--material): {'; '.join(words)}"
    if beam and "e_star" not in material:
        yield (
            f"{beam} is the beam's alone: the contact keeps e_star and hardness above; both bodies"
            f" give e_star, as in --material e_star={beam}/silicon_nitride"
        )
    defaults = DeviceSettings()
    names = ("length_um", "width_um", "thickness_um", "gap_um", "youngs_modulus_GPa")
    untold = [f"{name} {getattr(defaults, name):g}" for name in names if name not in device]
    if untold:
        yield f"not stated, taken (--device), of a published nickel beam: {', '.join(untold)}"
