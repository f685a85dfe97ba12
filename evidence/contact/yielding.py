"""Does one load on a surface that yields have the contact of a closing, and of another code?

Random maps, periodic and of constant hardness, are pressed by `asp.press`'s solver for one load
and by a closing of the engine in 40 steps of the force, on which surfaces flow step by step. Then
tamaas' `KatoSaturated` (`pip install tamaas`), whose pressures have the same bounds, presses some
of them. The error is the mean difference of the pressure over its mean (L1). Seconds are those of
the processor. Seeds 1 to 40 were stated before the first run.
"""

import argparse
import importlib.util
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from mesoscale.contact import ContactInputs
from mesoscale.contact.coupled import one_load, validity
from mesoscale.contact.coupled.base import Repeated
from mesoscale.contact.coupled.engine import CoupledContact
from mesoscale.contact.path import trace
from mesoscale.settings import ContactSettings
from mesoscale.topography.synthesis import synthesize

SITE_NM = 1.0
PEER_SEEDS = 8  # so many of the seeds are given to the peer, too: the first
PEER_TOLERANCE = 1e-8
FORCE_STEPS = 40


class Draw(NamedTuple):
    """A map and its load: heights (nm), E* and hardness (GPa), mean pressure (GPa)."""

    heights: np.ndarray
    e_star: float
    hardness: float
    pressure_GPa: float

    @property
    def length_nm(self) -> float:
        """Side of the map."""
        return SITE_NM * len(self.heights)

    @property
    def load_nN(self) -> float:
        """Force on the whole map."""
        return self.pressure_GPa * self.length_nm**2


def arguments(parser: argparse.ArgumentParser) -> None:
    """Which draws."""
    parser.add_argument("--seeds", type=int, nargs="+", default=list(range(1, 41)))


def draw(seed: int) -> Draw:
    """A random map with a hardness of 0.1 to 3 times E* h' / 2, pressed to 0.1 to 50 % of what
    carries it: its hardness or, where that is less, E* h'.
    """
    random = np.random.default_rng(np.random.SeedSequence([20261129, seed]))
    pixels = int(random.choice([128, 256, 512]))
    length = SITE_NM * pixels
    shortest = random.uniform(2.0, 32.0) * SITE_NM
    hurst = random.uniform(0.3, 1.0)
    longest = length / random.uniform(1.0, 8.0)
    heights = synthesize(
        pixels,
        length,
        2 * np.pi / max(longest, 2 * shortest),
        hurst,
        random.uniform(0.5, 10.0),
        seed,
        "areal",
        2 * np.pi / shortest,
    )
    e_star = random.uniform(50.0, 200.0)
    stiff = e_star * validity.roughness(heights, length).slope
    hardness = 0.5 * stiff * 10 ** random.uniform(-1.0, 0.5)
    pressure = min(hardness, stiff) * 10 ** random.uniform(-3.0, np.log10(0.5))
    return Draw(heights, e_star, hardness, pressure)


def rows(options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each draw and code that it is compared with."""
    peer = importlib.util.find_spec("tamaas") is not None
    _pressed(draw(0))  # all is compiled
    _closed(draw(0))
    for seed in options.seeds:
        drawn = draw(seed)
        ours, seconds = _pressed(drawn)
        others = [("closing", _closed)]
        if peer and seed <= PEER_SEEDS:
            others.append(("tamaas", _by_peer))
        for code, work in others:
            start = time.process_time()
            pressure = work(drawn)
            other_s = time.process_time() - start
            yield {
                "seed": seed,
                "pixels": len(drawn.heights),
                "code": code,
                "share": float((pressure > 0.0).mean()),
                "yielded": float((pressure >= 0.999 * drawn.hardness)[pressure > 0.0].mean()),
                "settled": ours.settled,
                "sites_differ": int(((ours.pressure > 0.0) != (pressure > 0.0)).sum()),
                "error": float(np.abs(ours.pressure - pressure).mean() / pressure.mean()),
                "transforms": ours.transforms,
                "cpu_s": seconds,
                "other_cpu_s": other_s,
            }


def _pressed(drawn: Draw) -> tuple[one_load.Pressed, float]:
    """The load by itself, and its seconds."""
    base = Repeated(drawn.heights.shape, SITE_NM, drawn.e_star)
    start = time.process_time()
    pressed = one_load.press_yielding(drawn.heights, drawn.load_nN, drawn.hardness, base)
    return pressed, time.process_time() - start


def _closed(drawn: Draw) -> np.ndarray:
    """Pressures at the end of a closing."""
    inputs = ContactInputs(
        hamaker=0.0,
        e_star=drawn.e_star,
        h_macro=drawn.hardness,
        h_prime=0.0,
        q0=1.0,
        hurst=0.5,
        rms=0.0,
    )
    settings = ContactSettings(
        mechanics="coupled", pixels=len(drawn.heights), length_nm=drawn.length_nm
    )
    contact = CoupledContact(drawn.heights.copy(), inputs, settings)
    trace(contact, FORCE_STEPS, True, stop_force=drawn.load_nN)
    return contact.fields()[0]


def _by_peer(drawn: Draw) -> np.ndarray:
    """Pressures by tamaas."""
    import tamaas  # pyright: ignore[reportMissingImports]  (optional extra)

    tamaas.set_log_level(tamaas.LogLevel.error)
    side = drawn.length_nm
    model = tamaas.Model(tamaas.model_type.basic_2d, [side, side], list(drawn.heights.shape))
    model.E = drawn.e_star
    model.nu = 0.0  # E / (1 - nu^2) = E*
    solver = tamaas.KatoSaturated(model, -drawn.heights, PEER_TOLERANCE, drawn.hardness)
    solver.max_iter = 20_000
    solver.solve(drawn.pressure_GPa)
    return np.array(model.traction).reshape(drawn.heights.shape)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Draws, those with the same sites, and times that others take over ours."""
    numbers = {}
    for code in ("closing", "tamaas"):
        group = [row for row in rows if row["code"] == code and row["settled"] == "True"]
        ratios = [float(row["other_cpu_s"]) / float(row["cpu_s"]) for row in group]
        numbers[f"{code}_draws"] = f"{len(group)}"
        numbers[f"{code}_same"] = f"{sum(row['sites_differ'] == '0' for row in group)}"
        numbers[f"{code}_median"] = f"{np.median(ratios):.0f}"
        numbers[f"{code}_most"] = f"{max(ratios):.0f}"
    return numbers
