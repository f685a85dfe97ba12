"""A switch whose electrode bends: how hard it presses a pad, and what it does there."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mesoscale.errors import InputError, NotComputed
from mesoscale.pad.curves import PadCurves, attracting, continued
from mesoscale.pad.local import LocalPad
from mesoscale.settings import DeviceSettings
from mesoscale.switch.beam import COARSE_ELEMENTS, ELEMENTS, Beam, beam_of
from mesoscale.switch.beam_kernels import CLOSING_NM, OPENING_NM
from mesoscale.switch.beam_motion import MovingBeam, PullIn
from mesoscale.switch.switch import States, Switch, never_closes

Array = NDArray[np.float64]

FREE_ELEMENTS = 64
"""Of a beam without a pad, which pulls in the same with half as many."""
RELEASE_TOLERANCE = 1e-3
"""Relative error of a release."""


@dataclass(frozen=True)
class BeamStates(States):
    """What the bending switch does on one pad; its capacitance is that of the bent beam as a plate
    over the pad, place by place.

    Attributes
    ----------
    hold_V : voltage while held closed.
    landed_share : share of the contact part in contact while held.
    """

    hold_V: float = np.nan
    landed_share: float = np.nan


class BeamSwitch(Switch):
    """A beam, clamped or cantilever.

    Parameters
    ----------
    beam : of elements or of lumps; None: of `ELEMENTS`.
    opening_nm : largest step of a place in contact on the way out.
    tolerance : relative error of the release.
    """

    def __init__(
        self,
        settings: DeviceSettings,
        beam: Beam | None = None,
        opening_nm: float = OPENING_NM,
        tolerance: float = RELEASE_TOLERANCE,
    ) -> None:
        super().__init__(settings)
        self.beam = beam_of(settings) if beam is None else beam
        self.opening_nm = opening_nm
        self.tolerance = tolerance

    @classmethod
    def from_settings(cls, settings: DeviceSettings, coarse: bool) -> "BeamSwitch":
        """The beam of these settings, with `COARSE_ELEMENTS` or `ELEMENTS`."""
        elements = COARSE_ELEMENTS if coarse else ELEMENTS
        return cls(settings, beam_of(settings, elements))

    @cached_property
    def pull_in(self) -> PullIn:
        """How it closes over a bare dielectric.

        Raises
        ------
        InputError : no voltage pulls it in.
        """
        return MovingBeam(beam_of(self.settings, FREE_ELEMENTS), self.settings).come_down()

    @property
    def pull_in_V(self) -> float:
        """Pull-in over a bare dielectric; see `pull_in`."""
        return self.pull_in.voltage

    @property
    def never_closes(self) -> str:
        """One line on a hold voltage that never closes it on any pad; else empty.

        A beam that touches before it snaps touches a high pad earlier than a bare dielectric, so
        that only its pad tells.
        """
        if self.pull_in.touches and self.settings.hold_voltage_V is not None:
            return ""
        return never_closes(self.settings, *self.pull_in)

    def pressed_GPa(self, pad: PadCurves) -> float:
        """Largest net pressure on a pad on the way to the held state, its curves continued as far
        as that goes.

        It is 0 for a pad that is closed so near to its mean plane that nothing deeper can be
        planned, and for a beam that does not pull in: its states have the reason.
        """
        deepest = continued(pad)
        try:
            moving = self._on(LocalPad(deepest))
            moving.creep(self._most_V(moving.come_down().voltage))
            return float(deepest.closing_GPa(moving.deepest_nm.min()))
        except NotComputed:
            end_nm = deepest.separation_nm[0]
            return float(deepest.closing_GPa(end_nm)) if end_nm < pad.separation_nm[0] else 0.0
        except InputError:
            return 0.0

    def states_on(self, pad: PadCurves) -> BeamStates:
        """Close the beam on a pad, hold it, and open it.

        Raises
        ------
        NotComputed : the beam presses harder than the pad was computed for.
        InputError : the beam never lands, or is not held.
        """
        moving = self._on(LocalPad(pad))
        pull_in_V, touches = moving.come_down()
        if line := never_closes(self.settings, pull_in_V, touches):
            raise InputError(line)
        hold_V = self.settings.hold_voltage_V or pull_in_V
        closed = moving.creep(hold_V)
        landed_share = moving.landed_share()
        if not closed or landed_share == 0:
            raise InputError(
                f"device: at {hold_V:.4g} V the beam does not land on the pad (pull-in is at"
                f" {pull_in_V:.4g} V); raise hold_voltage_V or dimple_nm, or lower stopper_nm,"
                " gap_um, bow_nm or tilt_nm"
            )
        capacitance_fF = moving.capacitance_fF()  # before it opens
        return BeamStates(
            pull_in_V=pull_in_V,
            capacitance_fF=capacitance_fF,
            release_V=moving.release_V(
                hold_V, self.opening_nm, self.tolerance, self.held_share * capacitance_fF
            ),
            touches=touches,
            hold_V=hold_V,
            landed_share=landed_share,
        )

    def held(self, pad: PadCurves) -> MovingBeam:
        """The beam on a pad, while its voltage holds it.

        Raises
        ------
        NotComputed, InputError : see `states_on`.
        """
        moving = self._on(LocalPad(pad))
        pull_in_V = moving.come_down().voltage
        moving.creep(self.settings.hold_voltage_V or pull_in_V)
        return moving

    def held_nm(self, pad: PadCurves) -> tuple[Array, Array]:
        """See `Switch.held_nm`; without a dimple, whose place is as its pad."""
        moving = self.held(pad)
        separation_nm = moving.separation_nm()
        electric_nm = np.maximum(separation_nm, 0.0) + self.settings.dielectric_gap_nm
        pulls = self.beam.wired * self.beam.weights_m / electric_nm**2
        return separation_nm - self.beam.dimple_nm, pulls / pulls.sum()

    def closed_on(self, pad: PadCurves, quickly: bool = False) -> Callable[[float, float], bool]:
        """Whether the closed beam is still closed at a voltage, with so many times the attraction
        of the pad; a function of both.

        The beam is closed with its hold voltage, at least with that of its pull-in. Pressures are
        linear in the attraction, so that the tables of the pad are made once.

        Parameters
        ----------
        quickly : it opens in the steps of closing, which moves the logarithm of the attraction that
            it bears by 0.03 at most (24 switches of `ci`).

        Raises
        ------
        InputError : see `states_on`; the function raises NotComputed, too.
        """
        opening_nm = CLOSING_NM if quickly else OPENING_NM
        local = LocalPad(pad)
        bare = LocalPad(attracting(pad, 0.0))
        snapped = self._on(local)
        close_V = self._most_V(snapped.come_down().voltage)

        def still_closed(voltage: float, times: float) -> bool:
            moving = self._on(local.attracting(times, bare))
            moving.nodal = snapped.nodal.copy()
            if not moving.creep(close_V):
                return False
            held_fF = self.held_share * moving.capacitance_fF()
            return moving.still_held(voltage, opening_nm, held_fF)

        return still_closed

    def loop_fF(self, pad: PadCurves, volts: Array) -> tuple[Array, Array]:
        """Capacitance (fF) while the voltage rises, and on its way back.

        Parameters
        ----------
        volts : from 0 to one that closes the beam.

        Raises
        ------
        NotComputed, InputError : see `states_on`.
        """
        local = LocalPad(pad)
        closing = self._on(local)
        free = self._on(local)
        pull_in_V = closing.come_down().voltage
        rising = []
        for voltage in volts.tolist():
            if voltage < pull_in_V:
                free.relax(voltage)
                rising.append(free.capacitance_fF())
            else:
                closing.creep(voltage)
                rising.append(closing.capacitance_fF())
        falling = []
        for voltage, opened_fF in zip(volts[::-1].tolist(), rising[::-1], strict=True):
            closed = closing.creep(voltage, OPENING_NM)
            falling.append(closing.capacitance_fF() if closed else opened_fF)
        return np.array(rising), np.array(falling[::-1])

    def _on(self, pad: LocalPad) -> MovingBeam:
        """The beam at rest over a pad."""
        return MovingBeam(self.beam, self.settings, pad)

    def _most_V(self, pull_in_V: float) -> float:
        """Largest voltage on the way to the held state."""
        return max(pull_in_V, self.settings.hold_voltage_V or 0.0)
