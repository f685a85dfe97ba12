"""A switch whose electrode bends: where it lands, how hard, and when it lets go.

The beam of `mesoscale.switch.beam` meets the pad place by place, and every place remembers its own
deepest closing. The landed area is a result. The way down is followed by the place that comes down
farthest, past pull-in to contact. From just beyond pull-in the beam creeps to the balance at the
hold voltage, as it snaps. Then the voltage is lowered until no place is in contact."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.errors import InputError, NotComputed
from mesoscale.pad.local import LocalPad
from mesoscale.pad.memory import PadLaw, attracting
from mesoscale.settings import DeviceSettings
from mesoscale.switch.beam import Beam, beam_of
from mesoscale.switch.beam_kernels import (
    BEYOND,
    CLOSING_NM,
    GPA,
    NM,
    OPENING_NM,
    SETTLED,
    UNSETTLED,
    add_loads,
    creep,
    least_gap_nm,
)
from mesoscale.switch.numerics import SWITCH
from mesoscale.switch.plate import VACUUM_PERMITTIVITY
from mesoscale.switch.pressing import never_closes

Array = NDArray[np.float64]

MOST_V = 1e4
"""Largest voltage that a scene may state; more pulls no switch."""
BESIDE = "place electrode nearer to contact, or take a softer beam"


@dataclass(frozen=True)
class BeamStates:
    """What the bending switch does.

    Attributes
    ----------
    pull_in_V, hold_V, release_V : voltages; release 0 where it sticks.
    landed_share : share of the contact part in contact while held.
    capacitance_fF : while held, of the bent beam as a plate over the pad, place by place.
    """

    pull_in_V: float
    hold_V: float
    release_V: float
    landed_share: float
    capacitance_fF: float


def solve_beam(
    settings: DeviceSettings,
    law: PadLaw,
    elements: int = SWITCH.elements,
    opening_nm: float = OPENING_NM,
    tolerance: float = SWITCH.release_tolerance,
) -> BeamStates:
    """Close the beam on a pad, hold it, and open it.

    Parameters
    ----------
    elements : of the beam.
    opening_nm : largest step of a place in contact on the way out.
    tolerance : relative error of the release.

    Raises
    ------
    NotComputed : the beam presses harder than the pad was computed for.
    InputError : the beam never lands, is not held, or is no beam.
    """
    return solve_bent(beam_of(settings, elements), settings, law, opening_nm, tolerance)


def solve_bent(
    beam: Beam,
    settings: DeviceSettings,
    law: PadLaw,
    opening_nm: float = OPENING_NM,
    tolerance: float = SWITCH.release_tolerance,
) -> BeamStates:
    """As `solve_beam`, of any beam."""
    moving = _Moving(beam, LocalPad(law), settings)
    pull_in = moving.snap_V()
    hold = settings.hold_voltage_V or pull_in
    if line := never_closes(settings, pull_in):
        raise InputError(line)
    closed = moving.creep(hold)
    share = moving.landed_share()
    if not closed or share == 0:
        raise InputError(
            f"device: at {hold:.4g} V the beam does not land on the pad (pull-in is at"
            f" {pull_in:.4g} V); raise hold_voltage_V or dimple_nm, or lower stopper_nm, gap_um,"
            " bow_nm or tilt_nm"
        )
    capacitance = moving.capacitance_F()
    return BeamStates(
        pull_in, hold, moving.open(hold, opening_nm, tolerance), share, capacitance * 1e15
    )


def free_pull_in_V(settings: DeviceSettings, elements: int = 64) -> float:
    """Pull-in of the beam over a bare dielectric.

    Raises
    ------
    InputError : it touches at rest.
    """
    return _Moving(beam_of(settings, elements), None, settings).snap_V()


def loop_fF(beam: Beam, settings: DeviceSettings, law: PadLaw, volts: Array) -> tuple[Array, Array]:
    """Capacitance (fF) while the voltage rises, and on its way back, at voltages from 0 to one that
    closes the beam.

    Raises
    ------
    NotComputed, InputError : see `solve_beam`.
    """
    pad = LocalPad(law)
    moving, free = (_Moving(beam, pad, settings) for _ in range(2))
    pull_in, up = moving.snap_V(), []
    for voltage in volts:
        if voltage < pull_in:
            for _ in range(SWITCH.free_steps):
                free.nodal = (
                    free.nodal
                    + free.beam.step(free.nodal, lambda s, at=voltage**2: free.load(s, at))[0]
                )
            up.append(free.capacitance_F())
        else:
            moving.creep(float(voltage))
            up.append(moving.capacitance_F())
    down = [
        moving.capacitance_F() if moving.creep(float(voltage), OPENING_NM) else opened
        for voltage, opened in zip(volts[::-1], up[::-1], strict=True)
    ]
    return 1e15 * np.array(up), 1e15 * np.array(down[::-1])


def closed_beam(
    settings: DeviceSettings, law: PadLaw, elements: int
) -> Callable[[float, float], bool]:
    """Whether the beam is still closed at a voltage with so many times the attraction, as a
    function of both.

    The beam is closed with its hold voltage, at least with that of its pull-in.

    Raises
    ------
    InputError : see `solve_beam`; the function raises NotComputed, too.
    """
    first = _Moving(beam_of(settings, elements), LocalPad(law), settings)
    hold = max(first.snap_V(), settings.hold_voltage_V or 0.0)
    bare = LocalPad(attracting(law, 0.0))

    def closed(voltage: float, times: float) -> bool:
        moving = _Moving(first.beam, first.local.attracting(times, bare), settings)
        moving.nodal = first.nodal.copy()
        return moving.creep(hold) and moving.creep(voltage, OPENING_NM)

    return closed


def press_GPa(settings: DeviceSettings, law: PadLaw, elements: int = SWITCH.elements) -> float:
    """Largest net pressure with which the beam presses a pad on its way to the held state.

    Raises
    ------
    NotComputed : the beam presses harder than the pad was computed for.
    InputError : the beam does not pull in.
    """
    moving = _Moving(beam_of(settings, elements), LocalPad(law), settings)
    moving.creep(max(moving.snap_V(), settings.hold_voltage_V or 0.0))
    return float(law.closing_GPa(moving.deepest.min()))


class _Moving:
    """A beam on a pad with what it remembers; without a pad it moves freely until it touches."""

    def __init__(self, beam: Beam, pad: LocalPad | None, settings: DeviceSettings):
        self.beam, self.pad = beam, pad
        self.dielectric_nm = settings.dielectric_nm / settings.permittivity
        self.flat_nm = 1e3 * settings.gap_um
        self.edge_per_nm = settings.fringe / (1e3 * settings.width_um)
        self.nodal = np.zeros((beam.elements + 1, 2))
        self.deepest = np.full(beam.rest_m.shape, np.inf)
        self.touch_nm = self.contact_nm = self.landed_GPa = 0.0
        if pad is None:
            return
        law = pad.law
        self.landed_GPa = SWITCH.landed * beam.spring_Pa / GPA
        touching = law.closing[0] > self.landed_GPa
        if not touching.any():
            raise NotComputed(
                f"device: the pad carries {law.closing[0].max() * 1e3:.3g} MPa at"
                f" {law.separation_nm[0]:.4g} nm, where its curves end; raise pad.cells, whose"
                " first ones say how far they are closed"
            )
        # the curve is of straight pieces: it repels up to the first separation at which it does not
        last = int(np.flatnonzero(law.closing[0] > 0)[-1])
        self.touch_nm = float(law.separation_nm[min(last + 1, law.separation_nm.size - 1)])
        self.contact_nm = float(law.separation_nm[touching].max())

    @property
    def local(self) -> LocalPad:
        """The pad, which is there."""
        assert self.pad is not None
        return self.pad

    def separation_nm(self) -> Array:
        """Local separations at the integration points."""
        return (self.beam.rest_m + self.beam.deflection_m(self.nodal)) / NM

    def electric(self, squared_V2: float) -> tuple[float, float, float, float]:
        """What `add_loads` takes of the voltage."""
        return self.dielectric_nm, squared_V2, VACUUM_PERMITTIVITY, self.edge_per_nm

    def load(self, separation_m: Array, squared_V2: float) -> tuple[Array, Array]:
        """Pressure (Pa) and slope (Pa/m) of pad, stoppers and voltage together."""
        s = separation_m / NM
        pressure, slope = np.zeros_like(s), np.zeros_like(s)
        if self.pad is not None:
            pressure, slope = self.pad(s - self.beam.dimple_nm, self.deepest)
        add_loads(s, pressure, slope, self.electric(squared_V2), self.beam.places)
        return pressure * GPA, slope * GPA / NM

    def pull_Pa(self) -> Array:
        """Electrostatic pull of 1 V."""
        s = self.separation_nm()
        pressure, slope, nowhere = np.zeros_like(s), np.zeros_like(s), np.ones_like(s)
        add_loads(s, pressure, slope, self.electric(1.0), (self.beam.wired, nowhere, 0.0, 0.0, 0.0))
        return pressure * GPA

    def pressure_GPa(self) -> Array:
        """Net pressure of the pad, 0 beside it."""
        return (
            self.beam.lands
            * self.local(self.separation_nm() - self.beam.dimple_nm, self.deepest)[0]
        )

    def landed_share(self) -> float:
        """Share of the contact part that is pushed."""
        pushed = self.pressure_GPa() > self.landed_GPa
        return float((pushed * self.beam.weights_m).sum() / self.beam.contact_m)

    def capacitance_F(self) -> float:
        """Of the beam as a row of plates, with the field at the sides."""
        gaps = (
            np.maximum(self.separation_nm() + self.dielectric_nm, least_gap_nm(self.dielectric_nm))
            * NM
        )
        width = self.beam.width_m
        sides = self.edge_per_nm / NM * np.log(np.pi * width / gaps)
        return float(
            VACUUM_PERMITTIVITY
            * width
            * (self.beam.wired * self.beam.weights_m * (1.0 / gaps + sides)).sum()
        )

    def beside_GPa(self) -> float:
        """Largest pressure on stoppers beside the pad."""
        _, lands, _, stopper_nm, stopper_GPa_nm = self.beam.places
        return float(
            (
                stopper_GPa_nm * (1.0 - lands) * np.maximum(stopper_nm - self.separation_nm(), 0.0)
            ).max()
        )

    def over_nm(self) -> Array:
        """Local separations over what the beam touches first: the pad, or stoppers beside it."""
        touched = np.where(
            self.beam.lands > 0, self.beam.dimple_nm + self.touch_nm, self.beam.stopper_nm
        )
        return self.separation_nm() - touched

    def leading(self) -> int:
        """The node that a small voltage brings down farthest."""
        _, per_V2 = self.beam.step(self.nodal, lambda s: self.load(s, 0.0), 0.0, self.pull_Pa())
        return int(np.argmin(per_V2[:, 0]))

    def snap_V(self) -> float:
        """Pull-in, the largest voltage on the way down; the beam is left just beyond, from where it
        snaps.

        A beam whose electrode stays far enough touches before it would snap. Its pull-in is the
        voltage at touch.

        Raises
        ------
        InputError : the beam rests in its pad.
        """
        if (over := float(self.over_nm().min())) <= 0.0:
            enough = 3.5e-3 * (
                self.flat_nm - over
            )  # a beam that only stretches snaps as low as at 1 / 3.3 of its gap
            raise InputError(
                f"device: the beam rests within reach of its pad; raise gap_um to {enough:.3g}, or"
                " bow_nm, or lower tilt_nm, dimple_nm or stopper_nm"
            )
        at = self.leading()
        way = float(self.over_nm()[max(at - 1, 0) : at + 1].mean())
        squared, kept, states = 0.0, [0.0], [self.nodal]
        for target in np.linspace(0.0, way, SWITCH.down)[1:]:
            more = wanted = np.inf
            for _ in range(30):
                change, per_V2 = self.beam.step(
                    self.nodal, lambda s, now=squared: self.load(s, now), 0.0, self.pull_Pa()
                )
                wanted = -target * NM - self.nodal[at, 0]
                more = (wanted - change[at, 0]) / per_V2[at, 0]
                self.nodal = self.nodal + change + more * per_V2
                squared += more
                if abs(more) < 1e-9 * abs(squared) and abs(wanted) < 1e-6 * NM:
                    break
            touches = self.over_nm().min() < 0.0 and abs(squared) < MOST_V**2
            # not to the last digit, as where it buckles, is enough; else it must touch or be beyond
            # the snap
            settled = abs(more) < 1e-3 * abs(squared) and abs(wanted) < 1e-2 * NM
            if not (settled or touches):
                if np.argmax(kept) == len(kept) - 1:
                    raise InputError(
                        f"device: no voltage brings the beam down by {target:.4g} nm; {BESIDE}"
                    )
                break
            kept.append(squared)
            states.append(self.nodal)
            if touches:
                break
        if max(kept) > MOST_V**2:
            raise InputError(
                f"device: more than {MOST_V:g} V are needed to pull the beam down; {BESIDE}"
            )
        top = int(np.argmax(kept))
        if top == len(kept) - 1:
            self.nodal = states[-2]
            return float(np.sqrt(kept[-1]))
        self.nodal = states[top + 1]
        # the top of a parabola through three equal steps
        a, b, c = kept[top - 1 : top + 2]
        return float(np.sqrt(b + (a - c) ** 2 / (8.0 * (2.0 * b - a - c))))

    def creep(self, voltage: float, most_nm: float = CLOSING_NM) -> bool:
        """Let the beam move to the balance at a voltage; whether it is then closed.

        Raises
        ------
        NotComputed : the balance is below the computed closing of the pad.
        InputError : no balance within the allowed number of steps.
        """
        over_pad = self.beam.rest_m[self.beam.lands > 0] / NM - self.beam.dimple_nm
        free = SWITCH.free_share * float(over_pad.min())
        ended = creep(
            self.nodal,
            self.deepest,
            self.beam.rest_m,
            self.beam.mechanics,
            self.beam.places,
            self.local.tables,
            self.electric(voltage**2),
            self.beam.spring_Pa,
            self.contact_nm,
            min(self.touch_nm, free),
            free,
            most_nm,
        )
        law = self.local.law
        if ended == BEYOND:
            raise NotComputed(
                f"device.hold_voltage_V = {voltage:.4g}: the beam presses the pad below"
                f" {law.separation_nm[0]:.4g} nm ({law.closing_GPa(law.separation_nm[0]) * 1e3:.3g}"
                " MPa), where its curves end"
            )
        if ended == UNSETTLED and (beside_GPa := self.beside_GPa()) > 0.0:
            raise InputError(
                f"device: at {voltage:.4g} V the electrode lands beside the contact part and"
                f" presses {beside_GPa:.3g} GPa on what stands there; raise stopper_nm or"
                f" dimple_nm, lower hold_voltage_V, or {BESIDE}"
            )
        if ended == UNSETTLED:
            raise InputError(
                f"device: the beam finds no balance at {voltage:.4g} V; this is a fault of the"
                " solver"
            )
        return ended == SETTLED

    def open(self, hold_V: float, opening_nm: float, tolerance: float) -> float:
        """Lower the voltage until the beam lets go; the release voltage (0: stuck).

        The voltage is halved in the longer steps of closing until it opens. These may tear off a
        little more than they should, so the way from the last voltage but one is gone again in
        short steps."""

        def lower(voltage: float) -> float:
            """Half, or none where it holds at little."""
            return 0.5 * voltage if voltage > SWITCH.little * hold_V else 0.0

        # an opening is elastic, so the state at a lower voltage is reached from any higher one
        closed: list[tuple[float, Array, Array]] = [
            (hold_V, self.nodal.copy(), self.deepest.copy())
        ]
        while (voltage := lower(closed[-1][0])) < closed[-1][0] and self.creep(voltage, CLOSING_NM):
            closed.append((voltage, self.nodal.copy(), self.deepest.copy()))
        high, *held = closed[-2:][0]
        self.nodal, self.deepest = (state.copy() for state in held)
        low = None
        while low is None or high - low > tolerance * high:
            voltage = lower(high) if low is None else 0.5 * (low + high)
            if self.creep(voltage, opening_nm):
                high, held = voltage, [self.nodal.copy(), self.deepest.copy()]
                if voltage == 0.0:
                    return 0.0
            else:
                low = voltage
                self.nodal, self.deepest = (state.copy() for state in held)
        return high
