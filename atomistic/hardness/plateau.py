"""Hardness of one closing run: plastic onset, plateau stress, and the reasons to refuse.

Hardness is the mean contact stress of the plateau beyond a *witnessed* onset of plasticity (bonds
exchanged and a top that stays lower after unloading).
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from atomistic.hardness.runs import PROTOCOL

Rows = Sequence[Mapping[str, float]]


@dataclass(frozen=True)
class Rules:
    """What counts as yield, when a run may end, and which film does not count (lengths of bonds).

    The error rates of study `hardness.detection` fix all that is no gate of a film.
    """

    min_length_nm: float = 2.0
    """Contact length from which stress is judged."""

    max_area_fraction: float = 0.5
    """Contact area over cell area up to which stress is judged."""

    min_exchanges: int = 5
    """Changed bonds above the background that witness plasticity."""

    min_lowering_A: float = 0.5
    """Lasting lowering that witnesses plasticity."""

    min_points: int = 4
    """Averages beyond the onset."""

    max_exponent: float = 0.35
    """Largest n in stress ~ length^n beyond the onset: 0 is a plateau, 1 is elastic."""

    stop_interval: float = 0.04
    """A run has settled once half the 68 % interval of its plateau is this share of it."""

    stop_points: int = 12
    """With as many averages."""

    stop_area_fraction: float = 0.25
    """On this share of the cell: a larger asperity is to give a larger one."""

    max_drift_meV_atom_ps: float = 0.2
    """Largest drift of the conserved energy."""

    max_warming_K: float = 150.0
    """Largest rise of temperature."""

    latest_start: int = 3
    """Of as many parts of the averages, the first is the last to hold the plateau's start."""

    clearly_more: float = 1.5
    """Times the independent averages."""

    same_shape: tuple[float, float] = (0.5, 0.6)
    """Contact length over wavelength: runs of one shape are alike, whatever their size."""

    least_covered: float = 0.95
    """Share of the base below a film."""

    largest_gap_A: float = 4.2
    """Between film and base, less in 95 % of columns: twice a bond of metal and oxygen."""

    largest_slip_A: float = 2.1
    """Of a film over its base below the contact, at the end: one bond."""


RULES = Rules()


@dataclass(frozen=True)
class Hardness:
    """What a run says about hardness; GPa and nm, NaN where there is nothing to say.

    Attributes
    ----------
    status : yield, no_yield, or "rejected: why".
    sound : whether energy, temperature, film and range of contact are as they must be, whatever
        became of the plateau.
    plateau_exponent : n of stress ~ length^n on the plateau.
    same_shape_GPa, same_shape_length_nm : mean stress and contact length where the contact is
        `Rules.same_shape` of the wavelength wide.
    """

    status: str
    sound: bool = False
    contact_length_nm: float = float("nan")
    contact_area_nm2: float = float("nan")
    hardness_GPa: float = float("nan")
    hardness_lo: float = float("nan")
    hardness_hi: float = float("nan")
    length_min_nm: float = float("nan")
    length_max_nm: float = float("nan")
    same_shape_GPa: float = float("nan")
    same_shape_length_nm: float = float("nan")
    plateau_exponent: float = float("nan")
    plateau_points: int = 0
    onset_displacement_nm: float = float("nan")
    onset_length_nm: float = float("nan")
    exchanges_before: float = float("nan")
    exchanges_at_onset: float = float("nan")
    onset_p_value: float = float("nan")
    exchanges_after: float = float("nan")
    lowering_nm: float = float("nan")
    drift_meV_atom_ps: float = float("nan")
    warming_K: float = float("nan")


@dataclass(frozen=True)
class Onset:
    """Where plasticity is first witnessed.

    Attributes
    ----------
    background : bond exchanges per snapshot before contact; NaN without such a snapshot.
    exchanges, p_value : those of the onset's snapshot, and the chance of as many without
        plasticity.
    """

    displacement_nm: float | None
    background: float
    exchanges: float = float("nan")
    p_value: float = float("nan")


def plastic_onset(
    witness: Rows, apart_nm: float, rules: Rules = RULES, by_bonds: bool = True
) -> Onset:
    """First witness of plasticity among relaxed snapshots; apart for `apart_nm` of travel.

    The top must stay `min_lowering_A` lower than in the last snapshot before contact, from then on.
    Where a metal lies below this is all (`by_bonds` False): its grain boundaries change neighbours
    at rest too.

    The background is the number of new exchanges on the travel before contact; after a longer
    travel a snapshot has proportionally more.  The onset is the first snapshot with `min_exchanges`
    more new exchanges than the background and its two-sigma Poisson noise allow.  Its p value is
    that of the exact test for two Poisson rates (Przyborowski and Wilenski 1940), which knows that
    the background is an estimate.

    Returns
    -------
    Its `background` is that of the travel between the first two snapshots.
    """
    displacement = np.array([row["displacement_nm"] for row in witness])
    new = np.array([row["new_exchanges"] for row in witness])
    lowering = 10 * np.array([row["lowering_nm"] for row in witness])
    apart = displacement <= apart_nm + 1e-6  # a travel is a whole number of steps, rounded
    before = apart & (np.arange(len(witness)) > 0)
    if not np.any(before):
        return Onset(None, float("nan"))
    travel = np.round(np.diff(displacement, prepend=displacement[0]), 6)
    travel /= travel[1]
    exposure = float(np.sum(travel[before]))
    background = float(np.sum(new[before])) / exposure
    expected = background * travel
    limit = np.zeros(len(new))
    if by_bonds:
        limit = expected + np.maximum(rules.min_exchanges, 2 * np.sqrt(expected))
    lowering -= lowering[apart][-1]
    lasting = np.minimum.accumulate(lowering[::-1])[::-1] >= rules.min_lowering_A
    onsets = np.flatnonzero((new >= limit) & lasting & ~apart)
    if len(onsets) == 0:
        return Onset(None, background)
    if not by_bonds:
        return Onset(float(displacement[onsets[0]]), background)
    from scipy.special import bdtrc  # half a second to import, which plans do without

    first = onsets[0]
    count = int(new[first])
    earlier = int(np.sum(new[before]))
    p_value = float(bdtrc(count - 1, count + earlier, travel[first] / (travel[first] + exposure)))
    return Onset(float(displacement[first]), background, float(count), p_value)


def find_hardness(
    curve: Rows,
    witness: Rows,
    cell_area_nm2: float,
    approach_nm: float = PROTOCOL.approach_nm,
    rules: Rules = RULES,
    on_base: bool = False,
) -> Hardness:
    """Hardness of a closing run.

    Parameters
    ----------
    curve, witness : rows of `ClosedAsperity.curve` and `.witness`.
    cell_area_nm2 : cross-section of the simulation cell.
    approach_nm : travel before a flat can touch.
    on_base : a base, or a film on one: stress that changes with the contact is what its law
        describes, so that no plateau is asked for.
    """
    if len(curve) < rules.min_points:
        return Hardness(
            f"rejected: a curve of {len(curve)} averages; {rules.min_points} are needed"
        )
    column = {name: np.array([float(row[name]) for row in curve]) for name in curve[0]}
    length = column["contact_length_nm"]
    stress = column["contact_stress_GPa"]
    travel = column["displacement_nm"]
    elapsed_ps = column["time_ps"][-1] - column["time_ps"][0]
    drift = float(np.max(np.abs(column["energy_drift_meV_per_atom"])) / elapsed_ps)
    temperature = column["temperature_K"]
    warming = float(np.max(temperature) - np.mean(temperature[:4]))
    fraction = column["contact_area_nm2"] / cell_area_nm2
    # what comes back after the contact was too wide is not used; one that shrinks for a moment goes
    # on
    window = (length >= rules.min_length_nm) & (
        np.maximum.accumulate(fraction) <= rules.max_area_fraction
    )
    apart = np.max(travel[np.cumsum(fraction) == 0], initial=approach_nm)
    onset = plastic_onset(witness, float(apart), rules, by_bonds=not on_base)
    measured: dict[str, Any] = {
        "drift_meV_atom_ps": drift,
        "warming_K": warming,
        "exchanges_before": onset.background,
    }
    # also where it is no number
    if not drift <= rules.max_drift_meV_atom_ps:
        return Hardness(f"rejected: energy drifts by {drift:.2g} meV per atom and ps", **measured)
    if not warming <= rules.max_warming_K:
        return Hardness(f"rejected: warms by {warming:.0f} K", **measured)
    if np.sum(window) < rules.min_points:
        return Hardness("rejected: contact too small for the window of lengths", **measured)
    measured["sound"] = True
    low, high = (share * np.sqrt(cell_area_nm2) for share in rules.same_shape)
    if np.any(alike := window & (length >= low) & (length < high)):
        measured["same_shape_GPa"] = float(np.mean(stress[alike]))
        measured["same_shape_length_nm"] = float(np.mean(length[alike]))
    if np.isnan(onset.background):
        return Hardness(
            "rejected: no snapshot before contact, so that exchanged bonds have no background",
            **measured,
        )
    start = onset.displacement_nm
    if start is None:
        return Hardness("no_yield", **measured)
    yielded = window & (travel >= start)
    last = witness[-1]
    after = [row["new_exchanges"] for row in witness if row["displacement_nm"] >= start]
    measured |= {
        "onset_displacement_nm": start,
        "onset_length_nm": float(np.interp(start, travel, length)),
        "exchanges_at_onset": onset.exchanges,
        "onset_p_value": onset.p_value,
        "exchanges_after": float(np.mean(after)),
        "lowering_nm": float(last["lowering_nm"]),
    }
    if np.sum(yielded) < rules.min_points:
        return Hardness(
            "rejected: too few averages between onset and the end of the window", **measured
        )
    first = 0 if on_base else settled(stress[yielded])
    plateau = stress[yielded][first:]
    lengths = length[yielded][first:]
    exponent = _exponent(lengths, plateau)
    low, high = interval_of_mean(plateau)
    measured |= {
        "contact_length_nm": float(np.mean(lengths)),
        "contact_area_nm2": float(np.mean(lengths) ** 2),
        "hardness_GPa": float(np.mean(plateau)),
        "hardness_lo": low,
        "hardness_hi": high,
        "length_min_nm": float(np.min(lengths)),
        "length_max_nm": float(np.max(lengths)),
        "plateau_exponent": exponent,
        "plateau_points": len(plateau),
    }
    if np.any(plateau <= 0):
        status = "rejected: the plateau has stresses that are not positive: adhesion pulls"
    elif exponent > rules.max_exponent and not on_base:
        status = f"rejected: stress still rises as length^{exponent:.2f} beyond the onset"
    elif fraction[-1] < rules.stop_area_fraction:
        status = (
            f"rejected: stopped before its rule, on {fraction[-1]:.2f} of the cell instead of "
            f"{rules.stop_area_fraction:g}; its travel ended; raise its amplitude_nm"
        )
    else:
        status = "yield"
    return Hardness(status, **measured)


def may_stop(
    curve: Rows,
    witness: Rows,
    cell_area_nm2: float,
    stop: str = "settled",
    approach_nm: float = PROTOCOL.approach_nm,
    rules: Rules = RULES,
    on_base: bool = False,
) -> bool:
    """Is a run complete: did it leave its window, or is its plateau's interval narrow enough?

    Parameters
    ----------
    stop : settled, or window: only at the end of the window.
    on_base : of `find_hardness`.
    """
    fraction = (
        np.array([float(row["contact_area_nm2"]) for row in curve[-rules.min_points :]])
        / cell_area_nm2
    )
    if np.all(fraction > rules.max_area_fraction):
        return True
    if stop == "window" or fraction[-1] < rules.stop_area_fraction:
        return False
    hardness = find_hardness(curve, witness, cell_area_nm2, approach_nm, rules, on_base)
    half = 0.5 * (hardness.hardness_hi - hardness.hardness_lo) / hardness.hardness_GPa
    narrow = hardness.plateau_points >= rules.stop_points and half <= rules.stop_interval
    return hardness.plateau_exponent <= rules.max_exponent and narrow


def point(curve: Rows, witness: Rows, run: Mapping[str, Any], potential: str) -> dict[str, Any]:
    """Row of points.csv of a run, given its summary `run` and the name of its potential."""
    copied = (
        "energy_scale",
        "asperity",
        "wavelength_nm",
        "amplitude_nm",
        "film_nm",
        "seed",
        "atoms",
    )
    hardness = find_hardness(
        curve, witness, run["wavelength_nm"] ** 2, on_base=run["film_nm"] is not None
    )
    if run["film_nm"] and (fault := film_fault(run)):
        hardness = replace(hardness, status=f"rejected: {fault}", sound=False)
    row = {"run": run["run"], "potential": potential}
    row |= {key: run[key] for key in copied}
    row["atom_steps"] = run["atoms"] * run["steps"]
    row["lammps_cpu_s"] = run["lammps_cpu_s"]
    return row | asdict(hardness)


def film_fault(summary: Mapping[str, Any], rules: Rules = RULES) -> str | None:
    """Why a run does not count; None where its film is as it must be.

    Parameters
    ----------
    summary : of a run, with what `film_properties` found.
    """
    if summary["covered_share"] < rules.least_covered:
        return (
            f"the film covers {summary['covered_share']:.0%} of its base (gate"
            f" {rules.least_covered:.0%})"
        )
    if summary["gap_95_A"] > rules.largest_gap_A:
        return (
            f"a gap of {summary['gap_95_A']:.1f} A between film and base (gate"
            f" {rules.largest_gap_A:g} A)"
        )
    if summary["slid_A"] > rules.largest_slip_A:
        return (
            f"the film slid by {summary['slid_A']:.1f} A over its base (gate"
            f" {rules.largest_slip_A:g} A)"
        )
    return None


def _exponent(length: np.ndarray, stress: np.ndarray) -> float:
    """n of stress ~ length^n; NaN where adhesion pulls."""
    if np.any(stress <= 0):
        return float("nan")
    return float(np.polyfit(np.log(length), np.log(stress), 1)[0])


def interval_of_mean(values: np.ndarray) -> tuple[float, float]:
    """68 % interval of the mean of correlated values: Student's t, effective number (AR(1)).

    The correlation of neighbours is corrected for its bias in short series (Kendall 1954).  How
    often the interval holds the truth, also after stopping on its width, is tested (study
    `hardness.detection`).
    """
    if len(values) < 2 or np.ptp(values) == 0:
        return float(np.mean(values)), float(np.mean(values))
    from scipy.special import stdtrit

    effective = _effective_number(values)
    student = float(stdtrit(effective - 1, 0.84))
    half = student * float(np.std(values, ddof=1)) / np.sqrt(effective)
    mean = float(np.mean(values))
    return mean - half, mean + half


def settled(stress: np.ndarray) -> int:
    """Where the plateau begins: bonds break before the stress has stopped rising.

    The start that leaves the most independent averages (Chodera, J. Chem. Theory Comput. 12, 1799,
    2016, doi:10.1021/acs.jctc.5b00784), if it leaves clearly more: else noise would choose, and the
    interval would be too narrow.  A start beyond the first third would make plateaus of the ends of
    elastic curves.  Both by the rates of study `hardness.detection`.
    """
    independent = [
        _effective_number(stress[start:]) for start in range(len(stress) // RULES.latest_start + 1)
    ]
    best = int(np.argmax(independent))
    if independent[best] <= RULES.clearly_more * independent[0]:
        return 0
    return best


def _effective_number(values: np.ndarray) -> float:
    """Independent values that a series of a first-order process is worth, at least two."""
    count = len(values)
    apart = values - np.mean(values)
    variance = float(np.sum(apart**2))
    if count < 2 or variance == 0:
        return float(max(2, count))
    neighbours = float(np.sum(apart[1:] * apart[:-1])) / variance
    correlation = float(np.clip(neighbours + (1 + 4 * neighbours) / count, 0, 0.9))
    return max(2.0, count * (1 - correlation) / (1 + correlation))
