"""What does it change that attraction deforms the contact, and does every such contact settle?

The same surfaces by `coupled` and by `adhesive`: inputs drawn from Table 1 as in `contact.draws`, and D0 from 0.25 to
0.36 nm, as tops of atoms have it. Adhesive cycles are judged by the invariants of `mesoscale.contact.stability`, and
closed again.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from evidence.contact.draws import SECOND_LOSS, draw_cutoff, draw_inputs
from mesoscale.contact import Cycle, run_cycle
from mesoscale.contact.energy import dissipated_energy, pull_off
from mesoscale.contact.stability import violations
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
    """Pull-off of one draw by both mechanics, and the laws that its adhesive cycles break."""
    inputs = draw_inputs(number)
    cutoff = draw_cutoff(number)
    settings = ContactSettings(mechanics="adhesive", pixels=pixels, q1_per_nm=Q1_PER_NM, gap_cutoff_nm=cutoff)
    surface = random_surface(inputs, settings, number)

    def cycle(heights: np.ndarray | None, chosen: ContactSettings) -> Cycle:
        return run_cycle(inputs, chosen, number, heights=heights, contact_at="lowest", keep_surface=True)

    coupled = cycle(surface, settings.model_copy(update={"mechanics": "coupled"}))
    first = cycle(surface, settings)
    second = cycle(first.heights, settings)
    broken = [*violations(first, inputs, settings, surface), *violations(second, inputs, settings, first.heights)]
    again = dissipated_energy(second)[0] - float(second.flags["jump_loss_aJ"])
    share = again / dissipated_energy(first)[0]
    if abs(share) > SECOND_LOSS:
        broken.append(f"second cycle loses {share:.2g} of the first")
    return {
        "gap_cutoff_nm": cutoff,
        "tabor": first.flags["tabor"],
        "pull_off_coupled_nN": pull_off(coupled.opening),
        "pull_off_adhesive_nN": pull_off(first.opening),
        "jump_loss_aJ": first.flags["jump_loss_aJ"],
        "second_loss": share,
        "broken": "; ".join(broken),
    }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """How far the coupled contact overestimates pull-off."""
    finest = max(int(row["pixels"]) for row in rows)
    fine = [row for row in rows if int(row["pixels"]) == finest]
    coupled, adhesive = (
        np.array([float(row[f"pull_off_{name}_nN"]) for row in fine]) for name in ("coupled", "adhesive")
    )
    low, middle, high = np.quantile(coupled / adhesive - 1.0, (0.05, 0.5, 0.95))
    return {"overestimate": f"{middle:.0%} [{low:.0%}, {high:.0%}]"}
