"""One closing-opening cycle of a rough contact: the entry point of the mesoscale model."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mesoscale.checks import check_memory, check_number, check_seed
from mesoscale.contact.engines import contact_on
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.contact.path import open_again, trace
from mesoscale.contact.pressed import Contact, Row
from mesoscale.contact.surface import ContactAt, given_surface, random_surface
from mesoscale.errors import InputError
from mesoscale.extras import needs
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings

SMALLEST_FORCE_NN, LARGEST_FORCE_NN = 1e-9, 1e12


@dataclass(frozen=True, repr=False)
class Branch:
    """One branch of a force-separation curve; arrays of one length, in the order of traversal.

    Attributes
    ----------
    separation_nm : from the surface's mean plane to the flat.
    attractive_nN : attraction is negative.
    contact_area_nm2 : number of contacting sites times the area of a site.
    sweeps : flow sweeps of the step that ends here.
    """

    separation_nm: np.ndarray
    repulsive_nN: np.ndarray
    attractive_nN: np.ndarray
    contact_area_nm2: np.ndarray
    asperities: np.ndarray
    sweeps: np.ndarray

    def __repr__(self) -> str:
        first, last = self.separation_nm[[0, -1]]
        return f"Branch of {len(self.separation_nm)} separations, from {first:.4g} to {last:.4g} nm"

    @property
    def net_nN(self) -> np.ndarray:
        """Repulsion and attraction together, nN; negative where the contact pulls."""
        return self.repulsive_nN + self.attractive_nN

    def to_frame(self) -> Any:
        """A pandas DataFrame with a row a step, and the units in `attrs["units"]`."""
        with needs("plot"):
            import pandas as pd
        frame = pd.DataFrame({name: getattr(self, name) for name in BRANCH_COLUMNS})
        frame.attrs["units"] = {name: unit for name, (unit, _) in BRANCH_COLUMNS.items()}
        return frame


BRANCH_COLUMNS = {
    "separation_nm": ("nm", "mean separation"),
    "repulsive_nN": ("nN", "repulsive force"),
    "attractive_nN": ("nN", "attractive force (negative)"),
    "contact_area_nm2": ("nm^2", "area of contacting sites"),
    "asperities": ("1", "number of asperities in contact"),
    "sweeps": ("1", "flow sweeps of the step"),
}
"""Unit and long name of each array of a `Branch`, as result files state them."""


@dataclass(frozen=True, repr=False)
class Cycle:
    """Closing and opening of one surface.

    Attributes
    ----------
    first_contact_nm : separation at which the surface first touches on closing.
    last_contact_nm : separation at which it last touches on opening.
    converged : every step converged and the requested force was reached within 1 %.
    length_nm : side of the surface.
    heights : (N, N) surface afterwards, nm, with contact at the lowest (only if asked for).
    """

    closing: Branch
    opening: Branch
    first_contact_nm: float
    last_contact_nm: float
    flags: dict[str, int | bool | str | float]
    converged: bool
    inputs: ContactInputs
    length_nm: float
    heights: np.ndarray | None = None

    def __repr__(self) -> str:
        text = (
            f"Cycle up to {self.closing.repulsive_nN[-1]:.4g} nN: first touches at"
            f" {self.first_contact_nm:.4g} nm, last at {self.last_contact_nm:.4g} nm"
        )
        if self.converged:
            return text
        if self.flags.get("full_contact"):
            return f"{text}; NOT CONVERGED: full contact"
        return f"{text}; NOT CONVERGED"

    def to_frame(self) -> Any:
        """Both branches as one pandas DataFrame; the column `branch` is closing or opening."""
        with needs("plot"):
            import pandas as pd
        branches = {"closing": self.closing.to_frame(), "opening": self.opening.to_frame()}
        frame = pd.concat(branches, names=["branch", "step"]).reset_index(level="branch")
        frame.attrs["units"] = branches["closing"].attrs["units"]
        return frame

    def plot(self) -> Any:
        """Force against separation, and the share in contact against the load, as a Matplotlib
        figure.
        """
        with needs("plot"):
            import matplotlib.pyplot as plt
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
        for name in ("closing", "opening"):
            branch = getattr(self, name)
            left.plot(branch.separation_nm, branch.net_nN, label=name)
            share = branch.contact_area_nm2 / self.cell_area_nm2
            right.plot(branch.repulsive_nN, 100.0 * share, label=name)
        reach = self.first_contact_nm - self.closing.separation_nm.min()
        left.set(
            xlim=(None, self.first_contact_nm + 0.5 * reach),  # beyond, only attraction fades
            xlabel="separation from the mean plane (nm)",
            ylabel="net force (nN)",
        )
        right.set(xlabel="repulsive force (nN)", ylabel="in contact (%)")
        left.legend()
        return figure

    @property
    def cell_area_nm2(self) -> float:
        """Area of the surface in its mean plane, nm^2."""
        return self.length_nm**2


def check_hardness(inputs: ContactInputs, settings: ContactSettings) -> None:
    """Refuse a material that yields at no pressure at all, of which no contact carries a force.

    Raises
    ------
    InputError
    """
    if settings.model != "elastic" and inputs.hardness.pressure(settings.length_nm**2) <= 0.0:
        raise InputError(
            f"h_macro = {inputs.h_macro:g} GPa: the surface would carry nothing; give its hardness,"
            " or take model: elastic (asp.press: h_macro=None)"
        )


MAX_FORCE_MISS = 0.01
"""Relative distance from the requested force beyond which a cycle is not converged."""


def run_cycle(
    inputs: ContactInputs,
    settings: ContactSettings,
    seed: int,
    max_force_nN: float | None = None,
    heights: np.ndarray | None = None,
    length_nm: float | None = None,
    keep_surface: bool = False,
    hold: Callable[[Contact, Row], list[Row]] | None = None,
    numerics: Numerics = NUMERICS,
    contact_at: ContactAt | None = None,
) -> Cycle:
    """Close a rough surface onto a flat up to a force, and open it again.

    Parameters
    ----------
    inputs, settings
        Physical inputs, and model readings and resolution.
    seed
        Noise of the surface: the same seed gives the same noise whatever the inputs and the grid.
    max_force_nN
        Repulsive force at which closing ends; default `settings.max_force_nN`. A plastic contact
        ends closing at 0.8 H(L^2) L^2 if this is less, where the whole cell is one contact, and is
        not converged.
    heights
        (N, N) surface in nm to use instead of a random one, for instance `Cycle.heights` of an
        earlier cycle; it is not changed. Without `length_nm` its grid must be `settings.pixels`.
    length_nm
        Side of `heights` in nm; default `settings.length_nm`.
    keep_surface
        Return the surface as it is after the cycle.
    hold
        What happens between closing and opening (`mesoscale.history.creep`): takes the contact
        and its last row, returns the rows that follow at the end of the closing branch.
    numerics
        How finely the contact is computed; the default is what every scene uses.
    contact_at
        Which of `heights` touch the flat first. Measured heights touch at their highest; those of
        `random_surface`, `contacting_heights` and `Cycle.heights` at their lowest.

    Raises
    ------
    InputError
        For a surface beyond memory, heights without `contact_at` or that are not a square of real,
        finite numbers in nm on the stated side, a force that is not positive, or a seed that is no
        whole number.
    """
    plastic = settings.model == "plastic"
    check_seed(seed)
    force = max_force_nN
    if force is None:
        force = settings.max_force_nN
    check_number("max_force_nN", force, SMALLEST_FORCE_NN, LARGEST_FORCE_NN, "nN")
    surface, settings = given_surface(heights, length_nm, contact_at, settings)
    check_memory(settings.pixels**2, settings.mechanics)
    check_hardness(inputs, settings)
    if surface is None:
        surface = random_surface(inputs, settings, seed)
    elif plastic:
        surface = surface.copy()
    contact = contact_on(surface, inputs, settings, numerics)
    capacity = contact.capacity
    first_contact = contact.touching_separation
    approach = []
    for gap in contact.gaps_apart_nm[::-1]:
        approach += contact.way(first_contact + gap)
    closing = trace(contact, numerics.force_steps, plastic, stop_force=min(force, capacity))
    reached = closing.reached and force <= capacity
    miss = abs(closing.rows[-1].force - force) / force
    if hold is not None:
        closing.rows += hold(contact, closing.rows[-1])
    last = closing.rows[-1]
    changed = contact.changed_sites
    remarks = contact.remarks()
    if contact.adhesion and contact.adhesion.menisci:
        remarks["filled_share"] = contact.filled_share(last.separation)
    back = open_again(contact, closing, approach, numerics.force_steps)
    if not all(np.isfinite(row.force) for row in back.touching):
        raise InputError(
            f"max_force_nN = {force:.4g}: pressed to {last.force:.4g} nN almost the whole cell"
            " touches, and how it opens again is not found; lower it"
        )
    if not contact.REVERSIBLE:
        remarks["jump_loss_aJ"] = float(contact.lost)
    unconverged = closing.unconverged + back.unconverged
    last_contact = first_contact
    if last.force > 0:
        last_contact = back.touching[-1].separation
    flags = {
        "force_reached": reached,
        "force_miss": abs(last.force - force) / force,
        "unconverged_steps": unconverged,
        "largest_load": closing.load,
        "full_contact": closing.full or (settings.model == "elastic" and force > capacity),
        "radius_bound_events": closing.bounds,
        "repeated_steps": closing.repeated + back.repeated,
        "changed_sites": changed,
        "repulsion_drop": _largest_drop([row.force for row in closing.rows]),
        **remarks,
    }
    return Cycle(
        closing=_branch(contact, [*approach, *closing.rows]),
        opening=_branch(contact, [*back.touching, *back.apart]),
        first_contact_nm=first_contact + contact.offset,
        last_contact_nm=last_contact + contact.offset,
        flags=flags,
        converged=reached and miss <= MAX_FORCE_MISS and unconverged == 0,
        inputs=inputs,
        length_nm=settings.length_nm,
        heights=surface if keep_surface else None,
    )


def _largest_drop(forces: list[float]) -> float:
    """Largest fall of a force below an earlier value, as a share of its largest value."""
    highest = np.maximum.accumulate(forces)
    if highest[-1] <= 0:
        return 0.0
    return float((highest - forces).max() / highest[-1])


def _branch(contact: Contact, rows: list[Row]) -> Branch:
    separation, force, attraction, sites, asperities, sweeps = zip(*rows, strict=True)
    separation = np.array(separation) + contact.offset
    area = np.array(sites) * contact.site_area
    return Branch(
        separation_nm=separation,
        repulsive_nN=np.array(force),
        attractive_nN=np.array(attraction),
        contact_area_nm2=area,
        asperities=np.array(asperities),
        sweeps=np.array(sweeps),
    )
