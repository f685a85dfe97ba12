"""Files that are cut, flipped, blown up or misnamed, and the judge of what reading them gives.

A file is refused in one line, or what it gives is a surface: finite heights and spectra, of a
plausible size.
"""

import random
from collections.abc import Callable
from pathlib import Path

import numpy as np

from mesoscale.errors import InputError
from mesoscale.settings import TopographySettings
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.loading import FILE_NM, load_measurements, write_gwy
from mesoscale.topography.records import record

ANALYSED = 300_000  # bytes of a file whose spectra are computed, too
HEAD = 2048  # bytes in which a format describes itself

Damage = Callable[[random.Random, bytes], bytes]


def _flip(rng: random.Random, content: bytes, count: int, within: int) -> bytes:
    changed = bytearray(content)
    for _ in range(count):
        changed[rng.randrange(min(within, len(changed)))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def _digits(rng: random.Random, content: bytes, put: bytes) -> bytes:
    """Some digits of the head replaced, as text formats and headers hold sizes."""
    places = [k for k, byte in enumerate(content[:HEAD]) if chr(byte).isdigit()]
    for place in sorted(rng.sample(places, min(3, len(places))), reverse=True):
        content = content[:place] + put + content[place + 1 :]
    return content


def _insert(rng: random.Random, content: bytes) -> bytes:
    place = rng.randrange(len(content))
    return content[:place] + rng.randbytes(rng.randrange(1, 64)) + content[place:]


def _hole(rng: random.Random, content: bytes) -> bytes:
    start = rng.randrange(len(content))
    return content[:start] + content[start + rng.randrange(1, 1 + len(content) // 4) :]


def _blank(rng: random.Random, content: bytes, byte: bytes) -> bytes:
    start, count = rng.randrange(len(content)), rng.randrange(1, 1 + len(content) // 2)
    return content[:start] + byte * len(content[start : start + count]) + content[start + count :]


DAMAGES: dict[str, Damage] = {
    "as it is": lambda rng, content: content,
    "empty": lambda rng, content: b"",
    "one byte": lambda rng, content: content[:1],
    "head alone": lambda rng, content: content[: rng.randrange(2, HEAD)],
    "cut": lambda rng, content: content[: rng.randrange(len(content))],
    "last byte lost": lambda rng, content: content[:-1],
    "first bytes lost": lambda rng, content: content[rng.randrange(1, 64) :],
    "hole": _hole,
    "bytes inserted": _insert,
    "twice": lambda rng, content: content + content,
    "tail of rubbish": lambda rng, content: content + rng.randbytes(1000),
    "zeros": lambda rng, content: _blank(rng, content, b"\x00"),
    "ones": lambda rng, content: _blank(rng, content, b"\xff"),
    "noise": lambda rng, content: content[:64] + rng.randbytes(len(content) - 64),
    "one bit of the head": lambda rng, content: _flip(rng, content, 1, HEAD),
    "ten bits of the head": lambda rng, content: _flip(rng, content, 10, HEAD),
    "hundred bits of the head": lambda rng, content: _flip(rng, content, 100, HEAD),
    "one bit": lambda rng, content: _flip(rng, content, 1, len(content)),
    "thousand bits": lambda rng, content: _flip(rng, content, 1000, len(content)),
    "digits nine": lambda rng, content: _digits(rng, content, b"9"),
    "digits zero": lambda rng, content: _digits(rng, content, b"0"),
    "minus signs": lambda rng, content: _digits(rng, content, b"-"),
    "sizes blown up": lambda rng, content: _digits(rng, content, b"999999999"),
    "letters for digits": lambda rng, content: _digits(rng, content, b"x"),
    "line ends": lambda rng, content: content.replace(b"\n", b"\r"),
}


def made_files(folder: Path) -> list[Path]:
    """Files that this code or the reader library writes, so that a campaign needs none of an
    instrument.
    """
    heights = np.cumsum(np.random.default_rng(0).standard_normal((64, 64)), axis=0)
    folder.mkdir(parents=True, exist_ok=True)
    write_gwy(folder / "made.gwy", Scan(heights, (1000.0, 1000.0), "made"))
    lines = "".join(f"{k * 2.0},{z:.6g}\n" for k, z in enumerate(heights[:, :8].ravel()))
    (folder / "made.csv").write_text("x (nm),z (nm)\n" + lines)
    from SurfaceTopography import Topography

    topography = Topography(heights, (1000.0, 1000.0), unit="nm")
    topography.to_netcdf(str(folder / "made.nc"))
    topography.to_matrix(str(folder / "made.asc"))
    x, y = np.meshgrid(np.arange(64.0), np.arange(64.0), indexing="ij")
    np.savetxt(
        folder / "made.xyz", np.stack([x.ravel(), y.ravel(), heights.ravel()], axis=1), fmt="%.6g"
    )
    return sorted(folder.iterdir())


def judge(path: Path, settings: TopographySettings) -> tuple[str, str]:
    """Outcome (refused, used or fault) and its words."""
    try:
        for measured in load_measurements(path, settings=settings):
            arrays = record(measured, settings)[0] if path.stat().st_size < ANALYSED else {}
            lengths = getattr(measured.data, "lengths_nm", None) or (measured.data.length_nm,)
            heights = np.asarray(measured.data.heights_nm)
            if not all(FILE_NM[0] <= length <= FILE_NM[1] for length in lengths):
                return "fault", f"believed a size of {lengths}"
            if not np.isfinite(heights).mean() > 0.5 or not all(
                np.isfinite(part).all() for part in arrays.values()
            ):
                return "fault", "numbers that are not finite"
    except InputError as error:
        text = str(error)
        named = path.name in text or path.stem in text
        return (
            ("refused", text)
            if named and "\n" not in text
            else ("fault", f"refusal without its file: {text}")
        )
    except Exception as error:  # a campaign counts whatever comes
        return "fault", f"{type(error).__name__}: {error}"
    return "used", "a surface"
