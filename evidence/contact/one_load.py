"""What does one load cost beside a peer, and how near does each come to the contact for it?

One load and a closing of some tens of loads on the same elastic maps, by `asp.press`'s solver and
by tamaas (`pip install tamaas`), in one process, alternating, at several tolerances each. Seconds
are those of the processor: medians of a few repeats. The error is the mean difference of the
pressure over its mean (L1), from the solution at the tightest tolerance of the solver. In a closing
tamaas goes on from load to load, and ours is the cycle of the engine. A peer is compared at its
loosest tolerance, with ours at an error that is no larger. The smooth map has 63 sites to its
shortest wave on 1024^2, the rough one 2.
"""

import argparse
import importlib.util
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from statistics import median
from typing import Any, NamedTuple
from unittest import mock

import numpy as np

from evidence.contact.where_pads_press import MIDDLE, SEED, SMOOTH, SMOOTH_CELL
from mesoscale.contact import ContactInputs, run_cycle
from mesoscale.contact.coupled import one_load, validity
from mesoscale.contact.coupled.base import Alone, Base, Repeated
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

SLOPE_FACTOR = 2.2  # share of contact over p / (E* h'), of light loads
OUR_TOLERANCES = (1e-4, 1e-5, 1e-6)
PEER_TOLERANCES = (1e-6, 1e-8)
REFERENCE = 1e-9


class Case(NamedTuple):
    """A map, and what presses it: heights (nm), mean pressure (GPa), inputs, settings, kind."""

    what: str
    heights: np.ndarray
    pressure_GPa: float
    inputs: ContactInputs
    settings: ContactSettings

    @property
    def load_nN(self) -> float:
        """Force on the whole map."""
        return self.pressure_GPa * self.settings.length_nm**2

    def base(self) -> Base:
        """The half-space below it."""
        kind = Alone if "alone" in self.what else Repeated
        settings = self.settings
        return kind(
            self.heights.shape, settings.length_nm / settings.pixels, float(self.inputs.e_star)
        )


def arguments(parser: argparse.ArgumentParser) -> None:
    """What is timed."""
    parser.add_argument("--pixels", type=int, nargs="+", default=[128, 512, 1024, 2048])
    parser.add_argument("--shares", type=float, nargs="+", default=[0.001, 0.01, 0.05, 0.2, 0.5])
    parser.add_argument("--maps", nargs="+", default=["smooth", "rough", "smooth alone"])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--peer-repeats", type=int, default=1)
    parser.add_argument("--closing", action="store_true", help="closings instead of one load")


def rows(options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each map, load, code and tolerance."""
    peer = importlib.util.find_spec("tamaas") is not None
    small = case_of("smooth", 64, 0.05)
    for _ in _single(small, 1, 0):  # all is compiled
        pass
    run_cycle(small.inputs, small.settings, SEED, small.load_nN, small.heights, contact_at="lowest")
    for pixels in options.pixels:
        for what in options.maps:
            for share in options.shares:
                case = case_of(what, pixels, share)
                if options.closing:
                    yield from _closing(case)
                else:
                    repeats = options.peer_repeats if peer else 0
                    yield from _single(case, options.repeats, repeats)


def case_of(what: str, pixels: int, share: float) -> Case:
    """A map pressed to about a share of contact."""
    inputs = MIDDLE if what.startswith("rough") else SMOOTH
    cell = {"length_nm": float(pixels)} if what.startswith("rough") else SMOOTH_CELL
    settings = ContactSettings(pixels=pixels, mechanics="coupled", model="elastic", **cell)
    heights = random_surface(inputs, settings, SEED)
    heights -= heights.mean()
    slope = validity.roughness(heights, settings.length_nm).slope
    pressure = share * inputs.e_star * slope / SLOPE_FACTOR
    return Case(what, heights, pressure, inputs, settings)


def _single(case: Case, repeats: int, peer_repeats: int) -> Iterator[dict[str, Any]]:
    """Rows of one load by both codes."""
    exact = _pressed(case, REFERENCE).pressure
    seconds: dict[tuple[str, float], list[float]] = {}
    answers: dict[tuple[str, float], tuple[np.ndarray, float]] = {}
    for repeat in range(max(repeats, peer_repeats)):
        works: list[tuple[tuple[str, float], Callable[[], tuple[np.ndarray, float]]]] = []
        if repeat < repeats:
            works += [
                (("asperity", tol), lambda tol=tol: _ours(case, tol)) for tol in OUR_TOLERANCES
            ]
        if repeat < peer_repeats:
            works += [
                (("tamaas", tol), lambda tol=tol: _peer(case, tol)) for tol in PEER_TOLERANCES
            ]
        for key, work in works:
            start = time.process_time()
            answers[key] = work()
            seconds.setdefault(key, []).append(time.process_time() - start)
    for (code, tolerance), (pressure, transforms) in answers.items():
        yield {
            "pixels": case.settings.pixels,
            "what": case.what,
            "loads": 1,
            "MPa": 1e3 * case.pressure_GPa,
            "share": float((exact > 0.0).mean()),
            "code": code,
            "tolerance": tolerance,
            "cpu_s": median(seconds[code, tolerance]),
            "transforms": transforms,
            "error": float(np.abs(pressure - exact).mean() / exact.mean()),
        }


def _pressed(case: Case, tolerance: float) -> one_load.Pressed:
    with mock.patch.object(one_load, "TOLERANCE", tolerance):
        pressed = one_load.press(case.heights, case.load_nN, case.base())
    assert pressed.settled
    return pressed


def _ours(case: Case, tolerance: float) -> tuple[np.ndarray, float]:
    """Pressures, and transforms of the finest grid."""
    pressed = _pressed(case, tolerance)
    return pressed.pressure, pressed.transforms


def _peer(case: Case, tolerance: float) -> tuple[np.ndarray, float]:
    """Pressures by tamaas; it does not count its transforms."""
    model, solver = _solver(case, tolerance)
    solver.solve(case.pressure_GPa)
    return np.array(model.traction).reshape(case.heights.shape), np.nan


def _solver(case: Case, tolerance: float) -> tuple[Any, Any]:
    """Model and solver of tamaas."""
    import tamaas  # pyright: ignore[reportMissingImports]  (optional extra)

    tamaas.set_log_level(tamaas.LogLevel.error)
    side = case.settings.length_nm
    model = tamaas.Model(tamaas.model_type.basic_2d, [side, side], list(case.heights.shape))
    model.E = case.inputs.e_star
    model.nu = 0.0  # E / (1 - nu^2) = E*
    solver = tamaas.PolonskyKeerRey(model, -case.heights, tolerance)
    solver.max_iter = 5000
    if "alone" in case.what:
        tamaas.ModelFactory.registerNonPeriodic(model, "alone")
        solver.setIntegralOperator("alone")
    return model, solver


def _closing(case: Case) -> Iterator[dict[str, Any]]:
    """Rows of a closing by both codes."""
    start = time.process_time()
    cycle = run_cycle(
        case.inputs, case.settings, SEED, case.load_nN, case.heights, contact_at="lowest"
    )
    ours = time.process_time() - start
    forces = cycle.closing.repulsive_nN
    pressures = forces[forces > 0.0] / case.settings.length_nm**2
    start = time.process_time()
    model, solver = _solver(case, PEER_TOLERANCES[0])
    for pressure in pressures.tolist():
        solver.solve(pressure)
    peer = time.process_time() - start
    share = float((np.array(model.traction) > 0.0).mean())
    for code, seconds in (("asperity", ours), ("tamaas", peer)):
        yield {
            "pixels": case.settings.pixels,
            "what": case.what,
            "loads": pressures.size,
            "MPa": 1e3 * case.pressure_GPa,
            "share": share,
            "code": code,
            "tolerance": np.nan if code == "asperity" else PEER_TOLERANCES[0],
            "cpu_s": seconds,
            "transforms": np.nan,
            "error": np.nan,
        }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """How many times as long the peer takes, at least and at most: one load, closings."""
    ratios = {"one": [], "closing": []}
    cases: dict[tuple[str, ...], list[Mapping[str, str]]] = {}
    for row in rows:
        cases.setdefault((row["pixels"], row["what"], row["MPa"], row["loads"]), []).append(row)
    for (*_, loads), group in cases.items():
        peers = [row for row in group if row["code"] == "tamaas"]
        if not peers:
            continue
        peer = max(peers, key=lambda row: float(row["tolerance"]))
        ours = [row for row in group if row["code"] == "asperity"]
        if loads == "1":
            nearest = max(float(peer["error"]), min(float(row["error"]) for row in ours))
            ours = [row for row in ours if float(row["error"]) <= nearest]
        fastest = min(float(row["cpu_s"]) for row in ours)
        ratios["one" if loads == "1" else "closing"].append(float(peer["cpu_s"]) / fastest)
    return {
        f"{kind}_{end}": f"{pick(values):.0f}"
        for kind, values in ratios.items()
        if values
        for end, pick in (("least", min), ("most", max))
    }
