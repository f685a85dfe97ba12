"""What waves that no instrument saw do to the contact: the same random surfaces with them and without."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from mesoscale.contact import run_cycle
from mesoscale.contact.energy import pull_off
from mesoscale.contact.surface import shortest_wave, surface_spectrum
from mesoscale.inputs.contact import ContactInputs
from mesoscale.law.branches import fit_cycle
from mesoscale.settings import ContactSettings, LawSettings
from mesoscale.settings.contact import NOMINAL_SEED

SURFACES = 8
SITES = 512  # a side at most: the share is a matter of the waves, not of the last site
UNITS = {"first_contact": "nm", "area": "nm^2", "C_r": "GPa", "pull_off": "nN"}


def unseen_shares(
    inputs: ContactInputs, contact: ContactSettings, law: LawSettings, seen: float
) -> Iterator[dict[str, Any]]:
    """Rows of topography/unseen.csv: what the waves beyond `seen` (1/nm) do to what is computed.

    Surfaces of the same noise end once at `seen` and once where those of the contact end: at q1, or at what the grid
    holds. The truth lies anywhere between none of these waves and all as extrapolated. `shift` is the relative change
    that all of them make; `share` is the part of the variance of ln(quantity), beside that from surface to surface,
    which this leaves (a uniform distribution over the shift). Where q1 ends the surfaces before the grid does, a second
    set of rows says what they would be if the roughness went on.
    """
    contact = contact.model_copy(update={"pixels": min(contact.pixels, SITES)})
    unlimited = contact.model_copy(update={"q1_per_nm": None})
    ends = sorted({shortest_wave(contact), shortest_wave(unlimited)})
    seen = min(seen, ends[0])
    psd = surface_spectrum(inputs, unlimited)
    known = _mean_square(psd, contact, ends[0])

    def pressed(end: float) -> list[dict[str, float]]:
        rough = replace(inputs, rms=inputs.rms * math.sqrt(_mean_square(psd, contact, end) / known))
        chosen = contact.model_copy(update={"q1_per_nm": end})
        return [_outputs(rough, chosen, law, NOMINAL_SEED + k) for k in range(SURFACES)]

    cut = pressed(seen)
    for end in ends:
        yield from _rows(cut, cut if end == seen else pressed(end), seen, end)


def _rows(
    cut: Sequence[Mapping[str, float]], whole: Sequence[Mapping[str, float]], seen: float, end: float
) -> Iterator[dict[str, Any]]:
    for name, unit in UNITS.items():
        given = np.array([[values[name] for values in made] for made in (cut, whole)])
        given = given[:, np.all(np.isfinite(given) & (given > 0), axis=0)]
        row = {"quantity": name, "unit": unit, "seen_q": seen, "end_q": end}
        if given.shape[1] > 1:  # no attraction, or no law, has nothing to say
            logs = np.log(given)
            shift = float(np.mean(logs[1] - logs[0]))
            spread = shift**2 / 12, float(np.mean(np.var(logs, axis=1, ddof=1)))
            row |= {"seen": float(np.exp(logs[0].mean())), "all": float(np.exp(logs[1].mean()))}
            row |= {"shift": math.expm1(shift), "share": spread[0] / sum(spread) if spread[0] > 0 else 0.0}
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
