"""Electrical resistance of a rough contact, by its incremental stiffness (docs/resistance.md).

Current through the spots of a contact obeys the equations of a small further approach of its two elastic bodies:

    1 / R = 2 / (E* (rho_1 + rho_2)) dF / d(delta)

for any shape and number of spots (Barber, Proc. R. Soc. A 459 (2003) 53). The approach delta is that of the mean
planes. The further approach is elastic: where asperities flow, its slope is that of the way back. Contact grows with
the force, so that the force is convex in delta, and its slope lies between those of the chords to both sides.

Spots that are narrow beside the mean free path l of electrons resist more. Of a round spot of radius a between equal
metals (Wexler, Proc. Phys. Soc. 89 (1966) 927), with Holm's resistance first and Sharvin's last:

    R = gamma(l / a) rho / (2 a) + 4 rho l / (3 pi a^2)

Sharvin's part depends on the area of contact alone, also of many spots. In gamma, a is the radius of equal, distant
spots that together have this area and this resistance of Barber's.

A film's resistance is added as if each spot had one potential, which is the least that spots and film have together;
for one spot that is a film of its own, a twelfth of the spot's own resistance is missing at most (Holm, Electric
Contacts, 1967: 0.27 rho / a at uniform current, 0.25 at one potential).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact import Cycle, run_cycle
from mesoscale.contact.cycle import Branch
from mesoscale.device.numerics import SWITCH
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs, contact_of
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.memory import rows_at
from mesoscale.settings import ContactSettings, ResistanceSettings
from mesoscale.uncertainty.designs import random_runs

Array = NDArray[np.float64]

LEVELS = 8
"""Forces at which the resistance is given, each twice the last."""


@dataclass(frozen=True)
class Stiffness:
    """Incremental stiffness of a contact on an elastic way.

    Attributes
    ----------
    force_nN : rising, shape (n,), as all that follows.
    area_nm2 : of contact.
    approach_nm : of the mean planes.
    slope : dF/d(delta), N/m.
    """

    force_nN: Array
    area_nm2: Array
    approach_nm: Array
    slope: Array


def stiffness_of(branch: Branch) -> Stiffness:
    """Stiffness along an opening, or along a closing on which nothing flows.

    The force is straight in the approach while the same sites touch. So where a neighbouring step has the same area,
    the chord to it is the slope; elsewhere that of a parabola through three steps stands for it.
    """
    up = np.argsort(branch.separation_nm)[::-1]
    force, approach, area = branch.repulsive_nN[up], -branch.separation_nm[up], branch.contact_area_nm2[up]
    kept = (force > 0) & (np.diff(approach, prepend=-np.inf) > 0)
    force, approach, area = force[kept], approach[kept], area[kept]
    slope = np.gradient(force, approach, edge_order=2)
    chords, same = np.diff(force) / np.diff(approach), np.diff(area) == 0
    slope[:-1][same], slope[1:][same] = chords[same], chords[same]
    return Stiffness(force, area, approach, slope)


def diffusive_share(knudsen: Array) -> Array:
    """What is left of Holm's resistance of a spot of radius a where electrons fly `knudsen` = l / a, Wexler's gamma.

    As Nikolic and Allen (Phys. Rev. B 60 (1999) 3963) fit it to Boltzmann's equation. Electrons followed one by one
    give a resistance that is up to 4 % higher (tests/mesoscale/device/test_resistance.py).
    """
    return (1.0 + 0.83 * knudsen) / (1.0 + 1.33 * knudsen)


def resistance_Ohm(slope: Array, area_nm2: Array, e_star_GPa: float, settings: ResistanceSettings) -> Array:
    """Resistance (Ohm) of a contact of stiffness `slope` (N/m) and of its film; any shape."""
    if settings.resistivities_nOhm_m is None or settings.mean_free_paths_nm is None:
        raise InputError("resistance.resistivities_nOhm_m = null: give the resistivities of the two bodies in nOhm m")
    radius_nm = 2.0 * area_nm2 * e_star_GPa / (np.pi * slope)  # GPa nm^2 over N/m is nm
    ohm: Array = settings.film_Ohm_um2 / (area_nm2 * 1e-6)
    for resistivity, path_nm in zip(settings.resistivities_nOhm_m, settings.mean_free_paths_nm, strict=True):
        # of one body; GPa nOhm m over N/m is Ohm, and so is nOhm m nm over nm^2
        ohm = ohm + diffusive_share(path_nm / radius_nm) * e_star_GPa * resistivity / (2.0 * slope)
        ohm = ohm + 2.0 * resistivity * path_nm / (3.0 * area_nm2)
    return ohm


def resistance_rows(
    table: InputTable,
    contact: ContactSettings,
    settings: ResistanceSettings,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[dict[str, Any]]:
    """Rows of device/resistance.csv: each surface at `LEVELS` forces while it closes, opens and closes again.

    Raises
    ------
    InputError : no resistivities, or too many surfaces that cannot be computed.
    """
    runs, failed = random_runs(table, 0, settings.runs), []
    for run in runs:
        inputs, chosen = contact_of(run.values, contact)
        try:
            ways = _ways(inputs, chosen, run.seed)
        except (InputError, ArithmeticError) as error:
            failed.append(str(error))
            if len(failed) > (1.0 - SWITCH.solved) * len(runs):
                raise InputError(f"resistance: of {len(runs)} surfaces, {len(failed)} failed: {failed[-1]}") from None
            continue
        for way, (force, slope, area) in ways.items():
            ohm = resistance_Ohm(slope, area, inputs.e_star, settings)
            for row in np.stack([force, slope, area, ohm], axis=1).tolist():
                names = ("force_nN", "stiffness_N_per_m", "contact_area_nm2", "resistance_Ohm")
                yield {"run": run.index, "seed": run.seed, "way": way, **dict(zip(names, row, strict=True))}
        if progress:
            progress((run.index + 1) / len(runs), f"{run.index + 1} of {len(runs)} surfaces")


def _ways(inputs: ContactInputs, contact: ContactSettings, seed: int) -> dict[str, Array]:
    """Force, stiffness (N/m) and area (nm2) of a surface that closes, opens and closes again; shape (3, levels)."""
    forces: Array = np.array([contact.max_force_nN / 2.0**k for k in reversed(range(LEVELS))])
    openings, cycle = [], None
    for force in [*forces, *forces]:
        cycle = _closed(inputs, contact, seed, float(force), cycle)
        way = stiffness_of(cycle.opening)
        openings.append(np.stack([way.force_nN, way.slope, way.area_nm2]))
    ends = np.stack([opening[:, -1] for opening in openings], axis=1)
    opened = rows_at(forces, openings[LEVELS - 1][0], openings[LEVELS - 1])
    return {"closing": ends[:, :LEVELS], "opening": opened, "closing again": ends[:, LEVELS:]}


def _closed(inputs: ContactInputs, contact: ContactSettings, seed: int, force_nN: float, before: Cycle | None) -> Cycle:
    """A cycle up to a force, on the surface that the cycle before left."""
    if before is None:
        cycle = run_cycle(inputs, contact, seed, force_nN, keep_surface=True)
    else:
        cycle = run_cycle(inputs, contact, seed, force_nN, before.heights, contact_at="lowest", keep_surface=True)
    if not cycle.converged:
        raise InputError(f"a contact of {force_nN:.4g} nN did not settle")
    return cycle
