"""What an expert would name, and by how many volts each moves the release: the budget."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from pydantic import model_validator
from scipy.constants import elementary_charge

from asperity.guards.settings import Settings, key
from mesoscale.answer.other_devices import value_of
from mesoscale.answer.spread import departed
from mesoscale.answer.switches import Solved
from mesoscale.errors import InputError
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.switch import States, switch_of
from mesoscale.theory.charging import charge_shift

HERE = "this scene's points"
ANCHORS = ("anchor_um_per_N", "anchor_rad_per_uN_m")
"""Properties of which `of_own` is a share of what the beam itself has."""
KEYS = {
    *(f"contact.{name}" for name in ContactSettings.model_fields),
    *(f"device.{name}" for name in DeviceSettings.model_fields),
    "hardness.material",
}
"""Keys of a scene that can state an effect."""
SETTLE = {"common": "measure it", "each": "control it from device to device"}


class Effect(Settings):
    """An effect that the answer leaves out, or that is a condition of it (config/effects.yaml)."""

    how: Literal["computed", "literature", "condition", "unknown"] = key(
        ..., "how its volts are known"
    )
    about: str = key(..., "what the volts stand for")
    held: bool = key(..., "whether the answer's interval holds it")
    settle: str = key(..., "what would settle it")
    source: str = key(..., "publication, or page of the documentation")
    volts: float | None = key(None, "a bound from the source", "V")
    share: float | None = key(None, "a bound from the source, as a share of the release", "[0, 1]")
    squared_V2: float | None = key(None, "what is taken off the square of the voltage", "V^2")
    charge_e_cm2: float | None = key(None, "charge at the surface of the dielectric", "1/cm^2")
    hardness: float | None = key(
        None, "factor on the hardness of the film, or of the body without one", "(0, 10]"
    )
    charge: bool = key(False, "whether it is none of a scene that states charge")
    varied_as: str = key("", "input that stands for it, where a scene varies it")
    stated_as: str = key("", "key of a scene that states it, such as contact.air")
    changes: str = key("", "property of the device that it changes")
    factor: float = key(1.0, "times its value")
    step: float = key(0.0, "and so much more")
    of_own: float = key(0.0, "and so much of what the beam itself gives way by")
    either_way: bool = key(False, "whether it may as well be so much less")
    to: str = key("", "another choice in place of its value")

    @model_validator(mode="after")
    def _has_a_source(self) -> "Effect":
        if not self.source.strip():
            raise ValueError(
                "a row without source; name the publication or page that its volts come from"
            )
        if self.changes and self.changes not in DeviceSettings.model_fields:
            raise ValueError(f"changes = {self.changes}: no property of the device")
        if self.stated_as and self.stated_as not in KEYS:
            raise ValueError(f"stated_as = {self.stated_as}: no key that stands for an effect")
        if self.of_own and self.changes not in ANCHORS:
            raise ValueError(f"of_own is of {' and '.join(ANCHORS)}, not of {self.changes}")
        ways = [
            self.volts,
            self.share,
            self.squared_V2,
            self.charge_e_cm2,
            self.hardness,
            self.changes or None,
        ]
        if sum(statement is not None for statement in ways) != (self.how != "unknown"):
            words = "volts, share, squared_V2, charge_e_cm2, hardness and changes"
            raise ValueError(f"state one of {words}; none of what is unknown")
        return self


def effects_of(rows: Mapping[str, Any]) -> dict[str, Effect]:
    """The effects of a data file by name.

    Raises
    ------
    InputError : a row without source, or with none or several statements of its volts.
    """
    effects = {}
    for name, row in rows.items():
        try:
            effects[name] = Effect(**row)
        except (InputError, TypeError) as error:
            raise InputError(f"effects: {name}: {error}") from None
    return effects


def left_open(effects: Mapping[str, Effect], stated: Collection[str]) -> dict[str, Effect]:
    """The effects that a scene does not state itself.

    Parameters
    ----------
    stated : its keys, such as contact.air and device.residual_stress_MPa.
    """
    return {name: effect for name, effect in effects.items() if effect.stated_as not in stated}


NUMERICAL = "finite elements and grid"
"""The effect of the numerical choices."""
TWIN = "potential with half its energies"
"""The effect whose factor twins of the closing runs tell."""
OF_RUNS = (TWIN, "titanium dioxide in place of silica")
"""Effects of a hardness that closing runs tell."""


def with_twins(
    effects: Mapping[str, Effect], twins: Sequence[Mapping[str, Any]]
) -> dict[str, Effect]:
    """The effects with the factor on the hardness that the twins of half the energies have.

    Parameters
    ----------
    twins : of hardness/fit.json.
    """
    known = {row["energy_scale"]: row["ratio"] for row in twins}
    if 0.5 not in known:
        return dict(effects)
    ratio = known[0.5]
    about = (
        f"{ratio['median']:.2f} [{ratio['low']:.2f}, {ratio['high']:.2f}] of the hardness, by twins"
        " of this scene"
    )
    return {
        **effects,
        TWIN: effects[TWIN].model_copy(update={"hardness": ratio["median"], "about": about}),
    }


def budget(
    effects: Mapping[str, Effect],
    switch: Mapping[str, Any],
    central: Solved,
    by_hardness: Mapping[float, float] | None = None,
    errors_V: Mapping[str, float] | None = None,
) -> list[dict[str, Any]]:
    """Rows of answer/budget.csv, the most volts first; without a release there is nothing to move,
    and no row.

    Parameters
    ----------
    switch : content of answer/pad_switch.json.
    by_hardness : of `release_by_hardness`; None: effects on the hardness have no row.
    errors_V : errors of the release by numerical choice, as answer/errors.csv has them; None: not
        known.
    """
    if central.pad is None or central.states is None or central.states.release_V == 0.0:
        return []
    pressed = _Pressed(central.point.device, central.pad.curves, central.states)
    of_device = [*_of_device(pressed)]
    rows = [*of_device, *_computed(switch, {row["effect"] for row in of_device})]
    if pressed.device.charged:
        rows.append(_of_charge(pressed))
    if errors_V:
        rows.append(_numerical(errors_V))
    for name, effect in effects.items():
        if effect.changes and not pressed.device.has(effect.changes):
            continue
        if effect.charge and pressed.device.charged:
            continue
        if effect.varied_as and effect.varied_as in central.point.values:
            continue
        if effect.hardness is not None and by_hardness is None:
            continue
        volts, remark = _moved_V(effect, pressed, by_hardness or {})
        stated = effect.model_dump(include={"how", "held", "settle", "source"})
        rows.append({"effect": name, "volts": volts, "about": f"{effect.about}{remark}", **stated})
    return sorted(rows, key=lambda row: -1.0 if row["volts"] is None else -row["volts"] - 1e3)


def _computed(switch: Mapping[str, Any], of_device: Collection[str]) -> Iterator[dict[str, Any]]:
    """What the answer varies beside properties of the device, and what its own points tell of its
    errors.
    """
    of_points = {"how": "computed", "source": HERE}
    by_law = [row["release_V"] for row in switch["by_attraction"] if row["release_V"] is not None]
    if by_law:
        yield {
            "effect": "law of attraction",
            "volts": max(by_law) - min(by_law),
            "about": (
                "a third to three times the work of adhesion"
                + "; it may stick" * (min(by_law) == 0.0)
            ),
            "held": False,
            "settle": "pull-off of the contact (target calibration)",
            **of_points,
        }
    if answer := switch["answer"]:
        wide = 2.0 * 1.645 * answer["release_V"]["std"]
        for row in answer["sensitivity"]:
            if row["name"] in of_device:
                continue
            seen = row["share_of_variance"] > answer["noise"]
            share = row["share_of_variance"] + answer["noise"] * (not seen)
            yield {
                "effect": row["name"],
                "volts": wide * float(np.sqrt(share)),
                "about": "5 to 95 %" if seen else "5 to 95 %; or less",
                "held": True,
                "settle": SETTLE[row["varies"]],
                **of_points,
            }
        yield {
            "effect": "number of cells",
            "volts": 2.0 * 1.645 * answer["cells_error_V"],
            "about": "5 to 95 %, of a point",
            "held": True,
            "settle": "more cells a point (pad.point_cells)",
            **of_points,
        }
        yield {
            "effect": "number of switches",
            "volts": answer["quantile_error_V"]["0.5"],
            "about": "standard error of the median",
            "held": False,
            "settle": "more switches (pad.points)",
            **of_points,
        }


def _numerical(errors_V: Mapping[str, float]) -> dict[str, Any]:
    """The numerical errors of the release, in quadrature."""
    volts = float(np.sqrt(np.nansum(np.square(list(errors_V.values())))))
    return {
        "effect": NUMERICAL,
        "volts": volts,
        "about": ", ".join(
            f"{name.partition(',')[0]} {error:.2g} V" for name, error in errors_V.items()
        ),
        "how": "computed",
        "held": False,
        "settle": "a finer grid; target accuracy tells which",
        "source": "answer/errors.csv",
    }


@dataclass(frozen=True)
class _Pressed:
    """The central pad, under the stated device and others.

    Attributes
    ----------
    states : of the stated device.
    """

    device: DeviceSettings
    pad: PadCurves
    states: States

    def release_V(self, device: DeviceSettings) -> float:
        """Release of a device."""
        return switch_of(device).states(self.pad).release_V

    def reach_V(self, *devices: DeviceSettings) -> tuple[float | None, str]:
        """From the least to the largest release of devices and the stated one, and a remark."""
        try:
            releases = [self.states.release_V, *map(self.release_V, devices)]
        except InputError as error:
            return None, f"; no answer: {str(error).partition(';')[0]}"
        return max(releases) - min(releases), "; it may stick" * (min(releases) == 0.0)


def _of_charge(pressed: _Pressed) -> dict[str, Any]:
    """The charge that the scene states, beside none."""
    volts, remark = pressed.reach_V(pressed.device.uncharged)
    return {
        "effect": "charge that the scene states",
        "volts": volts,
        "about": f"beside none, at central inputs{remark}",
        "how": "computed",
        "held": True,
        "settle": "shift and narrowing of the C–V curve",
        "source": "device.shift_V, charge_e_cm2 and uneven; solved again",
    }


def _of_device(pressed: _Pressed) -> Iterator[dict[str, Any]]:
    """The properties of the device that vary, each from 5 to 95 % with all else at its median."""
    for name, low, high in departed(pressed.device, 0.95):
        volts, remark = pressed.reach_V(low, high)
        yield {
            "effect": name,
            "volts": volts,
            "about": f"5 to 95 %, at central inputs{remark}",
            "how": "computed",
            "held": True,
            "settle": SETTLE[getattr(pressed.device.spread, name).varies],
            "source": f"device.spread.{name}; solved again",
        }


def _moved_V(
    effect: Effect, pressed: _Pressed, by_hardness: Mapping[float, float]
) -> tuple[float | None, str]:
    """By how much an effect moves the release of the central switch, and a remark."""
    device = pressed.device
    release = pressed.states.release_V
    if effect.hardness is not None:
        usual = by_hardness[1.0]
        other = by_hardness[effect.hardness]
        if not np.isfinite(usual - other):
            return None, "; no answer"
        return abs(other - usual), "; it may stick" * (other == 0.0)
    if effect.changes:
        return pressed.reach_V(*changed_devices(effect, device, pressed.states.pull_in_V))
    if effect.charge_e_cm2 is not None:
        density = effect.charge_e_cm2 * elementary_charge * 1e4
        return float(charge_shift(density, device.dielectric_nm, device.permittivity)), ""
    if effect.squared_V2 is not None:
        left = release**2 - effect.squared_V2
        return release - float(np.sqrt(max(left, 0.0))), "; it may stick" * (left <= 0.0)
    return effect.volts if effect.share is None else effect.share * release, ""


def changed_devices(
    effect: Effect, device: DeviceSettings, pull_in_V: float
) -> Iterator[DeviceSettings]:
    """The device with the property that an effect changes, and with the opposite change."""
    if effect.to:
        yield device.model_copy(update={effect.changes: effect.to})
        return
    value = value_of(device, effect.changes, pull_in_V)
    changed = value * effect.factor + effect.step
    if effect.of_own:
        changed += effect.of_own * gives_way(device)[effect.changes]
    yield device.model_copy(update={effect.changes: changed})
    if effect.either_way:
        yield device.model_copy(update={effect.changes: 2.0 * value - changed})


def gives_way(device: DeviceSettings) -> dict[str, float]:
    """What a beam itself gives way by, in the units of its anchors: L / (EA) and L / (EI)."""
    section_um2 = device.width_um * device.thickness_um
    inertia_um4 = section_um2 * device.thickness_um**2 / 12.0
    return {
        "anchor_um_per_N": 1e3 * device.length_um / (device.youngs_modulus_GPa * section_um2),
        "anchor_rad_per_uN_m": 1e3 * device.length_um / (device.bending_GPa * inertia_um4),
    }
