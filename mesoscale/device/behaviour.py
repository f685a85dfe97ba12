"""The device stage as a whole: samples of the law in, behaviour of the switch out."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from mesoscale.device.contact_law import SAMPLED, law_from_columns, physical, scale_adhesion, take
from mesoscale.device.statistics import (
    analytic_pull_in_V,
    analytic_release_V,
    describe,
    describe_states,
)
from mesoscale.device.switch import (
    Switch,
    SwitchStates,
    rough_capacitance_F,
    solve_switch,
    switch_from_settings,
)
from mesoscale.errors import InputError
from mesoscale.law.compact import Law
from mesoscale.law.parameters import BRANCHES, FITTED, PARAMETERS
from mesoscale.settings import DeviceSettings

MOST_SAMPLES = 4000
"""Samples of the law that are taken: quantiles are then known to 1 % in probability."""


@dataclass(frozen=True)
class LawSamples:
    """Joint samples of both branches that a device can use, and their nominal member.

    Attributes
    ----------
    laws, nominal : by branch; samples of shape (samples,) and single numbers
    nominal_from : where the nominal law comes from
    columns : the columns of the samples kept, shape (samples,) each
    dropped : samples left out because C_r or rho_r was not positive or a number was missing
    """

    laws: dict[str, Law]
    nominal: dict[str, Law]
    columns: dict[str, np.ndarray]
    dropped: int
    nominal_from: str


def samples_of_rows(
    rows: Sequence[Mapping[str, str]],
    fitted: Sequence[Mapping[str, str]],
    settings: DeviceSettings,
    rho_a_nm: float,
    shield_nm: float,
) -> LawSamples:
    """Samples of the law, and the nominal law beside them.

    Parameters
    ----------
    rows : uq/samples.csv, joint samples of inputs and of the parameters of both branches
    fitted : law/parameters.csv; its runs at central inputs (node 0) give the nominal law, the mean over
        their seeds.  Where a fit is missing, the medians of the samples are taken instead.

    Raises
    ------
    InputError : no sample can be used.
    """
    names = ["hamaker", "rms", *FITTED]
    chosen = rows[:MOST_SAMPLES]
    columns = {name: np.array([float(row[name] or "nan") for row in chosen]) for name in names}
    laws = {branch: law_from_columns(columns, branch, rho_a_nm, shield_nm) for branch in BRANCHES}
    usable = physical(laws["closing"]) & physical(laws["opening"])
    if not usable.any():
        raise InputError(
            f"uq/samples.csv: none of {len(chosen)} samples has positive C_r and rho_r and C_a >= 0 on both "
            "branches, so the law cannot drive a switch; look at law/parameters.csv for failed fits, take more "
            "contact.pixels or uncertainty.seeds, or uncertainty.response: regression, which keeps them positive"
        )
    laws = {branch: take(law, usable) for branch, law in laws.items()}
    central = {
        branch: [row for row in fitted if row["branch"] == branch and row["node"] == "0" and row["C_r_GPa"]]
        for branch in BRANCHES
    }
    if all(central.values()):
        nominal = {branch: _mean_of(central[branch], rho_a_nm, shield_nm) for branch in BRANCHES}
        nominal_from = f"mean of {len(central['closing'])} run(s) at central inputs"
    else:
        nominal = {branch: _median(law) for branch, law in laws.items()}
        nominal_from = "medians of the samples, as no run at central inputs could be fitted"
    return LawSamples(
        {branch: scale_adhesion(law, settings.adhesion_scale) for branch, law in laws.items()},
        {branch: scale_adhesion(law, settings.adhesion_scale) for branch, law in nominal.items()},
        {name: values[usable] for name, values in columns.items()},
        int((~usable).sum()),
        nominal_from,
    )


def samples_json(samples: LawSamples, settings: DeviceSettings) -> dict[str, Any]:
    """Content of device/law.json: the closed form, the nominal parameters and the joint samples."""
    first = samples.laws["closing"]
    return {
        "law": {
            "pressure_GPa": "C_r (exp(max(d_c - s, 0)/rho_r) - 1) - hamaker/(6 pi (max(s, 0)^3 + shield^3)) "
            "- C_a max(d_c + rho_a - s, 0)",
            "s": "mean separation, nm; positive pressure pushes the surfaces apart",
            "source": "Kim et al., Modelling Simul. Mater. Sci. Eng. 21 (2013) 085002, eqs 10-13",
        },
        "units": {
            "hamaker": "1e-18 J",
            "d_c_nm": "nm",
            "C_a_GPa_nm": "GPa/nm",
            "C_r_GPa": "GPa",
            "rho_r_nm": "nm",
            "rho_a_nm": "nm",
            "shield_nm": "nm",
        },
        "constants": {"rho_a_nm": first.rho_a_nm, "shield_nm": first.shield_nm},
        "adhesion_scale": settings.adhesion_scale,
        "nominal": _nominal_json(samples),
        "nominal_from": samples.nominal_from,
        "samples": {
            name: np.round(column, 15)
            for branch, law in samples.laws.items()
            for name, column in _named_columns(branch, law).items()
        },
    }


def drive_switch(
    samples: LawSamples, settings: DeviceSettings, law_pressure_MPa: float | None
) -> tuple[dict[str, Any], dict[str, SwitchStates]]:
    """Pull-in, release, stiction and capacitance over the samples, with and without adhesion.

    Parameters
    ----------
    law_pressure_MPa : largest contact pressure that the law was fitted to; beyond it the law extrapolates
    """
    switch = switch_from_settings(settings, samples.laws["opening"].rho_a_nm)
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
    rms = samples.columns["rms"]
    up_nm = np.full(1, switch.gap_nm)
    results = {
        "switch": asdict(switch),
        "adhesion_scale": settings.adhesion_scale,
        "samples": {"used": len(rms), "dropped": samples.dropped},
        "nominal_law": _nominal_json(samples),
        "nominal_from": samples.nominal_from,
        **{case: describe_states(state) for case, state in states.items()},
        "capacitance_fF": {
            "up": float(switch.capacitance_F(up_nm)[0] * 1e15),
            "down_plate": describe(switch.capacitance_F(kept.hold_nm) * 1e15),
            "down_rough": describe(rough_capacitance_F(switch, kept.hold_nm[down], rms[down]) * 1e15),
        },
        "checks": _checks(switch, samples, states),
        "warnings": _warnings(switch, states, hold_MPa[down], law_pressure_MPa),
    }
    return results, states


def state_rows(states: dict[str, SwitchStates]) -> list[dict[str, Any]]:
    """Rows of device/release.csv, one per sample and case."""
    return [
        {
            "case": case,
            "sample": i,
            "pull_in_V": float(state.pull_in_V[i]),
            "release_V": float(state.release_V[i]),
            "release_nm": float(state.release_nm[i]),
            "stuck": int(state.stuck[i]),
            "critical_share": float(state.critical_fraction[i]),
        }
        for case, state in states.items()
        for i in range(len(state.stuck))
    ]


def _median(law: Law) -> Law:
    return replace(law, **{name: float(np.median(np.asarray(getattr(law, name)))) for name in SAMPLED})


def _mean_of(rows: Sequence[Mapping[str, str]], rho_a_nm: float, shield_nm: float) -> Law:
    values = {name: float(np.mean([float(row[name]) for row in rows])) for name in SAMPLED}
    return Law(**values, rho_a_nm=rho_a_nm, shield_nm=shield_nm)


def _nominal_json(samples: LawSamples) -> dict[str, dict[str, float]]:
    return {branch: {name: float(getattr(law, name)) for name in SAMPLED} for branch, law in samples.nominal.items()}


def _named_columns(branch: str, law: Law) -> dict[str, np.ndarray]:
    values = {f"{branch}_{name}": np.asarray(getattr(law, name)) for name in PARAMETERS}
    return values | {"hamaker": np.asarray(law.hamaker)}


def _checks(switch: Switch, samples: LawSamples, states: dict[str, SwitchStates]) -> dict[str, float]:
    """Relative distance of the numerical folds without adhesion from the analytic ones."""
    free = states["without_adhesion"]
    analytic = analytic_release_V(switch, samples.laws["opening"])
    touches = np.abs(free.release_nm - np.asarray(samples.laws["opening"].d_c_nm)) < 1e-3
    release = np.abs(free.release_V / analytic - 1)[touches]
    pull_in = np.abs(free.pull_in_V / analytic_pull_in_V(switch) - 1)[np.isfinite(free.pull_in_V)]
    return {
        "pull_in_relative_error": float(pull_in.max()) if pull_in.size else float("nan"),
        "release_relative_error": float(release.max()) if release.size else float("nan"),
    }


def _warnings(
    switch: Switch,
    states: dict[str, SwitchStates],
    hold_MPa: np.ndarray,
    law_pressure_MPa: float | None,
) -> list[str]:
    warnings = []
    if law_pressure_MPa is not None and hold_MPa.size and np.median(hold_MPa) > law_pressure_MPa:
        warnings.append(
            f"held closed, the contact carries {np.median(hold_MPa):.3g} MPa (median), more than the "
            f"{law_pressure_MPa:.3g} MPa that the law was fitted to: the closed separation is extrapolated"
        )
    stuck = states["with_adhesion"].stuck.mean()
    if stuck > 0.5:
        warnings.append(
            f"{stuck:.0%} of the samples stick by the {switch.last_share:.2%} of the electrode that come off last; the "
            "law's adhesion is at least ten times the measured dry adhesion of such surfaces"
        )
    return warnings
