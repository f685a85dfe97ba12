"""What does it change that attraction deforms the contact?

The same surfaces by `coupled` and by `adhesive`: inputs and D0 drawn as in `contact.draws`, which
also judges them.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from evidence.contact.draws import draw_cutoff, draw_inputs
from mesoscale.contact import run_cycle
from mesoscale.contact.energy import pull_off
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

GRIDS = (256, 512)
Q1_PER_NM = 0.4


def arguments(parser: argparse.ArgumentParser) -> None:
    """Which draws, and on which grid."""
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--draws", type=int, default=100)
    parser.add_argument("--pixels", type=int, default=GRIDS[-1], choices=GRIDS)


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each draw."""
    for number in range(given.first, given.first + given.draws):
        yield {"pixels": given.pixels, "draw": number, **_judged(number, given.pixels)}


def _judged(number: int, pixels: int) -> dict[str, Any]:
    """Pull-off of one draw by both mechanics."""
    inputs = draw_inputs(number)
    cutoff = draw_cutoff(number)
    settings = ContactSettings(
        mechanics="adhesive", pixels=pixels, q1_per_nm=Q1_PER_NM, gap_cutoff_nm=cutoff
    )
    surface = random_surface(inputs, settings, number)
    cycle = partial(run_cycle, inputs, seed=number, heights=surface, contact_at="lowest")
    coupled = cycle(settings.model_copy(update={"mechanics": "coupled"}))
    adhesive = cycle(settings)
    return {
        "gap_cutoff_nm": cutoff,
        "tabor": adhesive.flags["tabor"],
        "pull_off_coupled_nN": pull_off(coupled.opening),
        "pull_off_adhesive_nN": pull_off(adhesive.opening),
        "jump_loss_aJ": adhesive.flags["jump_loss_aJ"],
    }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """How far the coupled contact overestimates pull-off."""
    finest = max(int(row["pixels"]) for row in rows)
    fine = [row for row in rows if int(row["pixels"]) == finest]
    coupled, adhesive = (
        np.array([float(row[f"pull_off_{name}_nN"]) for row in fine])
        for name in ("coupled", "adhesive")
    )
    low, middle, high = np.quantile(coupled / adhesive - 1.0, (0.05, 0.5, 0.95))
    return {"overestimate": f"{middle:.0%} [{low:.0%}, {high:.0%}]"}
