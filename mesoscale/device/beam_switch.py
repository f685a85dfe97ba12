"""A switch whose electrode bends: where it lands, how hard, and when it lets go.

The beam of `mesoscale.device.beam` meets the pad place by place, and every place remembers its own deepest closing.
The landed area is a result. The way down is followed by the separation of mid-span, past pull-in to contact. From there
the beam creeps to the balance at the hold voltage, and then the voltage is lowered until no place is in contact.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.device.beam import NM, Beam, beam_of
from mesoscale.device.switch import GPA, VACUUM_PERMITTIVITY
from mesoscale.errors import InputError
from mesoscale.pad.local import LocalPad
from mesoscale.pad.memory import PadLaw
from mesoscale.settings import DeviceSettings

Array = NDArray[np.float64]

CONTACT_GPa = 1e-6
"""A place has landed where it is pushed with more than 1 kPa, a tenth of the pull of the default switch's spring."""
MOST_STEPS = 6000
LARGEST_STEP_NM = 20.0
"""Step of a place of the creeping beam that is far from contact; in contact `LARGEST_CHANGE_NM`."""
LARGEST_CHANGE_NM = 1.0
SHARE_OF_WAY = 0.25
"""A place that is about to land moves by this share of its way."""
SETTLED_NM = 1e-3
"""Last step of a beam in balance, a thousandth of the length over which the pressure of a pad changes."""
SETTLED_Pa = 1.0
"""Pressure that is then left over, a ten-thousandth of the spring's."""
VOLTAGE_STEPS = 40
RELEASE_TOLERANCE = 1e-3


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


def solve_beam(settings: DeviceSettings, law: PadLaw, elements: int = 64) -> BeamStates:
    """Close the beam on a pad, hold it, and open it.

    Raises
    ------
    InputError : the beam never lands, is not held, presses harder than the pad was computed for, or is no beam.
    """
    moving = _Moving(beam_of(settings, elements), LocalPad(law), settings.dielectric_nm / settings.permittivity)
    pull_in = moving.pull_in_V()
    hold = settings.hold_voltage_V or pull_in
    moving.voltage = hold
    moving.creep()
    share = moving.landed_share()
    if share == 0:
        raise InputError(
            f"device.hold_voltage_V = {hold:.4g}: the beam does not land (pull-in is at {pull_in:.4g} V); raise it, or "
            "lower gap_um, bow_nm or tilt_nm"
        )
    pressure = moving.pad(moving.separation_nm(), moving.deepest)[0]
    capacitance = moving.capacitance_F()
    release, at_release = moving.open()
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


class _Moving:
    """A beam on a pad with what it remembers."""

    def __init__(self, beam: Beam, pad: LocalPad, dielectric_nm: float):
        self.beam, self.pad, self.dielectric_nm = beam, pad, dielectric_nm
        self.nodal = np.zeros((beam.elements + 1, 2))
        self.deepest = np.full(beam.rest_m.shape, np.inf)
        self.voltage = 0.0

    def separation_nm(self) -> Array:
        """Local separations at the integration points."""
        return (self.beam.rest_m + self.beam.deflection_m(self.nodal)) / NM

    def pull_GPa(self, separation_nm: Array, squared_V2: float) -> Array:
        """Electrostatic pull; a place deeper than the dielectric allows counts as closed."""
        electric = np.maximum(separation_nm + self.dielectric_nm, 0.1 * self.dielectric_nm + 0.1) * NM
        return VACUUM_PERMITTIVITY * squared_V2 / (2.0 * electric**2) / GPA

    def load(self, separation_m: Array, squared_V2: float) -> tuple[Array, Array]:
        """Pressure (Pa) and slope (Pa/m) of pad and voltage together."""
        s = separation_m / NM
        pressure, slope = self.pad(s, self.deepest)
        pull = self.pull_GPa(s, squared_V2)
        softening = 2.0 * pull / np.maximum(s + self.dielectric_nm, 0.1 * self.dielectric_nm + 0.1)
        return (pressure - pull) * GPA, (slope + softening) * GPA / NM

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
                unit = -self.pull_GPa(self.separation_nm(), 1.0) * GPA
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

    def creep(self) -> None:
        """Let the beam move to the balance at its voltage, every place remembering how deep it came.

        The beam is held back by an added stiffness that grows where steps are too large: an overdamped motion.

        Raises
        ------
        InputError : no balance within the allowed number of steps.
        """
        inertia, least, last = 1e9, 0.0, np.zeros(len(self.nodal))
        law = self.pad.law
        contact = float(law.separation_nm[law.closing[0] > CONTACT_GPa].max())
        for _ in range(MOST_STEPS):
            change, _ = self.beam.step(self.nodal, lambda s: self.load(s, self.voltage**2), inertia)
            moved = self.beam.deflection_m(change) / NM
            s = self.separation_nm()
            allowed = np.clip(SHARE_OF_WAY * (s - contact), LARGEST_CHANGE_NM, LARGEST_STEP_NM)
            excess = float((np.abs(moved) / allowed).max())
            if excess > 1.0:
                inertia = max(min(max(1.2 * excess, 1.5), 10.0) * inertia, 1e6)
                if inertia < 1e25:
                    continue
            self.nodal = self.nodal + change
            self.deepest = np.minimum(self.deepest, self.separation_nm())
            self._refuse_beyond_the_pad()
            back = float((change[:, 0] * last).sum()) < 0.0
            last = change[:, 0]
            # the curves are of straight pieces, between which plain steps may cycle: hold back more after each turn
            least = max(10.0 * least, 1e9) if back else 0.7 * least
            if excess < 0.5 or back:
                inertia = max(0.3 * inertia, least)
            most = float(np.abs(moved).max())
            if most < SETTLED_NM and most * NM * inertia < SETTLED_Pa:
                return
        raise InputError(f"device: the beam finds no balance at {self.voltage:.4g} V; this is a fault of the solver")

    def _refuse_beyond_the_pad(self) -> None:
        law, lowest = self.pad.law, float(self.deepest.min())
        if lowest < law.separation_nm[0]:
            raise InputError(
                f"device.hold_voltage_V = {self.voltage:.4g}: the beam presses the pad below "
                f"{law.separation_nm[0]:.4g} nm ({law.closing_GPa(law.separation_nm[0]) * 1e3:.3g} MPa), where its "
                "curves end; raise pad.max_pressure_MPa, or lower the voltage"
            )

    def open(self) -> tuple[float, float]:
        """Lower the voltage until the beam lets go; the release voltage (0: stuck) and the share landed before."""
        high, share = self.voltage, self.landed_share()
        low = 0.0
        for voltage in np.linspace(high, 0.0, VOLTAGE_STEPS + 1)[1:]:
            before = self.nodal, self.deepest
            self.voltage = float(voltage)
            self.creep()
            if self.landed_share() == 0:
                low = self.voltage
                break
            high, share = self.voltage, self.landed_share()
        else:
            return 0.0, share
        while high - low > RELEASE_TOLERANCE * high:
            self.nodal, self.deepest = before
            self.voltage = 0.5 * (low + high)
            self.creep()
            if self.landed_share() == 0:
                low = self.voltage
            else:
                high, share, before = self.voltage, self.landed_share(), (self.nodal, self.deepest)
        return high, share
