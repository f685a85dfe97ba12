"""Does the formula of uneven charge hold on a bending beam, and up to which width of its patches?

Square patches of normal charge cover the default beam. Every place of the beam is pulled by its own
mean over the width of (V - V_s)^2: release and pull-in are then found by voltage after voltage. The
formula has the mean and the variance of the same patches, as even and as coarse charge. Patches are
wider than the gap at rest, so that both charges are felt as they are.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.pad.curves import deepened
from mesoscale.pad.local import LocalPad
from mesoscale.settings import DeviceSettings
from mesoscale.studies.answer_stability import made_up_pad, published_beam
from mesoscale.switch import switch_of
from mesoscale.switch.beam import beam_of
from mesoscale.switch.beam_kernels import CLOSING_NM, OPENING_NM
from mesoscale.switch.beam_motion import MovingBeam
from mesoscale.switch.charge import PER_CM2
from mesoscale.theory.charging import charge_shift

Array = NDArray[np.float64]
PATCHES_UM = (2.0, 5.0, 10.0, 20.0, 40.0, 80.0, 160.0, 320.0)
WELL_KPA = 40.0
DEVIATION_V = 4.0
HELD = 1.1
"""Hold voltage over pull-in, so that all patched beams land."""
STEPS = 12
"""Halvings of the range of a release or pull-in."""


def arguments(parser: ArgumentParser) -> None:
    """How many beams of each patch."""
    parser.add_argument("--draws", type=int, default=12)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each patch and draw."""
    plain = published_beam()
    pad = deepened(made_up_pad(WELL_KPA))
    hold_V = HELD * switch_of(plain).states(pad).pull_in_V
    for patch_um in PATCHES_UM:
        for draw in range(given.draws):
            rng = np.random.default_rng([draw, int(patch_um)])
            patched = PatchedBeam(plain, LocalPad(pad), patch_um, rng)
            pull_in_V, release_V = patched.volts(hold_V)
            alike = like(plain, hold_V, patched.mean_V, patched.variance_V2)
            states = switch_of(alike).states(pad)
            yield {
                "patch_um": patch_um,
                "draw": draw,
                "mean_V": patched.mean_V,
                "deviation_V": float(np.sqrt(patched.variance_V2)),
                "pull_in_V": pull_in_V,
                "formula_pull_in_V": states.pull_in_V,
                "release_V": release_V,
                "formula_release_V": states.release_V,
            }


def like(plain: DeviceSettings, hold_V: float, mean_V: float, variance_V2: float) -> DeviceSettings:
    """The device with the mean and the variance as even and as coarse charge."""
    volt = charge_shift(PER_CM2, plain.dielectric_nm, plain.permittivity)
    coarse = {"waves": [(1e9, np.sqrt(variance_V2) / volt)]}
    return published_beam(shift_V=mean_V, uneven=coarse, hold_voltage_V=hold_V)


class PatchedBeam(MovingBeam):
    """A beam whose places feel the shifts of the patches below them.

    Attributes
    ----------
    mean_V, variance_V2 : of the shift over the area.
    """

    def __init__(
        self, settings: DeviceSettings, pad: LocalPad, patch_um: float, rng: np.random.Generator
    ) -> None:
        super().__init__(beam_of(settings), settings, pad)
        along = int(np.ceil(settings.length_um / patch_um)) + 1
        across = int(np.ceil(settings.width_um / patch_um)) + 1
        shifts_V = DEVIATION_V * rng.standard_normal((along, across))
        offset_um = patch_um * rng.random(2)
        edges_um = np.clip(np.arange(across + 1) * patch_um - offset_um[1], 0.0, settings.width_um)
        shares = np.diff(edges_um) / settings.width_um
        at = ((1e6 * self.beam.at_m + offset_um[0]) / patch_um).astype(int)
        self.local_V = (shifts_V @ shares)[at]
        self.local_V2 = (shifts_V**2 @ shares)[at]
        weights = self.beam.weights_m / self.beam.weights_m.sum()
        self.mean_V = float((weights * self.local_V).sum())
        self.variance_V2 = float((weights * self.local_V2).sum()) - self.mean_V**2
        _ = self.beam.mechanics

    def creep(self, voltage: float, longest_nm: float = CLOSING_NM) -> bool:
        """As of a beam without patches, each place with the pull of its own."""
        pulls_V2 = voltage**2 - 2.0 * voltage * self.local_V + self.local_V2
        other = replace(self.beam, wired=pulls_V2)
        other.__dict__["mechanics"] = self.beam.mechanics
        self.beam = other
        return super().creep(1.0, longest_nm)

    def volts(self, hold_V: float) -> tuple[float, float]:
        """Pull-in from rest, and release from the hold."""
        open_nodal = self.nodal.copy()
        low_V, high_V = 0.5 * hold_V, hold_V
        for _ in range(STEPS):
            middle_V = 0.5 * (low_V + high_V)
            self.nodal = open_nodal.copy()
            self.deepest_nm[:] = np.inf
            closes = self.creep(middle_V)
            low_V, high_V = (low_V, middle_V) if closes else (middle_V, high_V)
        pull_in_V = 0.5 * (low_V + high_V)
        self.nodal = open_nodal.copy()
        self.deepest_nm[:] = np.inf
        if not self.creep(hold_V):
            return pull_in_V, np.nan
        return pull_in_V, self.release_V(hold_V, OPENING_NM, 1e-3)


def figures(rows: list[dict[str, str]]) -> dict[str, str]:
    """Root mean square errors of the formula by the patch."""
    said = {}
    for patch_um in PATCHES_UM:
        of_patch = [row for row in rows if float(row["patch_um"]) == patch_um]
        for name in ("release", "pull_in"):
            errors = [float(row[f"{name}_V"]) - float(row[f"formula_{name}_V"]) for row in of_patch]
            said[f"{name}_{patch_um:g}"] = f"{np.sqrt(np.nanmean(np.square(errors))):.2f} V"
    return said
