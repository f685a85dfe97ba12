"""How often do 90 % intervals hold the truth, by kind of film and of measurement?

Maps have 256 x 256 pixels. Fine ones are of 1 and 5 um, seen by a tip whose radius is told wrong by
up to 20 %. Coarse ones are of 20 to 100 um, with a roll-off that goes into the cell or is longer.
Lines are of 2 and 8 um; mixed are maps of 1 um with lines of 8 um. Grainy and grooved maps, of 1
and 3 um, have log-normal heights, upright or upside down. On uneven films RMS heights of places
scatter by 40 %. Alone is one line or map of 1 to 10 um, with 0.3 to 30 waves of the knee. Few are a
map of 1 um and a line of 200 um, as the diamond film has them, of places that scatter by up to 50
%.

Held are: q0, slope and RMS height of eq. 9; the RMS height of the cell in use (`cell`); RMS slope
and curvature of the one spectrum (`steep`, `curved`); first contact of one more cell (`touch`), of
waves up to the measured end. Where eq. 9 is not used, its parameters do not count.

Grooves of little skewness (0.4) look Gaussian in their images. Their RMS height is then found a
tenth too small, and no interval holds it: these are the sets of grooved maps that eq. 9 describes.
"""

import argparse
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from evidence.record import load
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.cells import Cell, FilmPieces
from mesoscale.settings import ContactSettings, TopographySettings
from mesoscale.topography.description.heights import common_heights
from mesoscale.topography.description.inputs import rms_before
from mesoscale.topography.height_synthesis import Z, synthesize_heights
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.loading import Measurement
from mesoscale.topography.measurements.profiles import Profile
from mesoscale.topography.pooling import Pooled, pool
from mesoscale.topography.profile_conversion import projected
from mesoscale.topography.records import in_order, record, trusted_record
from mesoscale.topography.roughness_spectrum import RoughSpectrum, hurst_from_slope, mean_square
from mesoscale.topography.synthetic_scans import ScanSet, dilate, measure, synthetic_scans

# the tip meets the surface on 2 nm or 5 nm; of what it traces every second pixel is kept, for speed
BASE = ScanSet(
    pixels=512, small_scans=4, large_scans=3, large_length_nm=5000.0, rms_variation=0.0, seed=17
)
THINNED = 2
TIP_ERROR = 0.2
# of grainy maps: one step for both sizes, because finer roughness under a tip changes all waves of
# its image
GRAINY_MAPS = ((1000.0, 512), (3000.0, 1536))
LINES = ((8000.0, 4), (2000.0, 4))  # length in nm and number of the profiles of a set
LINE_POINTS, FINER = 2048, 4
# log-normal heights: skewness 0.3 to 0.95; for more the spectrum can no longer be kept
SHAPES = (0.1, 0.3)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Kinds and sets."""
    parser.add_argument("--kinds", nargs="*", default=list(KINDS), choices=list(KINDS))
    parser.add_argument(
        "--sets", type=int, default=40, help="of each kind, 1 to 6 s each on one core"
    )


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """One row for each set of measurements that the table does not have."""
    present = {(row["kind"], int(row["set"])) for row in load("topography.coverage")}
    for kind in given.kinds:
        for number in range(given.sets):
            if (kind, number) not in present:
                yield set_row(kind, number)


def random_truth(number: int, base: ScanSet) -> tuple[ScanSet, float]:
    """Truth and artefacts of set `number`, and the tip radius (nm) that the analysis is told."""
    rng = np.random.default_rng(np.random.SeedSequence(base.seed, spawn_key=(99, number)))
    tip = float(rng.uniform(2, 10))
    truth = base.model_copy(
        update={
            "seed": int(rng.integers(2**31)),
            "q0": float(rng.uniform(0.015, 0.035)),
            "slope": float(rng.uniform(2.2, 3.8)),
            "rms_nm": float(np.exp(rng.uniform(np.log(2), np.log(12)))),
            "tip_radius_nm": tip,
            "noise_nm": float(rng.uniform(0.02, 0.1)),
            "line_noise_nm": float(rng.uniform(0, 0.5)),
            "tilt_deg": float(rng.uniform(0, 2)),
            "drift_nm": float(rng.uniform(0, 10)),
            "step_nm": float(rng.uniform(0.002, 0.05)),
        }
    )
    return truth, tip * float(rng.uniform(1 - TIP_ERROR, 1 + TIP_ERROR))


def maps(truth: ScanSet, stated_nm: float) -> Iterator[Measurement]:
    """Scans of a Gaussian surface, seen with a tip whose radius is stated as `stated_nm`."""
    for item in synthetic_scans(truth):
        yield Measurement(_thinned(item.scan, THINNED), stated_nm, True)


def _thinned(scan: Scan, stride: int) -> Scan:
    return replace(scan, heights_nm=np.ascontiguousarray(scan.heights_nm[::stride, ::stride]))


def grainy_maps(truth: ScanSet, stated_nm: float, upright: int = 1) -> Iterator[Measurement]:
    """Scans of a surface of the same spectrum whose heights are distributed log-normally: tall
    grains.
    """
    rng = np.random.default_rng(np.random.SeedSequence(truth.seed, spawn_key=(2,)))
    heights = grains(truth, upright)
    for (length, sites), count in zip(
        GRAINY_MAPS, (truth.small_scans, truth.large_scans), strict=True
    ):
        for _ in range(count):
            spectrum = RoughSpectrum.from_rms(truth.rms_nm, truth.q0, truth.slope, truth.q1)
            rms = _random_rms(spectrum, 2 * length, 2 * sites, rng)
            larger = synthesize_heights(
                2 * sites, 2 * length, spectrum.psd, heights, rms, int(rng.integers(2**31))
            )
            surface = dilate(larger[:sites, :sites], truth.tip_radius_nm, length / sites)
            scan = measure(surface, length, truth, rng, f"grainy_{rng.integers(2**31)}")
            yield Measurement(_thinned(scan, sites * THINNED // truth.pixels), stated_nm, True)


def grains(truth: ScanSet, upright: int) -> tuple[float, ...]:
    """Log-normal heights of a set: their values at the normal variables `Z`; tall peaks, or deep
    grooves (-1).
    """
    shape = np.random.default_rng(np.random.SeedSequence(truth.seed, spawn_key=(7,))).uniform(
        *SHAPES
    )
    return common_heights([upright * np.exp(upright * shape * Z)])


def _random_rms(
    spectrum: RoughSpectrum, length: float, sites: int, rng: np.random.Generator
) -> float:
    """RMS height of one periodic surface: `synthesize_heights` gives each the same, chance does
    not.
    """
    q = np.geomspace(2 * np.pi / length, np.pi * sites / length, 400)
    square = np.trapezoid(2 * np.pi * q * spectrum.psd(q), q)
    fourth = np.trapezoid(2 * np.pi * q * spectrum.psd(q) ** 2, q) * (2 * np.pi / length) ** 2
    return float(
        np.sqrt(square * max(1 + np.sqrt(2 * fourth) / square * rng.standard_normal(), 0.1))
    )


def lines(truth: ScanSet, counts: Sequence[tuple[float, int]] = LINES) -> Iterator[Measurement]:
    """Profiles of some lengths across a Gaussian surface, by an instrument without tip, tilted and
    noisy.
    """
    rng = np.random.default_rng(np.random.SeedSequence(truth.seed, spawn_key=(3,)))
    spectrum = RoughSpectrum.from_rms(truth.rms_nm, truth.q0, truth.slope, truth.q1)
    q = np.geomspace(1e-5, truth.q1, 4000)
    for length, count in counts:
        for number in range(count):
            heights = _line(q, spectrum.psd(q), length, rng)
            heights += truth.noise_nm * rng.standard_normal(LINE_POINTS)
            heights += np.linspace(
                0, length * np.tan(np.radians(truth.tilt_deg * rng.uniform(-1, 1))), LINE_POINTS
            )
            yield Measurement(Profile(heights, length, f"line_{length:g}_{number}"), 0.0, True)


def _line(q: np.ndarray, psd: np.ndarray, length: float, rng: np.random.Generator) -> np.ndarray:
    """Heights along a line across a surface, cut from twice its length, sampled from finer
    points.
    """
    n, step = 2 * FINER * LINE_POINTS, length / LINE_POINTS / FINER
    k = 2 * np.pi * np.fft.rfftfreq(n, step)[1:]
    c1 = np.where(k < q[-1], projected(q, psd, np.minimum(k, 0.999 * q[-1])), 0.0)
    noise = rng.standard_normal((2, len(k))) / np.sqrt(2)
    waves = (noise[0] + 1j * noise[1]) * np.sqrt(c1 * 2 * np.pi / (n * step)) * n
    return np.fft.irfft(np.concatenate([[0.0], waves]), n)[: n // 2 : FINER]


def alone(truth: ScanSet, stated_nm: float, line: bool) -> tuple[ScanSet, Iterator[Measurement]]:
    """One line or one map: the only measurement of a film, as people have it."""
    rng = np.random.default_rng(np.random.SeedSequence(truth.seed, spawn_key=(11,)))
    length = float(np.exp(rng.uniform(*np.log(ALONE_NM))))
    first = 2 * np.pi / length
    q0 = first * float(np.exp(rng.uniform(*np.log(ALONE_WAVES))))
    # the RMS height drawn is that of waves up to its length
    seen = 1 - mean_square(1.0, q0, truth.slope, first) / mean_square(
        1.0, q0, truth.slope, truth.q1
    )
    known = {
        "q0": q0,
        "rms_nm": truth.rms_nm / float(np.sqrt(seen)),
        "small_scans": 0,
        "large_scans": 1,
    }
    truth = truth.model_copy(update=known | {"large_length_nm": length})
    return truth, lines(truth, counts=((length, 1),)) if line else maps(truth, stated_nm)


def mixed(truth: ScanSet, stated_nm: float) -> Iterator[Measurement]:
    """Maps of 1 um, too small for the plateau, and the long profiles, which see it."""
    yield from maps(truth.model_copy(update={"large_scans": 0}), stated_nm)
    yield from (item for item in lines(truth) if item.data.name.startswith(f"line_{LINES[0][0]:g}"))


def few(truth: ScanSet, stated_nm: float) -> Iterator[Measurement]:
    """A map of 1 um and a line of 200 um at places that differ, without a wave in common."""
    rng = np.random.default_rng(np.random.SeedSequence(truth.seed, spawn_key=(13,)))
    yield from maps(truth.model_copy(update={"small_scans": 1, "large_scans": 0}), stated_nm)
    level = float(np.exp(truth.rms_variation * rng.standard_normal()))
    yield from lines(
        truth.model_copy(update={"rms_nm": level * truth.rms_nm}), counts=((200e3, 1),)
    )


def _few_truth(truth: ScanSet) -> ScanSet:
    """A film of long waves whose places scatter by up to 50 %."""
    rng = np.random.default_rng(np.random.SeedSequence(truth.seed, spawn_key=(12,)))
    q0, scatter = float(np.exp(rng.uniform(*np.log(FEW_Q0)))), float(rng.uniform(0, 0.5))
    return truth.model_copy(update={"q0": q0, "rms_nm": 3 * truth.rms_nm, "rms_variation": scatter})


def coarse(truth: ScanSet) -> Iterator[Measurement]:
    """Maps of `large_length_nm` by an instrument without tip."""
    yield from maps(
        truth.model_copy(update={"small_scans": 0, "large_scans": 4, "tip_radius_nm": 0.0}), 0.0
    )


def _coarse_truth(truth: ScanSet, waves: tuple[float, float]) -> ScanSet:
    """A film of 20 to 100 um maps whose roll-off goes `waves` times into a map."""
    rng = np.random.default_rng(np.random.SeedSequence(truth.seed, spawn_key=(5,)))
    length = float(np.exp(rng.uniform(*np.log(COARSE_NM))))
    q0 = 2 * np.pi / length * float(np.exp(rng.uniform(*np.log(waves))))
    return truth.model_copy(
        update={"large_length_nm": length, "q0": q0, "rms_nm": 10 * truth.rms_nm}
    )


CHARTS = {"grainy": 1, "grooved": -1}
Kind = Callable[[ScanSet, float], tuple[ScanSet, Iterator[Measurement]]]
COARSE_NM = (20e3, 100e3)
ALONE_NM, ALONE_WAVES = (1e3, 1e4), (0.3, 30.0)
FEW_Q0 = (0.001, 0.005)
KINDS: dict[str, Kind] = {
    "areal": lambda truth, told: (truth, maps(truth, told)),
    "coarse_inside": lambda truth, _: (made := _coarse_truth(truth, (16, 32)), coarse(made)),
    "coarse_outside": lambda truth, _: (made := _coarse_truth(truth, (4, 8)), coarse(made)),
    "lines": lambda truth, _: (truth, lines(truth)),
    "mixed": lambda truth, told: (truth, mixed(truth, told)),
    "grainy": lambda truth, told: (truth, grainy_maps(truth, told)),
    "grooved": lambda truth, told: (truth, grainy_maps(truth, told, upright=-1)),
    "uneven": lambda truth, told: (
        made := truth.model_copy(update={"rms_variation": 0.4}),
        maps(made, told),
    ),
    "line_alone": lambda truth, told: alone(truth, told, line=True),
    "map_alone": lambda truth, told: alone(truth, told, line=False),
    "few": lambda truth, told: (made := _few_truth(truth), few(made, told)),
}
FINE_CELL_NM = 1000.0
NAMES = ("q0", "slope", "rms")
HELD = (*NAMES, "cell", "steep", "curved", "touch")
# cells of the description; one more lies between the second from both ends with probability 0.9
DRAWN = 39
GRIDS = (32, 64, 128, 256, 512)


def set_row(kind: str, number: int) -> dict[str, Any]:
    """The row of one set: truth, estimate, interval."""
    truth, told = random_truth(number, BASE)
    truth, made = KINDS[kind](truth, told)
    settings = TopographySettings(scans=("set",), tip_radius_nm=told)
    row: dict[str, Any] = {
        "kind": kind,
        "set": number,
        "measurements": 0,
        "refused": 0,
        "description": "",
        "doubts": "",
    }
    row |= {f"{name}{part}": "" for name in HELD for part in ("_true", "", "_low", "_high")}
    arrays, attributes = {}, {}
    for item in made:
        try:
            arrays[item.data.name], attributes[item.data.name] = record(item, settings)
        except InputError:  # a line of noise
            row["refused"] += 1
    arrays = in_order(arrays, attributes)
    highs = [trusted_record(name, data, attributes[name]).high for name, data in arrays.items()]
    cell_nm = max(FINE_CELL_NM, 16 * np.pi / max(highs))
    pooled = pool(arrays, attributes, settings, cell_nm)
    row |= {"measurements": len(arrays), "description": pooled.choice.name}
    row["doubts"] = " ".join(doubt.code for doubt in pooled.doubts)
    spectrum = RoughSpectrum.from_rms(truth.rms_nm, truth.q0, truth.slope, truth.q1)
    found = {
        name: (item.value, *item.interval) for name, item in pooled.topography.estimates.items()
    }
    true = {"q0": truth.q0, "slope": truth.slope, "rms": _rms(spectrum, pooled.topography.cutoff)}
    one = pooled.merged
    if "rms" in pooled.film:
        low, high = pooled.film["rms"]["a"], pooled.film["rms"].get("b", pooled.film["rms"]["a"])
        found["cell"] = (np.sqrt(low * high), low, high)
        end = 10 * one.q[-1] if pooled.surface and one is not None else pooled.topography.cutoff
        true["cell"] = _cell_rms(spectrum, cell_nm, end)
    if one is not None:
        statistics = one.statistics()
        for name, of, power, factor in (
            ("steep", "rms_slope", 2, 1.0),
            ("curved", "rms_curvature", 4, 0.5),
        ):
            found[name] = (statistics[of]["value"], *statistics[of]["interval"])
            q = np.geomspace(one.first, min(one.q[-1], truth.q1), 4000)
            moment = np.trapezoid(2 * np.pi * q ** (power + 1) * spectrum.psd(q), q)
            true[name] = factor * float(np.sqrt(moment))
    if pooled.rows:
        chart = grains(truth, CHARTS[kind]) if kind in CHARTS else ()
        true["touch"], found["touch"] = _first_contacts(
            pooled, truth, chart, cell_nm, list(KINDS).index(kind)
        )
    for name in true:
        if name in found:
            value, low, high = found[name]
            row |= {
                f"{name}_true": true[name],
                name: value,
                f"{name}_low": low,
                f"{name}_high": high,
            }
    return row


def _first_contacts(
    pooled: Pooled, truth: ScanSet, chart: tuple[float, ...], cell_nm: float, kind: int
) -> tuple[float, tuple[float, float, float]]:
    """First contact (nm) of a cell of the truth, and median and 90 % interval of cells by the
    description.
    """
    q1, rms_scatter = (
        pooled.film[name] if name in pooled.film else pooled.rows[name]
        for name in ("q1", "rms_scatter")
    )
    end = min(_middle(q1), truth.q1)
    pixels = next((n for n in GRIDS if np.pi * n / cell_nm >= end), GRIDS[-1])
    end = min(end, np.pi * pixels / cell_nm)
    rms = rms_before(
        {**q1, "a": end, "b": end}, pooled.film["rms"], pooled.topography, pooled.surface
    )
    grid = {"pixels": pixels, "length_nm": cell_nm, "q1_per_nm": end}
    rng = np.random.default_rng(np.random.SeedSequence(truth.seed, spawn_key=(8, kind)))

    def touches(surface: dict[str, Any], scatter: float, **roughness: float) -> float:
        roughness["rms"] *= float(np.exp(scatter * rng.standard_normal()))
        inputs = ContactInputs(hamaker=0.2, e_star=91, h_macro=2, h_prime=8, **roughness)
        pieces = FilmPieces(inputs, ContactSettings(**grid, surface=surface))
        return -float(pieces.surface(Cell(int(rng.integers(2**31)), 0.0, rng.normal(), 1.0)).min())

    spectrum = RoughSpectrum.from_rms(truth.rms_nm, truth.q0, truth.slope, truth.q1)
    hurst = hurst_from_slope(truth.slope, "areal")
    surface = {"heights": chart} if chart else {}
    true = touches(
        surface,
        truth.rms_variation,
        q0=truth.q0,
        hurst=hurst,
        rms=_cell_rms(spectrum, cell_nm, end),
    )
    rows = {"q0": pooled.film["q0"], "hurst": pooled.film["hurst"], "rms": rms}
    drawn = sorted(
        touches(
            pooled.surface,
            _middle(rms_scatter),
            **{name: rng.uniform(row["a"], row.get("b", row["a"])) for name, row in rows.items()},
        )
        for _ in range(DRAWN)
    )
    return true, (drawn[DRAWN // 2], drawn[1], drawn[-2])


def _middle(row: Mapping[str, float]) -> float:
    return 0.5 * (row["a"] + row.get("b", row["a"]))


def _rms(spectrum: RoughSpectrum, end: float) -> float:
    """RMS height (nm) of the waves up to `end` (1/nm)."""
    return float(
        np.sqrt(mean_square(spectrum.plateau, spectrum.q0, spectrum.slope, min(end, spectrum.q1)))
    )


def _cell_rms(spectrum: RoughSpectrum, cell_nm: float, end: float) -> float:
    """RMS height (nm) of a periodic cell of a film that is flat beyond its longest wave, by a sum
    over all waves.
    """
    numbers = np.arange(-CELL_WAVES, CELL_WAVES + 1)
    step = 2 * np.pi / cell_nm
    q = step * np.hypot(numbers[:, None], numbers)
    last = min(CELL_WAVES * step, end, spectrum.q1)
    summed = float(np.sum(spectrum.psd(np.maximum(q[q <= last], step)))) * step**2
    rest = max(_rms(spectrum, end) ** 2 - _rms(spectrum, last) ** 2, 0.0)
    return float(np.sqrt(summed + rest))


CELL_WAVES = 64


def errors_of(rows: Sequence[Mapping[str, str]], name: str) -> tuple[np.ndarray, np.ndarray]:
    """Error of each estimate, relative but for the slope, and whether its interval holds the
    truth.
    """
    columns = (f"{name}_true", name, f"{name}_low", f"{name}_high")
    true, value, low, high = np.array(
        [[float(row[key]) for key in columns] for row in rows if row[name]]
    ).T
    return value - true if name == "slope" else value / true - 1, (low <= true) & (true <= high)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Of each kind its sets, and of each quantity the share held and the RMS error (relative, but
    of the slope).
    """
    found = {}
    for kind in KINDS:
        mine = [row for row in rows if row["kind"] == kind and row["measurements"] != "0"]
        if not mine:
            continue
        found[f"{kind}_sets"] = str(len(mine))
        for name in HELD:
            used = [row for row in mine if name not in NAMES or row["description"] == "power_law"]
            if known := [row for row in used if row[name]]:
                error, held = errors_of(known, name)
                root = float(np.sqrt(np.mean(error**2)))
                found[f"{kind}_{name}_held"] = f"{np.mean(held):.0%}"
                found[f"{kind}_{name}_error"] = f"{root:.2f}" if name == "slope" else f"{root:.1%}"
    return found
