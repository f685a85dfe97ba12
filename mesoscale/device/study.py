"""The device stage as a whole: samples of the law in, behaviour of the switch out."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from mesoscale.device.capacitance import rough_capacitance_F
from mesoscale.device.contact_law import BRANCHES, law_from_columns, physical, scale_adhesion, take
from mesoscale.device.statistics import (
    analytic_pull_in_V,
    analytic_release_V,
    describe,
    describe_states,
    stiction_curve,
)
from mesoscale.device.switch import Switch, SwitchStates, solve_switch, sweep, switch_from_settings
from mesoscale.errors import InputError
from mesoscale.law import PARAMETERS, Law
from mesoscale.settings import DeviceSettings

CASES = ("with_adhesion", "without_adhesion")


@dataclass(frozen=True)
class LawSamples:
    """Joint samples of both branches that a device can use, and their nominal member.

    Attributes
    ----------
    laws, nominal : by branch; samples of shape (samples,) and single numbers
    columns : the columns of the samples kept, shape (samples,) each
    dropped : samples left out because C_r or rho_r was not positive or a number was missing
    """

    laws: dict[str, Law]
    nominal: dict[str, Law]
    columns: dict[str, np.ndarray]
    dropped: int


def read_samples(
    rows: Sequence[Mapping[str, str]], settings: DeviceSettings, rho_a_nm: float, shield_nm: float
) -> LawSamples:
    """Samples of the law from the rows of uq/samples.csv; the nominal law is the median of each parameter.

    Raises
    ------
    InputError : no sample can be used.
    """
    names = ["hamaker", "rms", *(f"{branch}_{name}" for branch in BRANCHES for name in PARAMETERS)]
    chosen = rows[: settings.samples]
    columns = {name: np.array([float(row[name] or "nan") for row in chosen]) for name in names}
    laws = {branch: law_from_columns(columns, branch, rho_a_nm, shield_nm) for branch in BRANCHES}
    usable = physical(laws["closing"]) & physical(laws["opening"])
    if not usable.any():
        raise InputError(
            f"uq/samples.csv: none of {len(chosen)} samples has C_r > 0 and rho_r > 0 on both branches, so "
            "the law cannot drive a switch; look at law/parameters.csv for failed fits"
        )
    laws = {
        branch: scale_adhesion(take(law, usable), settings.adhesion_scale) for branch, law in laws.items()
    }
    nominal = {branch: _median(law) for branch, law in laws.items()}
    columns = {name: values[usable] for name, values in columns.items()}
    return LawSamples(laws, nominal, columns, int((~usable).sum()))


def study_switch(
    samples: LawSamples, settings: DeviceSettings, law_pressure_MPa: float | None
) -> tuple[dict[str, Any], dict[str, SwitchStates]]:
    """Pull-in, release, stiction and capacitance over the samples, with and without adhesion.

    Parameters
    ----------
    law_pressure_MPa : largest contact pressure that the law was fitted to; beyond it the law extrapolates
    """
    switch = switch_from_settings(settings)
    closing, opening = samples.laws["closing"], samples.laws["opening"]
    states = {
        "with_adhesion": solve_switch(switch, closing, opening, settings.hold_voltage_V),
        "without_adhesion": solve_switch(
            switch, scale_adhesion(closing, 0), scale_adhesion(opening, 0), settings.hold_voltage_V
        ),
    }
    kept = states["with_adhesion"]
    down = np.isfinite(kept.hold_nm)
    hold_MPa = kept.hold_pressure_GPa * 1e3
    extrapolates = law_pressure_MPa is not None and bool(np.nanmedian(hold_MPa) > law_pressure_MPa)
    rms = samples.columns["rms"]
    up_nm = np.full(1, switch.gap_nm)
    results = {
        "switch": {**asdict(switch), "landed_fraction": settings.landed_fraction},
        "adhesion_scale": settings.adhesion_scale,
        "samples": {"used": len(rms), "dropped": samples.dropped},
        "nominal_law": {
            branch: {name: float(getattr(law, name)) for name in (*PARAMETERS, "hamaker")}
            for branch, law in samples.nominal.items()
        },
        **{case: describe_states(found) for case, found in states.items()},
        "capacitance_fF": {
            "up": float(switch.capacitance_F(up_nm)[0] * 1e15),
            "down_plate": describe(switch.capacitance_F(kept.hold_nm) * 1e15),
            "down_rough": describe(rough_capacitance_F(switch, kept.hold_nm[down], rms[down]) * 1e15),
        },
        "checks": _checks(switch, samples, states),
        "warnings": _warnings(
            settings, states, extrapolates, float(np.nanmedian(hold_MPa)), law_pressure_MPa
        ),
    }
    return results, states


def switch_path(samples: LawSamples, settings: DeviceSettings) -> list[dict[str, Any]]:
    """W(s) of the nominal law on both branches, with and without adhesion, for the picture of the path."""
    switch = switch_from_settings(settings)
    rows = []
    for case, factor in zip(CASES, (1.0, 0.0), strict=True):
        for branch in BRANCHES:
            separation, squared = sweep(switch, scale_adhesion(samples.nominal[branch], factor))
            slope = np.gradient(squared, separation, edge_order=1)
            for s, w, stable in zip(separation, squared, slope < 0, strict=True):
                rows.append(
                    {
                        "case": case,
                        "branch": branch,
                        "separation_nm": float(s),
                        "voltage_squared_V2": float(w),
                        "stable": int(stable),
                    }
                )
    return rows


def state_rows(states: dict[str, SwitchStates]) -> list[dict[str, Any]]:
    """Rows of device/release.csv, one per sample and case."""
    return [
        {
            "case": case,
            "sample": i,
            "pull_in_V": float(found.pull_in_V[i]),
            "release_V": float(found.release_V[i]),
            "release_nm": float(found.release_nm[i]),
            "stuck": int(found.stuck[i]),
            "critical_landed_fraction": float(found.critical_fraction[i]),
        }
        for case, found in states.items()
        for i in range(len(found.stuck))
    ]


def stiction_rows(states: dict[str, SwitchStates]) -> list[dict[str, float]]:
    """Rows of device/stiction.csv: probability of stiction against landed fraction."""
    return stiction_curve(states["with_adhesion"].critical_fraction)


def _median(law: Law) -> Law:
    values = {name: float(np.median(np.asarray(getattr(law, name)))) for name in (*PARAMETERS, "hamaker")}
    return Law(**values, rho_a_nm=float(np.max(law.rho_a_nm)), shield_nm=float(np.max(law.shield_nm)))


def _checks(switch: Switch, samples: LawSamples, states: dict[str, SwitchStates]) -> dict[str, float]:
    """Relative distance of the numerical folds without adhesion from the analytic ones."""
    free = states["without_adhesion"]
    analytic = analytic_release_V(switch, samples.laws["opening"])
    touches = np.abs(free.release_nm - np.asarray(samples.laws["opening"].d_c_nm)) < 1e-3
    release = np.abs(free.release_V / analytic - 1)[touches]
    return {
        "pull_in_relative_error": float(np.nanmax(np.abs(free.pull_in_V / analytic_pull_in_V(switch) - 1))),
        "release_relative_error": float(release.max()) if release.size else float("nan"),
    }


def _warnings(
    settings: DeviceSettings,
    states: dict[str, SwitchStates],
    extrapolates: bool,
    hold_MPa: float,
    law_pressure_MPa: float | None,
) -> list[str]:
    warnings = []
    if extrapolates:
        warnings.append(
            f"held closed, the landed part carries {hold_MPa:.3g} MPa (median), more than the "
            f"{law_pressure_MPa:.3g} MPa that the law was fitted to: the closed separation is extrapolated"
        )
    stuck = states["with_adhesion"].stuck.mean()
    if stuck > 0.5:
        warnings.append(
            f"{stuck:.0%} of the samples stick at a landed fraction of {settings.landed_fraction:g}; the "
            "law's adhesion is at least ten times the measured dry adhesion of such surfaces"
        )
    return warnings
