"""Contact cycles on measured scans and on random surfaces of the same statistics, with the law fitted to each."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mesoscale.contact import Cycle, run_cycle
from mesoscale.inputs.contact import ContactInputs
from mesoscale.law.branches import Outcome, fit_cycle
from mesoscale.law.fit import row_of
from mesoscale.settings import ContactSettings, LawSettings, TopographySettings
from mesoscale.settings.contact import NOMINAL_SEED
from mesoscale.topography.analysis import trusted_scan
from mesoscale.topography.description import likelihood
from mesoscale.topography.description.parameters import MAX_MISFIT
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.pressing import surfaces
from mesoscale.topography.roughness_spectrum import RoughSpectrum


@dataclass(frozen=True)
class PressedSurface:
    """One surface of a scan, closed and opened; `surface` is a key of `SURFACES`."""

    scan: str
    surface: str
    pixels: int
    max_force_nN: float
    cycle: Cycle
    law: Outcome

    @property
    def description(self) -> dict[str, Any]:
        """What both branches share, as the attributes of curves/scans.h5 and the columns of law/scans.csv."""
        return {
            "surface": self.surface,
            "cell_area_nm2": self.cycle.cell_area_nm2,
            "pixels": self.pixels,
            "rms_nm": self.cycle.inputs.rms,
            "max_force_nN": self.max_force_nN,
            "converged": self.cycle.converged,
            "first_contact_nm": self.cycle.first_contact_nm,
        }

    def rows(self) -> list[dict[str, Any]]:
        """Rows of law/scans.csv, one per branch."""
        fits = {"closing": self.law.closing, "opening": self.law.opening}
        return [
            {"scan": self.scan, **self.description, "branch": branch, **row_of(fit)} for branch, fit in fits.items()
        ]


def press_scan(
    raw: Scan,
    fitted: RoughSpectrum,
    misfit: float,
    inputs: ContactInputs,
    settings: TopographySettings,
    contact: ContactSettings,
    law: LawSettings,
) -> Iterator[PressedSurface]:
    """Press the surfaces of one scan (see `surfaces`), each at its own RMS height.

    Parameters
    ----------
    raw : as loaded, before levelling.
    fitted, misfit : eq. 9 of all scans and how badly it fits them (1); above MAX_MISFIT this scan's own fit is used,
        if it has one.
    inputs : of the contact; RMS height and spectrum are replaced by those of the surfaces.
    """
    fit_of_scan = likelihood.fit([trusted_scan(raw, settings)]) if misfit > MAX_MISFIT else None
    if fit_of_scan is not None:  # None also where this scan does not determine a spectrum
        fitted = fit_of_scan.spectrum(math.inf)
    scan = clean(raw, settings)
    for surface, heights, chosen, force in surfaces(scan, fitted, settings, contact):
        scan_inputs = replace(inputs, rms=float(np.std(heights)))
        cycle = run_cycle(scan_inputs, chosen, NOMINAL_SEED, force, heights)
        outcome = fit_cycle(cycle, law)
        yield PressedSurface(scan.name, surface, chosen.pixels, force, cycle, outcome)
