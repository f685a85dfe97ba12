"""What does the contact-mechanics challenge give, with adhesion and without?

Müser et al. (Tribol. Lett. 65 (2017) 118) press a random surface (Hurst 0.8, waves from 0.1 to 20
um, RMS slope 1, cell of 0.1 mm) with 250 kPa on a half-space of 25 MPa; flats have 50 mJ/m2 and a
range of 2.071 nm. Its sites must be below 1.3 nm, so a cell is 0.64 um here and longer waves are
cut. It holds six of the shortest waves, so seeds scatter. The slope is 1 again, because area and
stress follow p / (E* h'); the gap belongs to the cut surface. The law is the offset one of equal
work and equal stress at touch, not an exponential.

Literature: without adhesion kappa = A E* h' / F is 2.2 at this load (Xu et al.,
doi:10.1007/s11249-024-01838-4) and 1.6 in Persson's theory, whose 95 % quantile of the stress is
1.22 E* h'. Adhesion makes the area 1 / (1 - S) times as large, S the stickiness of Pastewka and
Robbins (doi:10.1073/pnas.1320846111): their contacts keep their shape.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from evidence.contact.draws import MIDDLE
from evidence.record import load
from mesoscale.contact.attraction import EXCESS
from mesoscale.contact.coupled import validity
from mesoscale.contact.coupled.adhesive import AdhesiveContact
from mesoscale.settings import ContactSettings
from mesoscale.topography.synthesis import synthesize

E_STAR, PRESSURE, WORK_J_M2, RANGE_NM = 0.025, 2.5e-4, 0.05, 2.071  # GPa, GPa
SHORTEST_NM, HURST, SLOPE, PIXELS, SITE_NM, SEEDS = 100.0, 0.8, 1.0, 512, 1.25, (1, 2)
LAST_STEP, MISS = 1e-3, 5e-3  # over the roughness, and of the load: where closing ends


def rows(given: Any) -> Iterator[dict[str, Any]]:
    """A row for each surface, without adhesion and with it; those that the table has are not
    run.
    """
    known = {(int(row["seed"]), float(row["work_J_m2"])) for row in load("contact.challenge")}
    for seed, work_of in product(SEEDS, (0.0, WORK_J_M2)):
        if (seed, work_of) not in known:
            yield {"pixels": PIXELS, "site_nm": SITE_NM, "seed": seed, **_pressed(seed, work_of)}


def _pressed(seed: int, work_of: float) -> dict[str, Any]:
    """Close a surface to the load, by steps that never go beyond it."""
    length, d0 = PIXELS * SITE_NM, 2.0 * RANGE_NM
    heights = synthesize(
        PIXELS, length, 2 * np.pi / length, HURST, 1.0, seed, "areal", 2 * np.pi / SHORTEST_NM
    )
    heights *= SLOPE / validity.roughness(heights, length).slope
    settings = ContactSettings(
        mechanics="adhesive", model="elastic", pixels=PIXELS, length_nm=length, gap_cutoff_nm=d0
    )
    inputs = replace(MIDDLE, e_star=E_STAR, hamaker=12 * np.pi * d0**2 * work_of)
    contact = AdhesiveContact(heights, inputs, settings)
    load_nN, settled = PRESSURE * length**2, True
    at, step, net = contact.touching_separation, contact.rms / 4, 0.0
    while step > LAST_STEP * contact.rms and net < (1 - MISS) * load_nN:
        moved = contact.move_to(at - step, False)
        reached = moved.force + contact.attraction(at - step)
        if reached > load_nN:
            contact.back()
            step *= 0.5
        else:
            at, net, settled = at - step, reached, settled and moved.settled
    stress, gap = contact.fields()
    touches = gap <= 1e-6 * RANGE_NM
    touching = touches.mean() - EXCESS * sum(
        np.mean(touches != np.roll(touches, 1, axis)) for axis in (0, 1)
    )
    pressed = stress[stress > 0.0] / (E_STAR * SLOPE)
    return {
        "work_J_m2": work_of,
        "rms_nm": contact.rms,
        "load_share": net / load_nN,
        "touching": touching,
        "kappa": touching * E_STAR * SLOPE / (net / length**2),
        "mean_gap_nm": gap.mean(),
        "mean_stress": pressed.mean(),
        **{f"stress_{percent}": np.quantile(pressed, percent / 100) for percent in (5, 50, 95)},
        "tension_share": np.mean(stress < -0.01 * WORK_J_M2 / RANGE_NM),
        "stickiness": validity.adhesion_numbers(
            inputs.hamaker, settings, E_STAR, contact.roughness
        )["stickiness"],
        "settled": settled,
    }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Means over the surfaces that were pressed both without adhesion and with it."""
    pulled = {row["seed"] for row in rows if row["work_J_m2"] != "0"}

    def mean(column: str, adhesive: bool = False) -> float:
        kept = [
            row for row in rows if row["seed"] in pulled and (row["work_J_m2"] != "0") == adhesive
        ]
        return float(np.mean([float(row[column]) for row in kept]))

    kappas = [float(row["kappa"]) for row in rows if row["work_J_m2"] == "0"]
    named = {
        "area": ("touching", ".1%"),
        "gap": ("mean_gap_nm", ".0f"),
        "stress": ("stress_95", ".2f"),
    }
    return {
        **{name: format(mean(column), form) for name, (column, form) in named.items()},
        **{
            f"{name}_adhesive": format(mean(column, True), form)
            for name, (column, form) in named.items()
        },
        "kappa": f"{min(kappas):.1f} to {max(kappas):.1f}",
        "grown": f"{mean('touching', True) / mean('touching'):.1f}",
        "grown_theory": f"{1 / (1 - mean('stickiness', True)):.1f}",
    }
