"""Hardness of one closing run: plastic onset, plateau stress, and the reasons to refuse.

Hardness is the mean contact stress of the plateau beyond a *witnessed* onset of plasticity (bonds exchanged
and a top that stays lower after unloading).  The change of slope (Kim et al. 2013) is reported beside it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from atomistic.kink import find_kink
from atomistic.settings import ClosingSettings, YieldSettings

Rows = Sequence[Mapping[str, float]]


@dataclass(frozen=True)
class Hardness:
    """What a run says about hardness; stresses in GPa, lengths in nm, NaN where there is nothing to say."""

    status: str  # yield, no_yield, or "rejected: why"
    contact_length_nm: float = float("nan")
    contact_area_nm2: float = float("nan")
    hardness_GPa: float = float("nan")
    hardness_lo: float = float("nan")
    hardness_hi: float = float("nan")
    length_min_nm: float = float("nan")
    length_max_nm: float = float("nan")
    plateau_exponent: float = float("nan")
    plateau_points: int = 0
    onset_displacement_nm: float = float("nan")
    onset_length_nm: float = float("nan")
    exchanges_before: float = float("nan")
    exchanges_after: float = float("nan")
    lowering_nm: float = float("nan")
    kink_length_nm: float = float("nan")
    kink_GPa: float = float("nan")
    kink_lo: float = float("nan")
    kink_hi: float = float("nan")
    kink_p_value: float = float("nan")
    drift_meV_atom_ps: float = float("nan")
    warming_K: float = float("nan")

    def row(self) -> dict[str, object]:
        """As a row of points.csv."""
        return asdict(self)


def plastic_onset(witness: Rows, approach_nm: float, settings: YieldSettings) -> tuple[float | None, float]:
    """Displacement at which plasticity is witnessed, and the background of bond exchanges per snapshot.

    The background is the mean number of new exchanges between the snapshots before contact.  The onset is the
    first snapshot with `min_exchanges` more new exchanges than the background and its two-sigma Poisson noise
    allow, from which on the top stays `min_lowering_A` lower.
    """
    displacement = np.array([row["displacement_nm"] for row in witness])
    new = np.array([row["new_exchanges"] for row in witness])
    lowering = 10 * np.array([row["lowering_nm"] for row in witness])
    before = (displacement <= approach_nm) & (np.arange(len(witness)) > 0)
    background = float(np.mean(new[before])) if np.any(before) else 0.0
    limit = background + max(settings.min_exchanges, 2 * np.sqrt(background))
    lasting = np.minimum.accumulate(lowering[::-1])[::-1] >= settings.min_lowering_A
    found = np.flatnonzero((new >= limit) & lasting & (displacement > approach_nm))
    return (float(displacement[found[0]]) if len(found) else None), background


def find_hardness(
    curve: Rows, witness: Rows, cell_area_nm2: float, closing: ClosingSettings, settings: YieldSettings
) -> Hardness:
    """Hardness of a closing run.

    Parameters
    ----------
    curve, witness : rows of `Closing.curve` and `Closing.witness`.
    cell_area_nm2 : cross-section of the simulation cell.
    """
    column = {name: np.array([float(row[name]) for row in curve]) for name in curve[0]}
    length, stress, travel = (
        column["contact_length_nm"],
        column["contact_stress_GPa"],
        column["displacement_nm"],
    )
    elapsed_ps = (column["step"][-1] - column["step"][0]) * closing.timestep_fs / 1000
    drift = float(np.max(np.abs(column["energy_drift_meV_per_atom"])) / elapsed_ps)
    temperature = column["temperature_K"]
    warming = float(np.max(temperature) - np.mean(temperature[:4]))
    fraction = column["contact_area_nm2"] / cell_area_nm2
    window = _first_stretch((length >= settings.min_length_nm) & (fraction <= settings.max_area_fraction))
    onset, background = plastic_onset(witness, closing.approach_nm, settings)
    facts: dict[str, float] = {
        "drift_meV_atom_ps": drift,
        "warming_K": warming,
        "exchanges_before": background,
    }
    facts |= _kink(length, stress, fraction, settings)
    if drift > settings.max_drift_meV_atom_ps:
        return Hardness(f"rejected: energy drifts by {drift:.2g} meV per atom and ps", **facts)
    if warming > settings.max_warming_K:
        return Hardness(f"rejected: warms by {warming:.0f} K", **facts)
    if np.sum(window) < settings.min_points:
        return Hardness("rejected: contact too small for the window of lengths", **facts)
    if onset is None:
        return Hardness("no_yield", **facts)
    beyond = window & (travel >= onset)
    last = witness[-1]
    facts |= {
        "onset_displacement_nm": onset,
        "onset_length_nm": float(np.interp(onset, travel, length)),
        "exchanges_after": float(np.mean([row["new_exchanges"] for row in witness if row["displacement_nm"] >= onset])),
        "lowering_nm": float(last["lowering_nm"]),
    }
    if np.sum(beyond) < settings.min_points:
        return Hardness("rejected: too few averages between onset and the end of the window", **facts)
    plateau, lengths = stress[beyond], length[beyond]
    exponent = float(np.polyfit(np.log(lengths), np.log(plateau), 1)[0])
    low, high = _interval_of_mean(plateau)
    facts |= {
        "contact_length_nm": float(np.mean(lengths)),
        "contact_area_nm2": float(np.mean(lengths) ** 2),
        "hardness_GPa": float(np.mean(plateau)),
        "hardness_lo": low,
        "hardness_hi": high,
        "length_min_nm": float(np.min(lengths)),
        "length_max_nm": float(np.max(lengths)),
        "plateau_exponent": exponent,
    }
    if exponent > settings.max_exponent:
        status = f"rejected: stress still rises as length^{exponent:.2f} beyond the onset"
    else:
        status = "yield"
    return Hardness(status, plateau_points=int(np.sum(beyond)), **facts)


def _first_stretch(mask: np.ndarray) -> np.ndarray:
    """The mask up to its first end: what comes back after the window was left is not used."""
    if not np.any(mask):
        return mask
    start = int(np.argmax(mask))
    end = start + int(np.argmin(np.append(mask[start:], False)))
    return np.isin(np.arange(len(mask)), np.arange(start, end))


def _kink(length: np.ndarray, stress: np.ndarray, fraction: np.ndarray, settings: YieldSettings) -> dict[str, float]:
    """The paper's change of slope, in the window of lengths in which stress is judged."""
    use = np.isfinite(stress) & (length >= settings.min_length_nm) & (fraction <= settings.max_area_fraction)
    kink = find_kink(length[use], stress[use], settings.min_points)
    if kink is None:
        return {}
    return {
        "kink_length_nm": kink.x,
        "kink_GPa": kink.y,
        "kink_lo": kink.low,
        "kink_hi": kink.high,
        "kink_p_value": kink.p_value,
    }


def _interval_of_mean(values: np.ndarray, block: int = 4, samples: int = 2000) -> tuple[float, float]:
    """68 % interval of the mean by a circular block bootstrap (neighbouring averages are correlated)."""
    count = len(values)
    rng = np.random.default_rng(np.random.SeedSequence([count, 8]))
    starts = rng.integers(0, count, (samples, -(-count // block)))
    order = (starts[:, :, None] + np.arange(min(block, count))) % count
    low, high = np.quantile(values[order].reshape(samples, -1).mean(axis=1), [0.16, 0.84])
    return float(low), float(high)
