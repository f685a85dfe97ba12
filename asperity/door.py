"""From measured files to a scene: what they show, and a commented scene file that computes a switch
on them.
"""

import glob
import json
import math
import os
import re
from argparse import Namespace
from collections.abc import Callable, Iterator, Mapping, Sequence
from fnmatch import fnmatch
from pathlib import Path
from typing import Any, get_args

from asperity.film import MATERIAL, Film, pixels_for
from asperity.guards.bundle import ROOT
from asperity.guards.foreign_text import did_you_mean
from asperity.words import (
    NUMBER,
    SCALAR_KEYS,
    assumed_lines,
    beam_of,
    device_of,
    material_of,
    number_of,
    with_u_for_micro,
)
from mesoscale.errors import InputError
from mesoscale.inputs.table import PAPER_ROWS
from mesoscale.settings import DeviceSettings, InputRow, InstrumentSettings, TopographySettings
from mesoscale.settings.definitions import definition
from mesoscale.settings.topography import LengthUnit
from mesoscale.topography.measurements import check_count, files_in
from mesoscale.topography.measurements.loading import MIN_SIDE, load_measurements

OF_FILES = ("tip_nm", "channel", "unit", "size", "crop", "points", "detrend")
"""Options of the command line that tell how measured files are."""

KNOWN_IF_STATED = ("youngs_modulus_GPa", "residual_stress_MPa")
"""Keys of the device that count as known where they stand in a scene."""


def described(
    words: Namespace, say: Callable[[str], object]
) -> tuple[Film | None, str, tuple[str, ...]]:
    """What the words of a command line describe.

    Parameters
    ----------
    words : the options of `asperity film`; without `files` the roughness is the paper's.
    say : is told of files that are left out.

    Returns
    -------
    The film, where there are files; the text of its scene; and lines on what nobody stated.

    Raises
    ------
    InputError : a word that is not understood, or a file that cannot be read.
    """
    material = material_of(words.material)
    device = device_of(words.device)
    film = None
    if words.files:
        topography = topography_of(words)
        tip_nm = None
        if words.tip_nm is not None:
            tip_nm = number_of(f"--tip-nm={words.tip_nm}", words.tip_nm, "nm")
            if tip_nm < 0.0:
                raise InputError(f"--tip-nm={words.tip_nm}: accepted is 0 or more, in nm")
        film = Film(readable(words.files, say, topography), tip_nm, **topography)
    else:
        for name in OF_FILES:
            if getattr(words, name):
                raise InputError(f"--{name.replace('_', '-')}: tells of measured files; name some")
    text = "\n".join(scene_lines(film, material, device)) + "\n"
    assumed = list(assumed_lines(material, device, beam_of(words.device)))
    if film is None:
        untold = [
            f"{name} {values[0]:g} to {values[1]:g}"
            for name in ("q0", "hurst", "rms")
            if name not in material and (values := PAPER_ROWS[name].values)
        ]
        if untold:
            assumed.append(f"no maps, so the roughness of the paper ({', '.join(untold)})")
    return film, text, tuple(assumed)


def topography_of(words: Namespace) -> dict[str, Any]:
    """Keys of the section `topography` from the options --channel, --unit, --size, --crop, --points
    and --detrend.

    A unit or size is of all files, or with a name in front (scan.txt=10) of those it fits.

    Raises
    ------
    InputError : no unit of length, no size, or places of points for several files.
    """
    keys = {name: getattr(words, name) for name in ("channel", "detrend") if getattr(words, name)}
    of_all: dict[str, Any] = {}
    if words.points:
        of_all["points"] = _places(words)
    if words.crop:
        of_all["crop"] = _part(words.crop)
    of_file: dict[str, dict[str, Any]] = {}
    for option, understood in (("unit", _units), ("size", _sides)):
        for word in getattr(words, option) or ():
            name, of_one, value = word.rpartition("=")
            stated = understood(f"--{option} {word}", value)
            if of_one:
                pattern = _pattern(f"--{option} {word}", name, words.files)
                of_file.setdefault(pattern, {}).update(stated)
            else:
                of_all |= stated
    named = [
        InstrumentSettings(files=pattern, **of_all | stated) for pattern, stated in of_file.items()
    ]
    others = [InstrumentSettings(files="*", **of_all)] if of_all else []
    if named or others:
        keys["instruments"] = (*named, *others)
    return keys


def _units(option: str, value: str) -> dict[str, Any]:
    """Units of positions and heights."""
    units = with_u_for_micro(value).split(",")
    known = get_args(LengthUnit)
    if len(units) > 2 or not set(units) <= set(known):
        raise InputError(
            f"{option}: accepted are {', '.join(known)}, or two of them such as um,nm; of one"
            " file: --unit scan.txt=um,nm"
        )
    return dict(zip(("unit", "height_unit"), units, strict=False))


def _sides(option: str, value: str) -> dict[str, Any]:
    """Sides of a map, or the length of a line."""
    sides = re.fullmatch(rf"({NUMBER})(?:x({NUMBER}))?", value)
    if sides is None:
        raise InputError(
            f"{option}: accepted is a number or two (10 or 10x5), in --unit or the file's; of one"
            " file: --size scan.txt=10x5"
        )
    lengths = tuple(float(side) for side in sides.groups() if side)
    if not all(0.0 < length < math.inf for length in lengths):
        raise InputError(f"{option}: a side is above 0, in --unit or the file's")
    return {"size": lengths}


def _places(words: Namespace) -> tuple[int, int]:
    """Places along x and y for points on no regular grid."""
    places = re.fullmatch(r"(\d+)x(\d+)", words.points)
    if places is None or min(int(number) for number in places.groups()) < MIN_SIDE:
        raise InputError(
            f"--points {words.points}: accepted are two numbers such as 64x64, places along x"
            f" and y, of {MIN_SIDE} or more"
        )
    _check_alone(words, "--points")
    return int(places[1]), int(places[2])


def _part(crop: str) -> str | tuple[int, ...]:
    """The part of a map to keep."""
    if crop == "largest":
        return crop
    corners = re.fullmatch(r"(\d+):(\d+),(\d+):(\d+)", crop)
    if corners is None:
        raise InputError(
            f"--crop {crop}: accepted is nothing (the largest rectangle without missing"
            " points), or the pixels to keep along x and y, such as 10:500,0:480; give files"
            " before it"
        )
    left, right, low, high = (int(end) for end in corners.groups())
    if left >= right or low >= high:
        raise InputError(f"--crop {crop}: each range rises, such as 10:500,0:480")
    return left, right, low, high


def _pattern(option: str, name: str, files: Sequence[str]) -> str:
    """The pattern of an instrument that fits a file by its name, or all that * stands for.

    Raises
    ------
    InputError : it fits none of the files.
    """
    given = [Path(file).name for folder in files for file in files_in(folder)]
    base = Path(name).name
    if base in given:
        return glob.escape(base)
    if not any(fnmatch(file, name) for file in given):
        raise InputError(f"{option}: no such file is given{did_you_mean(base, given)}")
    return name


def _check_alone(words: Namespace, option: str) -> None:
    if len(words.files) > 1 or os.path.isdir(words.files[0]):
        raise InputError(
            f"{option}: accepted for one file; for several, state topography.instruments in a scene"
        )


def readable(
    names: Sequence[str], say: Callable[[str], object], topography: Mapping[str, Any]
) -> list[str]:
    """Files by name, folders replaced by those of their files that can be read; `say` is told of
    the others.

    Parameters
    ----------
    topography : keys of that section.

    Raises
    ------
    InputError : nothing to read.
    """
    files = []
    for name in names:
        if not os.path.isdir(name):
            files.append(name)
            continue
        inside = files_in(name)
        check_count(name, inside)  # before the first is read
        for file in inside:
            try:
                load_measurements(file, settings=TopographySettings(**topography))
                files.append(file)
            except InputError as error:
                say(f"left out: {error}")
    if not files:
        raise InputError(
            f"{', '.join(names)}: nothing to read; give scans, line profiles or containers of one"
            " surface"
        )
    return files


def scene_lines(
    film: Film | None, material: Mapping[str, InputRow], device: Mapping[str, Any]
) -> Iterator[str]:
    """The text of a scene; without a film its roughness is the paper's, by numbers to replace."""
    yield f"# yaml-language-server: $schema={ROOT / 'config' / 'scene.schema.json'}"
    yield f"# Every key with its default: {ROOT / 'config' / 'config.yaml'}"
    yield "tails: [switch]  # the switch on a pad; law: the law of one cell as in the paper, too"
    if film is not None:
        yield "topography:"
        yield f"  scans: {json.dumps(list(film.settings.scans), ensure_ascii=False)}"
        tip = film.settings.tip_radius_nm
        note = "# of the AFM tip, where no file states it" + (
            "" if tip is not None else "; 5 is taken, state yours"
        )
        yield f"  tip_radius_nm: {'null' if tip is None else f'{tip:g}'}  {note}"
        stated = film.settings.model_dump(
            mode="json", include={"channel", "detrend", "instruments"}, exclude_none=True
        )
        plain = TopographySettings().model_dump(mode="json")
        for name in (name for name, value in stated.items() if value != plain[name]):
            yield f"  {name}: {json.dumps(stated[name], ensure_ascii=False)}"
    yield "inputs:  # uniform [low, high], normal [mean, deviation], fixed [value]"
    yield "  # without its row, e_star is computed by DFT and h_prime by molecular dynamics"
    rows = {**MATERIAL, **material}
    if film is None:
        rows |= {name: PAPER_ROWS[name] for name in ("q0", "hurst", "rms")}
    for name, row in rows.items():
        about = definition(name)
        values = ", ".join(
            f"{value:.12g}" for value in row.values or () if isinstance(value, float)
        )
        stated = f"origin: literature, distribution: {row.distribution}, values: [{values}]"
        yield f"  # {about.label}{f', {about.unit}' if about.unit != '1' else ''}"
        yield f"  {name}: {{{stated}, source: {json.dumps(row.source, ensure_ascii=False)}}}"
    grid = "pixels: 512, q1_per_nm: 0.5"  # which that resolves (docs/contact.md, The cut-off)
    if film is not None:
        if "q1" not in rows:
            yield "  q1: {origin: topography}  # no roughness beyond what the measurements show"
        grid = (
            "pixels:"
            f" {pixels_for(film.description['inputs'].get('q1'), film.description['cell_nm'])}"
        )
    yield (
        f"contact: {{mechanics: coupled, attraction: offset, {grid}}}  # asperities share one"
        " elastic half-space"
    )
    yield "device:  # a published beam, where you gave nothing else"
    defaults = DeviceSettings()
    for name in SCALAR_KEYS:
        value = device.get(name, getattr(defaults, name))
        about = DeviceSettings.model_fields[name].description
        untold = "# " * (name in KNOWN_IF_STATED and name not in device)
        yield f"  {untold}{name}: {_as_yaml(value)}  # {about}"
    if measured := device.get("measured"):
        yield "  measured:  # value and standard error, which narrow the device"
        for name, pair in measured.items():
            yield f"    {name}: {_as_yaml(pair)}"


def _as_yaml(value: float | str | tuple[float, float] | None) -> str:
    """A value of the device as a scene has it."""
    if isinstance(value, float):
        return f"{value:g}"
    return json.dumps(value)
