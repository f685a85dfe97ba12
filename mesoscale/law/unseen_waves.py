"""What waves that no instrument saw do to the contact: the same random surfaces with them and without."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from mesoscale.contact import run_cycle
from mesoscale.contact.energy import pull_off
from mesoscale.contact.surface import shortest_wave, surface_spectrum
from mesoscale.inputs.contact import ContactInputs
from mesoscale.law.branches import fit_cycle
from mesoscale.settings import ContactSettings, LawSettings

SURFACES = 8
SITES = 512  # a side at most: the share is a matter of the waves, not of the last site
COLUMNS = ("quantity", "unit", "seen_q", "end_q", "seen", "all", "shift", "share")
UNITS = {"first_contact": "nm", "area": "nm^2", "C_r": "GPa", "pull_off": "nN"}


def unseen_shares(
    inputs: ContactInputs, contact: ContactSettings, law: LawSettings, seen: float
) -> Iterator[dict[str, Any]]:
    """Rows of topography/unseen.csv: what the waves beyond `seen` (1/nm) do to what is computed.

    Surfaces of the same noise end once at `seen` and once where those of the contact end: at q1, or at what the grid
    holds. The truth lies anywhere between none of these waves and all as extrapolated. `shift` is the relative change
    that all of them make; `share` is the part of the variance of ln(quantity), beside that from surface to surface,
    which this leaves (a uniform distribution over the shift).
    """
    contact = contact.model_copy(update={"pixels": min(contact.pixels, SITES)})
    if contact.q1_per_nm and contact.q1_per_nm > contact.nyquist_per_nm:
        contact = contact.model_copy(update={"q1_per_nm": None})
    end = shortest_wave(contact)
    seen = min(seen, end)
    psd = surface_spectrum(inputs, contact)
    shorter = contact.model_copy(update={"q1_per_nm": seen})
    lower = replace(
        inputs, rms=inputs.rms * math.sqrt(_mean_square(psd, contact, seen) / _mean_square(psd, contact, end))
    )
    whole, cut = [], []
    for seed in range(contact.nominal_seed, contact.nominal_seed + SURFACES):
        whole.append(_outputs(inputs, contact, law, seed))
        cut.append(whole[-1] if seen == end else _outputs(lower, shorter, law, seed))
    for name, unit in UNITS.items():
        given = np.array([[values[name] for values in made] for made in (cut, whole)])
        given = given[:, np.all(np.isfinite(given) & (given > 0), axis=0)]
        row = {"quantity": name, "unit": unit, "seen_q": seen, "end_q": end}
        if given.shape[1] > 1:  # no attraction, or no law, has nothing to say
            logs = np.log(given)
            shift = float(np.mean(logs[1] - logs[0]))
            extrapolated = shift**2 / 12
            between = float(np.mean(np.var(logs, axis=1, ddof=1)))
            row |= {"seen": float(np.exp(logs[0].mean())), "all": float(np.exp(logs[1].mean()))}
            row |= {
                "shift": math.expm1(shift),
                "share": extrapolated / (extrapolated + between) if extrapolated > 0 else 0.0,
            }
        yield row


def _outputs(inputs: ContactInputs, contact: ContactSettings, law: LawSettings, seed: int) -> dict[str, float]:
    cycle = run_cycle(inputs, contact, seed)
    return {
        "first_contact": cycle.first_contact_nm,
        "area": float(cycle.closing.contact_area_nm2[-1]),
        "C_r": fit_cycle(cycle, law).closing.C_r_GPa,
        "pull_off": pull_off(cycle.opening),
    }


def _mean_square(psd: Any, contact: ContactSettings, end: float) -> float:
    """Mean square height of the waves of a cell up to `end`, nm^2, to a common factor."""
    q = np.geomspace(2 * np.pi / contact.length_nm, end, 400)
    return float(np.trapezoid(q * psd(q), q))
