"""Hard cases of the topography stage as files: read right, or refused in one line (target
`stability`).
"""

import json
import tempfile
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

import numpy as np

from mesoscale.errors import InputError
from mesoscale.settings import InstrumentSettings, TopographySettings
from mesoscale.studies.driver import HardCase
from mesoscale.topography.description.overlaps import overlaps, refuse_different_films
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.loading import load_measurements, write_gwy
from mesoscale.topography.pooling import pool
from mesoscale.topography.records import record, trusted_record
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.synthetic_scans import surface_patch

TRUTH = RoughSpectrum.from_rms(6.0, 0.025, 2.84, 3.2)
LENGTH, POINTS = 4000.0, 2048
WITHIN = 0.1  # relative error of the RMS height
BOMB_MB = 64


@dataclass(frozen=True)
class FileCase:
    """Files in a folder, and what must come of them.

    `word` is part of the refusal; empty where the RMS height must be recovered within `WITHIN`.
    """

    name: str
    description: str
    write: Callable[[Path], list[Path]]
    word: str = ""
    unit: str | None = None


@cache
def _line(seed: int) -> np.ndarray:
    surface = surface_patch(TRUTH, POINTS, LENGTH, np.random.default_rng(seed))
    line = np.stack([np.arange(POINTS) * LENGTH / POINTS, surface[:, POINTS // 2]], axis=1)
    line.setflags(write=False)  # of many cases
    return line


def _text(
    folder: Path, head: str = "x (nm), z (nm)", factor: float = 1.0, lines: int = 6
) -> list[Path]:
    paths = [folder / f"line_{k}.csv" for k in range(lines)]
    for k, path in enumerate(paths):
        np.savetxt(path, factor * _line(k), delimiter=",", header=head, comments="", fmt="%.9g")
    return paths


def _uneven(folder: Path) -> list[Path]:
    paths = []
    for seed in range(6):
        line = _line(seed)
        rng = np.random.default_rng(seed)
        half = np.sort(rng.choice(POINTS, POINTS // 2, replace=False))
        paths.append(folder / f"line_{seed}.csv")
        np.savetxt(paths[-1], line[half], delimiter=",", header="x (nm), z (nm)", comments="")
    return paths


def _mixed(folder: Path) -> list[Path]:
    paths = _text(folder, lines=4)
    for seed in range(2):
        surface = surface_patch(TRUTH, 256, 1000.0, np.random.default_rng(50 + seed))
        paths.append(folder / f"map_{seed}.gwy")
        write_gwy(paths[-1], Scan(surface, (1000.0, 1000.0), "map"))
    return paths


def _films(folder: Path) -> list[Path]:
    paths = []
    for name, factor in (("smooth", 0.1), ("rough", 10.0)):
        surface = factor * surface_patch(TRUTH, 256, 1000.0, np.random.default_rng(3))
        paths.append(folder / f"{name}.gwy")
        write_gwy(paths[-1], Scan(surface, (1000.0, 1000.0), name))
    return paths


def _container(folder: Path, **changes: str | bytes) -> list[Path]:
    """A container of one line; `changes` replace files in it."""
    entry = {"name": "line", "unit": "nm", "datafile": {"original": "line.txt"}}
    text = "\n".join(f"{x:.6g} {z:.9g}" for x, z in _line(0))
    files = {"meta": json.dumps({"surfaces": [{"topographies": [entry]}]}), "line": text} | changes
    path = folder / "film.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("meta.yml", files["meta"])
        archive.writestr("line.txt", files["line"])
    return [path]


def _two_surfaces(folder: Path) -> list[Path]:
    return _container(folder, meta=json.dumps({"surfaces": [{"topographies": []}] * 2}))


def _changed(folder: Path, change: Callable[[np.ndarray], np.ndarray]) -> list[Path]:
    path = folder / "line.csv"
    np.savetxt(path, change(_line(0)), delimiter=",", header="x (nm), z (nm)", comments="")
    return [path]


def _with_hole(line: np.ndarray) -> np.ndarray:
    return line[(line[:, 0] < 1000) | (line[:, 0] > 2000)]


def _huge(line: np.ndarray) -> np.ndarray:
    return line * np.array([1e9, 1.0])


def _level(line: np.ndarray) -> np.ndarray:
    return line * np.array([1.0, 0.0])


CODE = "surfaces: [{topographies: []}]\nrun: !!python/object/apply:os.system ['true']\n"
FILE_CASES = (
    FileCase("profiles", "six lines of 4 um as text, nothing else", _text),
    FileCase(
        "profiles in um",
        "the same with the unit um in the heads",
        partial(_text, head="x/um,z/um", factor=1e-3),
    ),
    FileCase("uneven profiles", "half of the points of each line, at random", _uneven),
    FileCase(
        "unit by scene", "text without a head", partial(_text, head="", factor=1e-3), unit="um"
    ),
    FileCase("mixed", "four lines of 4 um and two maps of 1 um", _mixed),
    FileCase("container", "a container of one line", _container),
    FileCase(
        "no unit",
        "text without a head and without a unit in the scene",
        partial(_text, head=""),
        "length unit",
    ),
    FileCase(
        "two films",
        "two maps whose heights differ by a factor of 100",
        _films,
        "cannot be one surface",
    ),
    FileCase(
        "code",
        "a container whose list calls the system",
        partial(_container, meta=CODE),
        "nothing was executed",
    ),
    FileCase(
        "bomb",
        "a container that unpacks to 64 MB",
        partial(_container, line=b"0" * BOMB_MB * 2**20),
        "cannot be read",
    ),
    FileCase("two surfaces", "a container of two surfaces", _two_surfaces, "holds 2 surfaces"),
    FileCase(
        "hole", "a line with a hole of a quarter", partial(_changed, change=_with_hole), "a hole of"
    ),
    FileCase("huge", "a line of 4 km", partial(_changed, change=_huge), "another unit"),
    FileCase(
        "level", "a line without heights", partial(_changed, change=_level), "all heights are equal"
    ),
    FileCase(
        "short",
        "a line of 20 points",
        partial(_changed, change=lambda line: line[:20]),
        "a line of 20 points",
    ),
)


def hard_cases() -> list[HardCase]:
    """The files with their judges; each is written to a temporary folder."""
    return [
        HardCase(
            f"file: {case.name}",
            case.description,
            f"refused: {case.word}" if case.word else "the RMS height is recovered",
            partial(check_files, case),
        )
        for case in FILE_CASES
    ]


def check_files(case: FileCase) -> tuple[bool, str]:
    """Do the files give the RMS height of the surface, or their refusal? With the answer in
    words.
    """
    instrument = InstrumentSettings.model_validate(
        {"files": "*", "tip_radius_nm": 0, "unit": case.unit}
    )
    settings = TopographySettings(scans=("files",), instruments=(instrument,))
    with tempfile.TemporaryDirectory() as name:
        try:
            arrays = {}
            attributes = {}
            for path in case.write(Path(name)):
                for measured in load_measurements(path, settings=settings):
                    label = measured.data.name
                    arrays[label], attributes[label] = record(measured, settings)
            refuse_different_films(
                overlaps(
                    [trusted_record(key, data, attributes[key]) for key, data in arrays.items()]
                )
            )
            pooled = pool(arrays, attributes, settings, LENGTH)
        except InputError as error:
            text = str(error).replace(f"{name}/", "")
            return bool(case.word) and case.word in text and "\n" not in text, text
    if case.word or pooled.merged is None:
        return False, "was not refused" if case.word else "no spectrum"
    rms = float(np.sqrt(pooled.merged.moment(0)))
    error = rms / TRUTH.rms_nm - 1
    # a single line of 4 um knows the RMS height of its surface to a fifth
    allowed = WITHIN if len(arrays) > 1 else 0.3
    return (
        abs(error) <= allowed,
        f"RMS {rms:.3g} nm, error {error:+.1%}; described by {pooled.choice.name}",
    )
