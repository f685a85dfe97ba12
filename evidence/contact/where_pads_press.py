"""What does a closing-opening cycle cost where pads press, in pairs of FFTs of its own grid and
beside a peer?

A pair (there and back, double precision) is timed after every step of the cycle, so that the unit
has the load of the machine. Film: the medians of scene `reduced` at 40 MPa. Table 1: the paper's
means, 7 MPa, sites of 1 nm. Shares: a smooth elastic surface closed to a share of contact. tamaas
solves one elastic load at the largest force; its time is multiplied by the rows of the cycle. Needs
`pip install tamaas` for the ratio. With `--choices` each numerical choice of the solver is tried,
or those of a name: the largest error of a net force, over the largest force.
"""

import argparse
import importlib.util
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any
from unittest import mock

import numpy as np
from scipy import fft

from evidence.contact.draws import MIDDLE
from evidence.contact.half_space import by_tamaas
from mesoscale.contact import ContactInputs, run_cycle
from mesoscale.contact.coupled import dense, grid
from mesoscale.contact.coupled.engine import CoupledContact
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.contact.surface import random_surface
from mesoscale.inputs.contact import FilmInputs
from mesoscale.settings import ContactSettings

SEED = 1
FILM = FilmInputs(
    hamaker=0.215,
    e_star=90.3,
    h_macro=1.95,
    h_prime=0.0,
    q0=0.025,
    hurst=0.42,
    rms=4.95,
    h_film=9.94,
    t_film=5.0,
    k_film=0.074,
    m_film=2.3,
    rms_scatter=0.29,
)
FILM_CELL = {"length_nm": 1000.0, "q1_per_nm": 0.2895, "gap_cutoff_nm": 0.285}
SMOOTH = replace(MIDDLE, rms=2.0, q0=0.015)
SMOOTH_CELL = {"length_nm": 1000.0, "q1_per_nm": 0.1}
CHOICES = (  # the first is the reference
    *((CoupledContact, "GRID_TOLERANCE", value) for value in (1e-10, 1e-8, 1e-7, 5e-7, 1e-6, 1e-5)),
    *((CoupledContact, "DENSE", value) for value in (0, 512, 1024, 2048)),
    *((grid, "DIRECT_PER_PIXEL", value) for value in (0, 2, 4)),
    *((grid, "TABLE_SHARE", value) for value in (0.0, 0.5, 3.0)),
    (grid.Grid, "stencil", np.eye(9)[4]),  # conjugate gradients without preconditioner
)
ADHESIVE = {"mechanics": "adhesive", "gap_cutoff_nm": 0.3, "q1_per_nm": 0.4}


@dataclass(frozen=True)
class Case:
    """A cycle: its name, inputs, settings, largest mean pressure (MPa) and steps of force."""

    name: str
    inputs: ContactInputs
    settings: ContactSettings
    stress_MPa: float
    numerics: Numerics = NUMERICS


def cases(pixels: int) -> Iterator[Case]:
    """All cycles on a grid."""
    for model in ("elastic", "plastic"):
        film = ContactSettings(pixels=pixels, mechanics="coupled", model=model, **FILM_CELL)
        if pixels <= 1024:
            yield Case(f"film {model}", FILM, film, 40.0)
        coarse = ContactSettings(
            pixels=pixels, mechanics="coupled", model=model, length_nm=float(pixels)
        )
        yield Case(f"Table 1 {model}", MIDDLE, coarse, 7.0)
    smooth = ContactSettings(pixels=pixels, mechanics="coupled", model="elastic", **SMOOTH_CELL)
    for stress in (15.0, 140.0, 550.0) if pixels <= 512 else ():
        yield Case(f"smooth elastic {stress:g} MPa", SMOOTH, smooth, stress)
    if pixels <= 512:
        yield Case(
            "adhesive",
            MIDDLE,
            ContactSettings(pixels=pixels, **ADHESIVE),
            7.0,
            Numerics(force_steps=20),
        )


def arguments(parser: argparse.ArgumentParser) -> None:
    """What is timed."""
    parser.add_argument("--pixels", type=int, nargs="+", default=[256, 512, 1024, 2048])
    parser.add_argument("--only", default="", help="what has these words in its name")
    parser.add_argument("--no-peer", action="store_true", help="without tamaas")
    parser.add_argument(
        "--choices", nargs="?", const="", help="of the solver, instead; those with this in a name"
    )


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each grid and cycle; printed as it comes."""
    if given.choices is not None:
        yield from _choices(given)
        return
    peer = importlib.util.find_spec("tamaas") and not given.no_peer
    for case in cases(128):  # all is compiled, or loaded
        if given.only in case.name and case.name != "adhesive":
            _timed(case)
    for pixels in given.pixels:
        for case in cases(pixels):
            if given.only in case.name:
                row = {
                    "pixels": pixels,
                    "what": case.name,
                    "MPa": case.stress_MPa,
                    **_timed(case)[0],
                }
                if peer and case.settings.model == "elastic":
                    row |= _beside(case, row)
                print(*row.values(), flush=True)
                yield row


def _choices(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each choice on each surface; the error is over the largest force."""
    for case in (case for pixels in given.pixels for case in cases(pixels)):
        if given.only not in case.name or case.name == "adhesive":
            continue
        exact = None
        for owner, name, value in CHOICES:
            if exact is not None and given.choices not in name:
                continue
            with mock.patch.object(owner, name, value):
                row, forces = _timed(case)
            exact = forces if exact is None else exact
            what = f"{case.name}, {name} = {value}"
            row = {"pixels": case.settings.pixels, "what": what, "MPa": case.stress_MPa, **row}
            yield row | {"error": float(np.abs(forces - exact).max() / exact.max())}


def _surface(case: Case) -> np.ndarray:
    return random_surface(case.inputs, case.settings, SEED)


def _force_nN(case: Case) -> float:
    return 1e-3 * case.stress_MPa * case.settings.length_nm**2


def _timed(case: Case) -> tuple[dict[str, Any], np.ndarray]:
    """Seconds of a cycle, less those of the pairs that are its unit, and what it counted; its net
    forces (nN).
    """
    heights, pairs, newton = _surface(case), [], []
    # freed at once, after which as much stays with the process: no pair waits for pages
    np.empty(31 << 20, np.uint8)
    noise = np.random.default_rng(SEED).standard_normal(heights.shape)

    def pair(_: Any) -> None:
        start = time.process_time()
        fft.irfft2(np.asarray(fft.rfft2(noise)), s=noise.shape)
        pairs.append(time.process_time() - start)

    every = (
        after(CoupledContact, "move_to", pair),
        after(dense, "solve", lambda done: newton.append(done[0])),
        after(grid, "solve", lambda done: newton.append(done[0])),
    )
    with every[0], every[1], every[2]:
        start = time.process_time()
        force = _force_nN(case)
        cycle = run_cycle(
            case.inputs,
            case.settings,
            SEED,
            force,
            heights,
            contact_at="lowest",
            numerics=case.numerics,
        )
        seconds = time.process_time() - start - sum(pairs)
    return {
        "share": cycle.closing.contact_area_nm2.max() / cycle.cell_area_nm2,
        "rows": len(cycle.closing.net_nN) + len(cycle.opening.net_nN),
        "steps": len(pairs),
        "newton": sum(newton),
        "cpu_s": seconds,
        "pair_ms": 1e3 * float(np.mean(pairs)),
        "pairs": seconds / float(np.mean(pairs)),
        "converged": cycle.converged,
        "peer_load_s": np.nan,
        "times_peer": np.nan,
        "error": np.nan,
    }, np.concatenate((cycle.closing.net_nN, cycle.opening.net_nN))


@contextmanager
def after(owner: Any, name: str, work: Callable[[Any], None]) -> Iterator[None]:
    """Do some work with what a function returns."""
    function = getattr(owner, name)

    def both(*of: Any) -> Any:
        done = function(*of)
        work(done)
        return done

    with mock.patch.object(owner, name, both):
        yield


def _beside(case: Case, row: Mapping[str, Any]) -> dict[str, float]:
    """Seconds of one load by tamaas, and how many times the cycle's those of all its rows are."""
    start = time.process_time()
    by_tamaas(
        _surface(case), case.settings.length_nm, _force_nN(case), case.inputs.e_star, tolerance=1e-6
    )
    seconds = time.process_time() - start
    return {"peer_load_s": seconds, "times_peer": seconds * row["rows"] / row["cpu_s"]}


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Pairs and seconds of each cycle, by its name and grid."""
    found = {}
    for row in (row for row in rows if row["error"] == "nan"):
        name = f"{row['what'].replace(' ', '_')}_{row['pixels']}"
        found |= {name: f"{float(row['pairs']):.0f}", f"{name}_s": f"{float(row['cpu_s']):.2g}"}
    return found
