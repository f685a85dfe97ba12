"""A beam that moves over a pad: where it lands, and when it lets go.

The beam of `mesoscale.switch.beam` meets the pad place by place, and every place remembers its own
deepest closing. The landed area is a result. The way down is followed by the place that comes down
farthest, past pull-in to contact. From just beyond pull-in the beam creeps to the balance at the
hold voltage, as it snaps. Then the voltage is lowered until no place is in contact.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from mesoscale.errors import InputError, NotComputed
from mesoscale.pad.local import LocalPad
from mesoscale.settings import DeviceSettings
from mesoscale.switch.beam import Beam
from mesoscale.switch.beam_kernels import (
    BEYOND,
    CLOSING_NM,
    SETTLED,
    UNEVEN_NM,
    UNEVEN_STEP,
    UNSETTLED,
    add_loads,
    creep,
    least_gap_nm,
)
from mesoscale.switch.charge import uneven_V2
from mesoscale.units import GPA, NM, VACUUM_PERMITTIVITY

Array = NDArray[np.float64]

LANDED_SHARE = 0.066
"""Of the pull of the spring (`Beam.spring_Pa`): a place that is pushed with more has landed. It is
1 kPa of the default switch."""
OFF_SHARE = 0.5
"""Of the separation at rest: a beam that is nowhere lower is off its pad. It pulls in from two
thirds."""
STEPS_DOWN = 81
"""Separations of the way down, from rest to touch."""
PIECES = (1, 4, 16)
"""Into which a step down is cut, one after the other, until it settles."""
LEAP = 20.0
"""Times as far as the node that is brought down, no other moves on the same way."""
TOUCH_NM = 1e-3
"""How well the touch is found."""
SMALL_STEPS = 32
"""Of the last of the way to touch."""
NEWTON_STEPS = 30
"""At most, to each step."""
FREE_STEPS = 12
"""At least, to the balance of a free beam from that of the voltage before."""
MOST_FREE_STEPS = 100
"""At most; near pull-in the steps converge slowly."""
STILL_NM = 1e-3
"""Last step of a free beam that has settled: of a gap of 3 um it moves the capacitance by 1e-6."""
UNHELD_SHARE = 0.05
"""Of the hold voltage: a beam that is still closed at less is tried without any."""
MOST_V = 1e4
"""Largest voltage that a scene may state; more pulls no switch."""
NOTHING_UNEVEN = np.empty(0)
BESIDE = "place electrode nearer to contact, or take a softer beam"


class PullIn(NamedTuple):
    """How the open beam closes while the voltage rises.

    Attributes
    ----------
    voltage : at which it snaps, or touches.
    touches : whether it touches before it would snap.
    """

    voltage: float
    touches: bool


class _Lowered(NamedTuple):
    """A balance of the open beam, with a node so far below rest."""

    down_nm: float
    squared_V2: float
    nodal: Array


class _Held(NamedTuple):
    """A closed beam at one voltage."""

    voltage: float
    nodal: Array
    deepest_nm: Array


class MovingBeam:
    """A beam on a pad with what it remembers; without a pad it moves freely until it touches.

    Attributes
    ----------
    nodal : its deflection (m) and slope at the nodes, shape (nodes, 2).
    deepest_nm : how near each place came to the mean plane of the pad, shape (elements, points).
    """

    def __init__(self, beam: Beam, settings: DeviceSettings, pad: LocalPad | None = None) -> None:
        self.beam = beam
        self.pad = pad
        self.dielectric_nm = settings.dielectric_gap_nm
        self.flat_nm = 1e3 * settings.gap_um
        self.edge_per_nm = settings.fringe / (1e3 * settings.width_um)
        self.uneven_V2 = _table_of_uneven(settings, float(beam.rest_m.max()) / NM)
        self.nodal = np.zeros((beam.elements + 1, 2))
        self.deepest_nm = np.full(beam.rest_m.shape, np.inf)
        self.touch_nm = 0.0
        self.contact_nm = 0.0
        self.landed_GPa = 0.0
        if pad is not None:
            self._take_up(pad)

    def _take_up(self, pad: LocalPad) -> None:
        """The separations at which a place touches the pad, and has landed on it."""
        curves = pad.curves
        repulsion = curves.closing[0]
        self.landed_GPa = LANDED_SHARE * self.beam.spring_Pa / GPA
        landed = repulsion > self.landed_GPa
        if not landed.any():
            raise NotComputed(
                f"device: the pad carries {repulsion.max() * 1e3:.3g} MPa at"
                f" {curves.separation_nm[0]:.4g} nm, where its curves end; raise pad.cells, whose"
                " first ones say how far they are closed"
            )
        # the curve is of straight pieces: it repels up to the first separation at which it does not
        last = int(np.flatnonzero(repulsion > 0)[-1])
        first_free = min(last + 1, curves.separation_nm.size - 1)
        self.touch_nm = float(curves.separation_nm[first_free])
        self.contact_nm = float(curves.separation_nm[landed].max())

    @property
    def landed_on(self) -> LocalPad:
        """The pad, which is there."""
        assert self.pad is not None
        return self.pad

    def separation_nm(self) -> Array:
        """Local separations at the integration points."""
        return (self.beam.rest_m + self.beam.deflection_m(self.nodal)) / NM

    def _electric(self, squared_V2: float) -> tuple[float, float, float, float, Array]:
        """What `add_loads` takes of the voltage, and of uneven charge."""
        return (
            self.dielectric_nm,
            squared_V2,
            VACUUM_PERMITTIVITY,
            self.edge_per_nm,
            self.uneven_V2,
        )

    def load(self, separation_m: Array, squared_V2: float) -> tuple[Array, Array]:
        """Pressure (Pa) and slope (Pa/m) of pad, stoppers and voltage together."""
        separation_nm = separation_m / NM
        if self.pad is None:
            pressure = np.zeros_like(separation_nm)
            slope = np.zeros_like(separation_nm)
        else:
            pressure, slope = self.pad(separation_nm - self.beam.dimple_nm, self.deepest_nm)
        add_loads(separation_nm, pressure, slope, self._electric(squared_V2), self.beam.places)
        return pressure * GPA, slope * GPA / NM

    def _free_load(self, separation_m: Array, squared_V2: float) -> tuple[Array, Array]:
        """As `load`, of a beam that nothing stops: places below touch are loaded as at touch."""
        return self.load(np.maximum(separation_m, self._touched_nm() * NM), squared_V2)

    def _pull_Pa(self) -> Array:
        """Electrostatic pull of 1 V."""
        separation_nm = self.separation_nm()
        pressure = np.zeros_like(separation_nm)
        slope = np.zeros_like(separation_nm)
        without_pad = (self.beam.wired, np.ones_like(separation_nm), 0.0, 0.0, 0.0)
        of_one_volt = (*self._electric(1.0)[:-1], NOTHING_UNEVEN)
        add_loads(separation_nm, pressure, slope, of_one_volt, without_pad)
        return pressure * GPA

    def landed_share(self) -> float:
        """Share of the contact part that is pushed."""
        height_nm = self.separation_nm() - self.beam.dimple_nm
        pressure_GPa = self.beam.lands * self.landed_on(height_nm, self.deepest_nm)[0]
        pushed = pressure_GPa > self.landed_GPa
        return float((pushed * self.beam.weights_m).sum() / self.beam.contact_m)

    def capacitance_fF(self) -> float:
        """Of the beam as a row of plates, with the field at the sides."""
        least_nm = least_gap_nm(self.dielectric_nm)
        gaps_m = np.maximum(self.separation_nm() + self.dielectric_nm, least_nm) * NM
        width_m = self.beam.width_m
        sides = self.edge_per_nm / NM * np.log(np.pi * width_m / gaps_m)
        lengths = self.beam.wired * self.beam.weights_m * (1.0 / gaps_m + sides)
        return 1e15 * float(VACUUM_PERMITTIVITY * width_m * lengths.sum())

    def _beside_GPa(self) -> float:
        """Largest pressure on stoppers beside the pad."""
        _, lands, _, stopper_nm, stopper_GPa_nm = self.beam.places
        pressed_nm = np.maximum(stopper_nm - self.separation_nm(), 0.0)
        return float((stopper_GPa_nm * (1.0 - lands) * pressed_nm).max())

    def _above_nm(self) -> Array:
        """Local separations over what the beam touches first: the pad, or stoppers beside it."""
        return self.separation_nm() - self._touched_nm()

    def _touched_nm(self) -> Array:
        """Local separations at which the beam touches the pad, or stoppers beside it."""
        over_pad = self.beam.dimple_nm + self.touch_nm
        return np.where(self.beam.lands > 0, over_pad, self.beam.stopper_nm)

    def _leading(self) -> int:
        """The node that a small voltage brings down farthest.

        Raises
        ------
        InputError : a small voltage brings none down.
        """
        _, per_V2 = self.beam.step(self.nodal, lambda s: self.load(s, 0.0), 0.0, self._pull_Pa())
        node = int(np.argmin(per_V2[:, 0]))
        if per_V2[node, 0] >= 0.0 and self.uneven_V2.size:
            raise self._collapse()
        if per_V2[node, 0] >= 0.0:
            raise InputError(
                "device: a small voltage does not bring the beam down, since it does not rest"
                " stably where it is; raise thickness_um or residual_stress_MPa, or state its"
                " bow_nm at rest"
            )
        return node

    def relax(self, voltage: float) -> None:
        """Plain Newton steps to the balance at a voltage, from the state at hand.

        Raises
        ------
        NotComputed : they do not settle, as just below pull-in.
        """
        moved_nm = np.inf
        for step in range(MOST_FREE_STEPS):
            if step >= FREE_STEPS and moved_nm < STILL_NM:
                return
            change, _ = self.beam.step(self.nodal, lambda s: self.load(s, voltage**2))
            self.nodal = self.nodal + change
            moved_nm = float(np.abs(change[:, 0]).max()) / NM
        raise NotComputed(
            f"device: the free beam does not settle at {voltage:.6g} V, too near its pull-in"
        )

    def come_down(self, steps: int = STEPS_DOWN) -> PullIn:
        """Bring the open beam down, and leave it where it snaps or touches.

        A beam snaps at the largest voltage of its way down, and is left just beyond it. One whose
        electrode stays far enough away touches before it would snap, and is left where it touches.
        So does one that the attraction of its pad takes over the last steps of its way.

        Parameters
        ----------
        steps : separations of the way; fewer where devices are only compared.

        Raises
        ------
        InputError : the beam rests in its pad, the pad alone pulls it down, or no voltage does.
        """
        self._check_rest()
        node = self._leading()
        way, reaches = self._way_down(node, steps)
        top = _highest(way)
        touches = reaches and top >= len(way) - 2
        if touches:
            # attraction may turn the way in the last nanometres before touch
            way = self._again(node, way[max(top - 1, 0)], way[-1])
            top = _highest(way)
        if top == 0:
            raise self._collapse()
        squares_V2 = [state.squared_V2 for state in way]
        if squares_V2[top] > MOST_V**2:
            raise InputError(
                f"device: more than {MOST_V:g} V are needed to pull the beam down; {BESIDE}"
            )
        if top == len(way) - 1:
            self.nodal = way[top].nodal
            return PullIn(float(np.sqrt(squares_V2[top])), touches)
        self.nodal = way[top + 1].nodal
        return PullIn(float(np.sqrt(_vertex(*squares_V2[top - 1 : top + 2]))), touches)

    def _collapse(self) -> InputError:
        """That nothing but a voltage is needed to pull the beam down."""
        pulls = "uneven charge" if self.uneven_V2.size else "attraction alone"
        return InputError(
            f"device: {pulls} pulls the beam down onto its pad, without any voltage (collapse);"
            " raise gap_um or thickness_um, or lower length_um"
        )

    def _way_down(self, node: int, steps: int) -> tuple[list[_Lowered], bool]:
        """Balances while a node is brought down from rest; whether the last of them touches.

        Raises
        ------
        InputError : the way ends before it either turns or touches.
        """
        height_nm = float(self._above_nm()[max(node - 1, 0) : node + 1].mean())
        downs_nm = np.linspace(0.0, height_nm, steps)
        # the lowest place may be a little higher than those around the node
        downs_nm = np.append(downs_nm, height_nm + downs_nm[1])
        way = [_Lowered(0.0, 0.0, self.nodal)]
        for down_nm in downs_nm[1:].tolist():
            state = self._lower(node, down_nm, way[-1])
            if state is None:
                break
            if self._above_nm().min() < 0.0:
                way.append(self._touch(node, way[-1], state))
                return way, True
            way.append(state)
        if _highest(way) == len(way) - 1:
            raise _unreachable(way[-1].down_nm)
        return way, False

    def _lower(self, node: int, down_nm: float, above: _Lowered) -> _Lowered | None:
        """Bring a node down from a balance above; None where no balance is found.

        A step that does not settle, or leaps to another way, is gone again in smaller ones.
        """
        for pieces in PIECES:
            state = above
            self.nodal = above.nodal
            for target_nm in np.linspace(above.down_nm, down_nm, pieces + 1)[1:].tolist():
                squared_V2, settled = self._bring_down(node, target_nm, state.squared_V2)
                moved_nm = float(np.abs(self.nodal - state.nodal)[:, 0].max()) / NM
                if not settled or moved_nm > LEAP * max(target_nm - state.down_nm, TOUCH_NM):
                    break
                state = _Lowered(target_nm, squared_V2, self.nodal)
            else:
                return state
        return None

    def _touch(self, node: int, above: _Lowered, below: _Lowered) -> _Lowered:
        """The balance at which the beam just touches, between one above and one below it."""

        def lowest_nm(down_nm: float) -> float:
            self._lowered(node, down_nm, above)
            return float(self._above_nm().min())

        ends_nm = above.down_nm, below.down_nm
        if lowest_nm(ends_nm[0]) <= 0.0:
            return above
        if lowest_nm(ends_nm[1]) >= 0.0:
            return below
        down_nm = float(np.asarray(brentq(lowest_nm, *ends_nm, xtol=TOUCH_NM)))
        return self._lowered(node, down_nm, above)

    def _again(self, node: int, above: _Lowered, below: _Lowered) -> list[_Lowered]:
        """The way from one balance to a lower one in small steps."""
        way = [above]
        for down_nm in np.linspace(above.down_nm, below.down_nm, SMALL_STEPS + 1)[1:].tolist():
            way.append(self._lowered(node, down_nm, way[-1]))
        return way

    def _lowered(self, node: int, down_nm: float, above: _Lowered) -> _Lowered:
        """As `_lower`, where a balance must be.

        Raises
        ------
        InputError : none is found.
        """
        state = self._lower(node, down_nm, above)
        if state is None:
            raise _unreachable(down_nm)
        return state

    def _check_rest(self) -> None:
        """Refuse a beam that rests in its pad."""
        above_nm = float(self._above_nm().min())
        if above_nm > 0.0:
            return
        # a beam that only stretches snaps as low as at 1 / 3.3 of its gap
        enough_um = 3.5e-3 * (self.flat_nm - above_nm)
        raise InputError(
            f"device: the beam rests within reach of its pad; raise gap_um to {enough_um:.3g}, or"
            " bow_nm, or lower tilt_nm, dimple_nm or stopper_nm"
        )

    def _bring_down(self, node: int, down_nm: float, squared_V2: float) -> tuple[float, bool]:
        """Bring a node down by a distance from rest; the square of the voltage that does so.

        Whether it is settled comes second: not to the last digit, as where the beam buckles, is
        enough.
        """
        more_V2 = np.inf
        missing_m = np.inf
        for _ in range(NEWTON_STEPS):
            change, per_V2 = self.beam.step(
                self.nodal, lambda s, now=squared_V2: self._free_load(s, now), 0.0, self._pull_Pa()
            )
            missing_m = -down_nm * NM - self.nodal[node, 0]
            more_V2 = (missing_m - change[node, 0]) / per_V2[node, 0]
            self.nodal = self.nodal + change + more_V2 * per_V2
            squared_V2 += more_V2
            if abs(more_V2) < 1e-9 * abs(squared_V2) and abs(missing_m) < 1e-6 * NM:
                break
        settled = abs(more_V2) < 1e-3 * abs(squared_V2) and abs(missing_m) < 1e-2 * NM
        return squared_V2, settled

    def creep(self, voltage: float, longest_nm: float = CLOSING_NM) -> bool:
        """Let the beam move to the balance at a voltage; whether it is then closed.

        Parameters
        ----------
        longest_nm : largest step of a place in contact.

        Raises
        ------
        NotComputed : the balance is below the computed closing of the pad.
        InputError : no balance within the allowed number of steps.
        """
        over_pad_nm = self.beam.rest_m[self.beam.lands > 0] / NM - self.beam.dimple_nm
        off_nm = OFF_SHARE * float(over_pad_nm.min())
        outcome = creep(
            self.nodal,
            self.deepest_nm,
            self.beam.rest_m,
            self.beam.mechanics,
            self.beam.places,
            self.landed_on.tables,
            self._electric(voltage**2),
            self.beam.spring_Pa,
            self.contact_nm,
            min(self.touch_nm, off_nm),
            off_nm,
            longest_nm,
        )
        if outcome == BEYOND:
            curves = self.landed_on.curves
            end_nm = curves.separation_nm[0]
            raise NotComputed(
                f"device.hold_voltage_V = {voltage:.4g}: the beam presses the pad below"
                f" {end_nm:.4g} nm ({curves.closing_GPa(end_nm) * 1e3:.3g} MPa), where its curves"
                " end"
            )
        if outcome == UNSETTLED:
            self._refuse(voltage)
        return outcome == SETTLED

    def _refuse(self, voltage: float) -> None:
        """Why the beam finds no balance at a voltage."""
        beside_GPa = self._beside_GPa()
        if beside_GPa > 0.0:
            raise InputError(
                f"device: at {voltage:.4g} V the electrode lands beside the contact part and"
                f" presses {beside_GPa:.3g} GPa on what stands there; raise stopper_nm or"
                f" dimple_nm, lower hold_voltage_V, or {BESIDE}"
            )
        raise InputError(
            f"device: the beam finds no balance at {voltage:.4g} V; this is a fault of the solver"
        )

    def still_held(self, voltage: float, longest_nm: float, least_fF: float) -> bool:
        """Whether the beam is closed in the balance at a voltage, with this capacitance at least;
        see `creep`.
        """
        return self.creep(voltage, longest_nm) and self.capacitance_fF() >= least_fF

    def release_V(
        self, hold_V: float, opening_nm: float, tolerance: float, least_fF: float = 0.0
    ) -> float:
        """Lower the voltage from the held state until the beam lets go; 0 where it sticks.

        The voltage is halved in the longer steps of closing until it opens. These may tear off a
        little more than they should, so the way from the last voltage but one is gone again in
        short steps.

        Parameters
        ----------
        opening_nm : largest step of a place in contact.
        tolerance : relative error.
        least_fF : capacitance below which it counts as let go.
        """
        held = self._halved(hold_V, least_fF)
        low_V = None
        while low_V is None or held.voltage - low_V > tolerance * held.voltage:
            if low_V is None:
                voltage = _lower_V(held.voltage, hold_V)
            else:
                voltage = 0.5 * (low_V + held.voltage)
            if self.still_held(voltage, opening_nm, least_fF):
                held = self._state(voltage)
                if voltage == 0.0:
                    return 0.0
            else:
                low_V = voltage
                self._return_to(held)
        return held.voltage

    def _halved(self, hold_V: float, least_fF: float) -> _Held:
        """Halve the voltage until the beam opens, and return to the last voltage but one.

        An opening is elastic, so the state at a lower voltage is reached from any higher one.
        """
        closed = [self._state(hold_V)]
        while True:
            before_V = closed[-1].voltage
            voltage = _lower_V(before_V, hold_V)
            if voltage >= before_V or not self.still_held(voltage, CLOSING_NM, least_fF):
                break
            closed.append(self._state(voltage))
        last_but_one = closed[-2:][0]
        self._return_to(last_but_one)
        return last_but_one

    def _state(self, voltage: float) -> _Held:
        return _Held(voltage, self.nodal.copy(), self.deepest_nm.copy())

    def _return_to(self, held: _Held) -> None:
        self.nodal = held.nodal.copy()
        self.deepest_nm = held.deepest_nm.copy()


def _table_of_uneven(settings: DeviceSettings, farthest_nm: float) -> Array:
    """What uneven charge adds to the square of the voltage, at the separations of `add_loads`.

    It is empty without such charge.
    """
    if settings.uneven is None:
        return NOTHING_UNEVEN
    count = int(np.arcsinh(farthest_nm / UNEVEN_NM) / UNEVEN_STEP) + 2
    return uneven_V2(settings, UNEVEN_NM * np.sinh(UNEVEN_STEP * np.arange(count)))


def _lower_V(voltage: float, hold_V: float) -> float:
    """Half of a voltage, or none where little holds the beam."""
    return 0.5 * voltage if voltage > UNHELD_SHARE * hold_V else 0.0


def _unreachable(down_nm: float) -> InputError:
    return InputError(f"device: no voltage brings the beam down beyond {down_nm:.4g} nm; {BESIDE}")


def _highest(way: list[_Lowered]) -> int:
    """Position of the balance with the largest voltage."""
    return int(np.argmax([state.squared_V2 for state in way]))


def _vertex(before: float, top: float, after: float) -> float:
    """Height of the parabola through three equal steps."""
    return top + (before - after) ** 2 / (8.0 * (2.0 * top - before - after))
