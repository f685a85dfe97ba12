"""By how many volts of the hold does a switch charge ten times as fast, and what has a say in it?

A pad of few cells is pressed at the central inputs of a scene, whose inputs are there. Its RMS
height is that of the scene, and a part of it. Rates are the three guesses of the defaults, of all
places, of those that touch, and of those that do not. Published lives of capacitive switches
shorten ten times for 5 to 7 V.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from mesoscale.answer.points import on_pad_grid
from mesoscale.answer.switches import solve_point, surfaces_of
from mesoscale.charging.gaps import GAPS_NM
from mesoscale.charging.lifetime import HOLDS, SHIFTED_V, SwitchLife, life_of, volts_a_decade
from mesoscale.charging.rates import guesses, shifts_V
from mesoscale.inputs.table import film_table, from_rows
from mesoscale.settings import LifetimeSettings
from workflow.files.results import load_csv, load_json
from workflow.run.contact_settings import contact_settings
from workflow.run.pads import ScenePoints
from workflow.scene import load_scene

SETTINGS = LifetimeSettings(years=10.0)
TIMES_S = np.geomspace(1e-15, 1e12, 271)
PLACES = {"all": slice(None), "touching": slice(0, 1), "gaps": slice(1, None)}


def arguments(parser: ArgumentParser) -> None:
    """Results to take inputs from."""
    parser.add_argument("results", nargs="+", type=Path)
    parser.add_argument("--cells", type=int, default=8)
    parser.add_argument("--rms", nargs="+", type=float, default=[1.0, 0.5])


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each film, guess and kind of place."""
    for folder in given.results:
        for part in given.rms:
            life = _life(folder, given.cells, part)
            same = {
                "scene": folder.name,
                "rms_part": part,
                "hold_V": life.hold_V,
                "separation_nm": life.gaps.middle_nm,
                "touching": life.gaps.touching,
                "contact_factor": life.gaps.contact_factor,
            }
            for guess, rates in guesses(SETTINGS).items():
                for name, places in PLACES.items():
                    holds = HOLDS * life.hold_V
                    times = [_time_s(life, volts, rates, places) for volts in holds.tolist()]
                    volts_rows = [
                        {"hold_V": volts, "time_to_1V_s": time}
                        for volts, time in zip(holds.tolist(), times, strict=True)
                    ]
                    at = {
                        f"volts_a_decade_at_{share:g}": volts_a_decade(
                            volts_rows, share * life.hold_V
                        )
                        for share in (0.5, 1.0)
                    }
                    yield {**same, "guess": guess, "places": name, **at}


def _life(folder: Path, cells: int, part: float) -> SwitchLife:
    """The central switch with a part of the RMS height of its scene."""
    scene = load_scene(folder.name)
    described = folder / "topography" / "parameters.json"
    inputs = SimpleNamespace(input={"topography": described} if described.exists() else {})
    contact = contact_settings(scene.contact.model_dump(mode="json"), inputs)
    film = load_json(described)["film"] if described.exists() else {}
    table = film_table(from_rows(load_csv(folder / "inputs.csv")), film, scene.pad.rms_scatter)
    point = ScenePoints(table, contact, scene.device, 0).by_number[0]
    lower = replace(point, values={**point.values, "rms": part * point.values["rms"]})
    on_grid = on_pad_grid(contact, table)
    solved = solve_point(lower, on_grid, cells, surfaces_of(0))
    return life_of(solved, on_grid, 0, SETTINGS)


def _time_s(life: SwitchLife, hold_V: float, rates: Any, places: slice) -> float | None:
    """Time in which the mean shift of these places has grown to `SHIFTED_V`."""
    shares = life.gaps.shares[:-1][places]
    shifts = shifts_V(hold_V, GAPS_NM[places], TIMES_S, life.gaps.device, SETTINGS, rates)
    mean = np.tensordot(shares, shifts, 1) / shares.sum()
    if mean[-1] < SHIFTED_V:
        return None
    return float(
        np.exp(np.interp(np.log(SHIFTED_V), np.log(np.maximum(mean, 1e-30)), np.log(TIMES_S)))
    )


def figures(rows: list[dict[str, str]]) -> dict[str, str]:
    """Volts a decade of the central guess, by film."""
    said = {}
    for row in rows:
        if row["guess"] == "central" and row["places"] == "all":
            film = row["scene"] if float(row["rms_part"]) == 1.0 else f"{row['scene']}_smoother"
            said[f"{film}_held"] = f"{float(row['volts_a_decade_at_1']):.1f} V"
            said[f"{film}_half"] = f"{float(row['volts_a_decade_at_0.5']):.1f} V"
            said[f"{film}_factor"] = f"{float(row['contact_factor']):.2f}"
            said[f"{film}_hold"] = f"{float(row['hold_V']):.0f} V"
    return said
