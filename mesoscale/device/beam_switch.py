"""A switch whose electrode bends: where it lands, how hard, and when it lets go.

The beam of `mesoscale.device.beam` meets the pad place by place, and every place remembers its own deepest closing.
The landed area is a result. The way down is followed by the separation of mid-span, past pull-in to contact. From there
the beam creeps to the balance at the hold voltage, and then the voltage is lowered until no place is in contact.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.device.beam import Beam, beam_of
from mesoscale.device.beam_kernels import BEYOND, GPA, NM, SETTLED, UNSETTLED, add_voltage, creep
from mesoscale.device.switch import VACUUM_PERMITTIVITY
from mesoscale.errors import InputError, NotComputed
from mesoscale.pad.local import LocalPad
from mesoscale.pad.memory import PadLaw, attracting
from mesoscale.settings import DeviceSettings

Array = NDArray[np.float64]

CONTACT_GPa = 1e-6
"""A place has landed where it is pushed with more than 1 kPa, a tenth of the pull of the default switch's spring."""
RELEASE_TOLERANCE = 1e-3
ELEMENTS = 128
"""The last places that adhesion holds are some 5 um long: release is within 0.4 % of that of 1024 elements.
Close to sticking it is within 0.2 V of that of 512, where with 64 elements a switch sticks that opens at 0.7 V. The
attraction that sticks is known to 1 to 4 %."""
NEWTON = 12
"""Steps to the balance of a free beam, each from that of the voltage before."""
FREE_SHARE = 0.5
"""Off the pad is a beam that is nowhere below this share of its separation at rest; it pulls in from two thirds."""


@dataclass(frozen=True)
class BeamStates:
    """What the bending switch does.

    Attributes
    ----------
    pull_in_V, hold_V, release_V : voltages; release 0 where it sticks.
    stuck : whether it stays closed without voltage.
    landed_share : share of the electrode in contact while held.
    landed_at_release : share in contact just before it lets go (at 0 V where it sticks).
    largest_MPa : largest contact pressure of any place while held.
    capacitance_fF : while held, of the bent beam as a plate over the pad, place by place.
    """

    pull_in_V: float
    hold_V: float
    release_V: float
    stuck: bool
    landed_share: float
    landed_at_release: float
    largest_MPa: float
    capacitance_fF: float


def solve_beam(settings: DeviceSettings, law: PadLaw, elements: int = ELEMENTS) -> BeamStates:
    """Close the beam on a pad, hold it, and open it.

    Raises
    ------
    NotComputed : the beam presses harder than the pad was computed for.
    InputError : the beam never lands, is not held, or is no beam.
    """
    return solve_bent(beam_of(settings, elements), settings, law)


def solve_bent(beam: Beam, settings: DeviceSettings, law: PadLaw) -> BeamStates:
    """As `solve_beam`, of any beam."""
    moving = _Moving(beam, LocalPad(law), settings.dielectric_nm / settings.permittivity)
    pull_in = moving.pull_in_V()
    hold = settings.hold_voltage_V or pull_in
    closed = moving.creep(hold)
    share = moving.landed_share()
    if not closed or share == 0:
        raise InputError(
            f"device.hold_voltage_V = {hold:.4g}: the beam does not land (pull-in is at {pull_in:.4g} V); raise it, or "
            "lower gap_um, bow_nm or tilt_nm"
        )
    pressure = moving.pad(moving.separation_nm(), moving.deepest)[0]
    capacitance = moving.capacitance_F()
    release, at_release = moving.open(hold)
    return BeamStates(
        pull_in,
        hold,
        release,
        release == 0.0,
        share,
        at_release,
        float(pressure.max()) * 1e3,
        capacitance * 1e15,
    )


def loop_fF(beam: Beam, settings: DeviceSettings, law: PadLaw, volts: Array) -> tuple[Array, Array]:
    """Capacitance (fF) while the voltage rises, and on its way back, at voltages from 0 to one that closes the beam.

    Raises
    ------
    NotComputed, InputError : see `solve_beam`.
    """
    pad = LocalPad(law)
    moving, free = (_Moving(beam, pad, settings.dielectric_nm / settings.permittivity) for _ in range(2))
    pull_in, up = moving.pull_in_V(), []
    for voltage in volts:
        if voltage < pull_in:
            for _ in range(NEWTON):
                free.nodal = free.nodal + free.beam.step(free.nodal, lambda s, at=voltage**2: free.load(s, at))[0]
            up.append(free.capacitance_F())
        else:
            moving.creep(float(voltage))
            up.append(moving.capacitance_F())
    down = [
        moving.capacitance_F() if moving.creep(float(voltage)) else opened
        for voltage, opened in zip(volts[::-1], up[::-1], strict=True)
    ]
    return 1e15 * np.array(up), 1e15 * np.array(down[::-1])


def closed_beam(settings: DeviceSettings, law: PadLaw, elements: int = ELEMENTS) -> Callable[[float, float], bool]:
    """Whether the beam is still closed at a voltage with so many times the attraction, as a function of both.

    The beam is closed with its hold voltage, at least with that of its pull-in.

    Raises
    ------
    InputError : see `solve_beam`; the function raises NotComputed, too.
    """
    first = _Moving(beam_of(settings, elements), LocalPad(law), settings.dielectric_nm / settings.permittivity)
    hold = max(first.pull_in_V(), settings.hold_voltage_V or 0.0)
    bare = LocalPad(attracting(law, 0.0))

    def closed(voltage: float, times: float) -> bool:
        moving = _Moving(first.beam, first.pad.attracting(times, bare), first.dielectric_nm)
        moving.nodal = first.nodal.copy()
        return moving.creep(hold) and moving.creep(voltage)

    return closed


def press_GPa(settings: DeviceSettings, law: PadLaw, elements: int = ELEMENTS) -> float:
    """Largest net pressure with which the beam presses a pad on its way to the held state.

    Raises
    ------
    NotComputed : the beam presses harder than the pad was computed for.
    InputError : the beam does not pull in.
    """
    moving = _Moving(beam_of(settings, elements), LocalPad(law), settings.dielectric_nm / settings.permittivity)
    moving.creep(max(moving.pull_in_V(), settings.hold_voltage_V or 0.0))
    return float(law.closing_GPa(moving.deepest.min()))


class _Moving:
    """A beam on a pad with what it remembers."""

    def __init__(self, beam: Beam, pad: LocalPad, dielectric_nm: float):
        self.beam, self.pad, self.dielectric_nm = beam, pad, dielectric_nm
        self.nodal = np.zeros((beam.elements + 1, 2))
        self.deepest = np.full(beam.rest_m.shape, np.inf)
        law = pad.law
        touching = law.closing[0] > CONTACT_GPa
        if not touching.any():
            raise NotComputed(
                f"device: the pad carries {law.closing[0].max() * 1e3:.3g} MPa at {law.separation_nm[0]:.4g} nm, where "
                "its curves end; raise pad.cells, whose first ones say how far they are closed"
            )
        self.contact_nm = float(law.separation_nm[touching].max())

    def separation_nm(self) -> Array:
        """Local separations at the integration points."""
        return (self.beam.rest_m + self.beam.deflection_m(self.nodal)) / NM

    def load(self, separation_m: Array, squared_V2: float) -> tuple[Array, Array]:
        """Pressure (Pa) and slope (Pa/m) of pad and voltage together."""
        s = separation_m / NM
        pressure, slope = self.pad(s, self.deepest)
        add_voltage(s, pressure, slope, self.dielectric_nm, squared_V2, VACUUM_PERMITTIVITY)
        return pressure * GPA, slope * GPA / NM

    def pull_Pa(self) -> Array:
        """Electrostatic pull of 1 V."""
        s = self.separation_nm()
        pressure, slope = np.zeros_like(s), np.zeros_like(s)
        add_voltage(s, pressure, slope, self.dielectric_nm, 1.0, VACUUM_PERMITTIVITY)
        return pressure * GPA

    def landed_share(self) -> float:
        """Share of the electrode that is pushed."""
        pushed = self.pad(self.separation_nm(), self.deepest)[0] > CONTACT_GPa
        return float((pushed * self.beam.weights_m).sum() / self.beam.length_m)

    def capacitance_F(self) -> float:
        """Of the beam as a row of plates."""
        gaps = (self.separation_nm() + self.dielectric_nm) * NM
        return float(VACUUM_PERMITTIVITY * self.beam.width_m * (self.beam.weights_m / gaps).sum())

    def pull_in_V(self) -> float:
        """Largest voltage on the way down, by lowering mid-span; the beam is left just above contact.

        Raises
        ------
        InputError : the beam closes without snapping.
        """
        middle = self.beam.elements // 2
        rest = float(self.separation_nm()[middle].mean())
        law = self.pad.law
        touch = float(law.separation_nm[law.closing[0] > 0].max())
        steps = np.linspace(rest, 0.25 * rest, 61)[1:]
        near = np.geomspace(steps[-1], touch + 5.0, 40)[1:]
        squared, kept = 0.0, []
        for target in rest - np.concatenate([steps, near]):
            for _ in range(30):
                unit = self.pull_Pa()
                change, per_V2 = self.beam.step(self.nodal, lambda s, at=squared: self.load(s, at), 0.0, unit)
                wanted = -target * NM - self.nodal[middle, 0]
                more = (wanted - change[middle, 0]) / per_V2[middle, 0]
                self.nodal = self.nodal + change + more * per_V2
                squared += more
                if abs(more) < 1e-9 * abs(squared) and abs(wanted) < 1e-6 * NM:
                    break
            kept.append(squared)
            if self.separation_nm().min() < touch:
                break
        top = int(np.argmax(kept[: steps.size]))
        if not 0 < top < steps.size - 1 or top + 1 >= len(kept):
            raise InputError(
                "device: the beam touches the dielectric before it pulls in; lower bow_nm, tilt_nm or "
                "residual_stress_MPa, or raise gap_um"
            )
        # the top of a parabola through three equal steps
        a, b, c = kept[top - 1 : top + 2]
        return float(np.sqrt(b + (a - c) ** 2 / (8.0 * (2.0 * b - a - c))))

    def creep(self, voltage: float) -> bool:
        """Let the beam move to the balance at a voltage; whether it is then closed.

        Raises
        ------
        NotComputed : the balance is below the computed closing of the pad.
        InputError : no balance within the allowed number of steps.
        """
        ended = creep(
            self.nodal,
            self.deepest,
            self.beam.rest_m,
            self.beam.mechanics,
            self.pad.tables,
            (self.dielectric_nm, voltage**2, VACUUM_PERMITTIVITY),
            self.contact_nm,
            FREE_SHARE * float(self.beam.rest_m.min()) / NM,
        )
        law = self.pad.law
        if ended == BEYOND:
            raise NotComputed(
                f"device.hold_voltage_V = {voltage:.4g}: the beam presses the pad below "
                f"{law.separation_nm[0]:.4g} nm ({law.closing_GPa(law.separation_nm[0]) * 1e3:.3g} MPa), where its "
                "curves end"
            )
        if ended == UNSETTLED:
            raise InputError(f"device: the beam finds no balance at {voltage:.4g} V; this is a fault of the solver")
        return ended == SETTLED

    def open(self, hold_V: float) -> tuple[float, float]:
        """Lower the voltage until the beam lets go; the release voltage (0: stuck) and the share landed before."""
        held = self.nodal.copy(), self.deepest.copy()
        if self.creep(0.0):
            return 0.0, self.landed_share()
        high, low = hold_V, 0.0
        self.nodal, self.deepest = held[0].copy(), held[1].copy()
        share = self.landed_share()
        while high - low > RELEASE_TOLERANCE * high:
            # an opening is elastic, so the state at a lower voltage is reached from any higher one
            self.nodal, self.deepest = held[0].copy(), held[1].copy()
            voltage = 0.5 * (low + high)
            if self.creep(voltage):
                high, share, held = voltage, self.landed_share(), (self.nodal.copy(), self.deepest.copy())
            else:
                low = voltage
        return high, share
