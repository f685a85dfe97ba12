"""Does a beam touch, snap or collapse at the voltage that finite differences find?

Each device is brought down by its mean deflection, and not by the place that leads. All equations
are solved at once for the deflection, the axial force and the square of the voltage. So nothing is
shared with the product but the settings and the curves of the pad. `touches`: whether the largest
voltage is within a fortieth of the way to touch. The pad is made up; folders hold results of target
`answer`, whose pads at central inputs are taken, too.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_array, csc_matrix, diags
from scipy.sparse.linalg import splu

from evidence.circuit.loop import central_pad
from mesoscale.pad.curves import Flats, PadCurves
from mesoscale.pad.local import LocalPad
from mesoscale.settings import DeviceSettings
from mesoscale.studies.answer_stability import made_up_pad, published_beam
from mesoscale.switch.beam import beam_of
from mesoscale.switch.beam_motion import MovingBeam

Array = NDArray[np.float64]
EPS0 = 8.8541878128e-12
STEPS = 160
"""Mean deflections from rest to touch."""
STILL_M, STILL = 1e-11, 1e-6
"""Last step of a balance that has settled, and that of the voltage's square."""
MIDDLE: dict[str, Any] = {"electrode": (0.2, 0.8), "contact": (0.4, 0.6)}
TIP: dict[str, Any] = {"ends": "cantilever", "length_um": 250.0, "thickness_um": 3.0}
DEVICES: dict[str, dict[str, Any]] = {
    "default": {},
    "dimple 2800": {**MIDDLE, "dimple_nm": 2800.0},
    "dimple 3000": {**MIDDLE, "dimple_nm": 3000.0},
    "dimple 3200": {**MIDDLE, "dimple_nm": 3200.0},
    "dimple 3400": {**MIDDLE, "dimple_nm": 3400.0},
    "dimple that snaps": {**MIDDLE, "dimple_nm": 1000.0},
    "cantilever": TIP,
    "cantilever on a dimple": {
        **TIP,
        "electrode": (0.3, 0.8),
        "contact": (0.9, 1.0),
        "dimple_nm": 1500.0,
    },
    "cantilever, curled up": {
        **TIP,
        "bow_nm": 500.0,
        "electrode": (0.3, 0.8),
        "contact": (0.9, 1.0),
        "dimple_nm": 2500.0,
    },
    "electrode on one side": {
        "electrode": (0.1, 0.45),
        "contact": (0.4, 0.6),
        "dimple_nm": 2500.0,
    },
    "stopper first": {"electrode": (0.2, 0.5), "contact": (0.6, 0.8), "stopper_nm": 2600.0},
    "buckled up, -60 MPa": {"residual_stress_MPa": -60.0},
    "buckled up, -100 MPa": {"residual_stress_MPa": -100.0},
    "buckled up, -150 MPa": {"residual_stress_MPa": -150.0},
    "buckled down": {"residual_stress_MPa": -30.0, "buckled": "down"},
    "buckled down on a dimple": {
        **MIDDLE,
        "residual_stress_MPa": -30.0,
        "buckled": "down",
        "dimple_nm": 1800.0,
    },
    "tense": {"residual_stress_MPa": 200.0},
    "tilted": {"tilt_nm": 1700.0},
    "bowed up": {"bow_nm": 2000.0},
    "thin": {"thickness_um": 0.35},
}


def arguments(parser: ArgumentParser) -> None:
    """Results to take pads from."""
    parser.add_argument("results", nargs="*", type=Path)
    parser.add_argument("--nodes", type=int, default=400)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each pad and device."""
    pads = {"made up": pulling_pad()}
    for folder in given.results:
        pads[folder.name] = central_pad(folder)[1]
    for name, pad in pads.items():
        for case, changes in DEVICES.items():
            settings = published_beam(**changes)
            product = MovingBeam(beam_of(settings), settings, LocalPad(pad)).come_down()
            twin = Differences(settings, pad, given.nodes).pull_in()
            yield {
                "pad": name,
                "case": case,
                "pull_in_V": product.voltage,
                "touches": int(product.touches),
                "differences_V": twin[0],
                "differences_touch": int(twin[1]),
            }


def pulling_pad() -> PadCurves:
    """The made-up pad with the attraction of two flats, A_H = 0.05 aJ."""
    pad = made_up_pad(2.0)
    flats = Flats(0.05, 0.0)
    pull_GPa = -flats.pull_GPa(pad.separation_nm)
    closing = np.stack([pad.closing[0], pull_GPa])
    return replace(pad, closing=closing, flats=flats)


@dataclass
class Differences:
    """A beam over a pad by finite differences.

    Attributes
    ----------
    nodes : places that move; a cantilever's last one is its free end.
    """

    settings: DeviceSettings
    pad: PadCurves
    nodes: int = 400

    def __post_init__(self) -> None:
        given = self.settings
        self.free = given.ends == "cantilever"
        steps = self.nodes if self.free else self.nodes + 1
        self.h = given.length_um * 1e-6 / steps
        self.share = np.arange(1, self.nodes + 1) / steps
        width, thick = given.width_um * 1e-6, given.thickness_um * 1e-6
        modulus = given.youngs_modulus_GPa * 1e9
        wide = given.bends_as == "plate" or (given.bends_as is None and width >= 5 * thick)
        plate = modulus / (1 - given.poisson_ratio**2) if wide else modulus
        self.width = width
        self.bending = plate * width * thick**3 / 12
        stretched = given.length_um * 1e-6 / (modulus * width * thick)
        stretched += given.anchor_um_per_N * 1e-6
        self.stretching = 0.0 if self.free else 1 / stretched
        stress = given.residual_stress_MPa * 1e6 * (1 - given.poisson_ratio)
        self.tension = 0.0 if self.free else stress * width * thick
        self.shape = given.shape_at_rest_nm(self.share) * 1e-9
        self.rest = given.gap_um * 1e-6 + self.shape
        self.lands = self._within(given.contact)
        self.wired = self._within(given.electrode)

    def _within(self, part: tuple[float, float]) -> Array:
        """1 in a part of the beam, 0 beside it; what of a cell is in it at its ends."""
        half = 0.5 / (self.nodes if self.free else self.nodes + 1)
        low = np.maximum(self.share - half, part[0])
        high = np.minimum(self.share + half, part[1])
        return np.clip((high - low) / (2 * half), 0.0, 1.0)

    @cached_property
    def touched(self) -> Array:
        """Separations at which places touch (m)."""
        repelled = np.flatnonzero(self.pad.closing[0] > 0)[-1] + 1
        touch_nm = float(self.pad.separation_nm[repelled])
        over_pad = self.settings.dimple_nm + touch_nm
        return 1e-9 * np.where(self.lands > 0.5, over_pad, self.settings.stopper_nm)

    @cached_property
    def fourth(self) -> Any:
        """Fourth difference; ends are clamped or free."""
        bands = np.zeros((self.nodes, self.nodes))
        for offset, weight in zip((-2, -1, 0, 1, 2), (1.0, -4.0, 6.0, -4.0, 1.0), strict=True):
            bands += weight * np.eye(self.nodes, k=offset)
        bands[0, 0] = 7.0
        if self.free:
            bands[-2, -4:] = [1.0, -4.0, 5.0, -2.0]
            bands[-1, -4:] = [0.0, 2.0, -4.0, 2.0]
        else:
            bands[-1, -1] = 7.0
        return csc_matrix(bands / self.h**4)

    @cached_property
    def second(self) -> Any:
        """Second difference between ends at rest."""
        bands = np.eye(self.nodes, k=-1) - 2.0 * np.eye(self.nodes) + np.eye(self.nodes, k=1)
        return csc_matrix(bands / self.h**2)

    def electric(self, separation: Array) -> tuple[Array, Array]:
        """Pull per length of 1 V^2, and its derivative."""
        gap = separation + self.settings.dielectric_nm * 1e-9 / self.settings.permittivity
        edge = self.settings.fringe / self.width
        per = 0.5 * EPS0 * self.width * self.wired
        return per * (1 / gap**2 + edge / gap), -per * (2 / gap**3 + edge / gap**2)

    def attraction(self, separation: Array) -> tuple[Array, Array]:
        """Pull of the pad per length, and its derivative."""
        over_nm = 1e9 * separation - self.settings.dimple_nm

        def pull(at_nm: Array) -> Array:
            near = np.interp(at_nm, self.pad.separation_nm, -self.pad.closing[1])
            far = self.pad.flats.pull_GPa(at_nm)
            return np.where(at_nm > self.pad.separation_nm[-1], far, near)

        slope = (pull(over_nm + 0.05) - pull(over_nm - 0.05)) / 0.1
        per = self.lands * self.width
        return per * 1e9 * pull(over_nm), per * 1e18 * slope

    def balance(self, mean: float, state: Array) -> Array:
        """Deflections (m), axial force (N) and V^2 at a mean deflection, from those nearby."""
        for _ in range(60):
            w, force, squared = state[:-2], state[-2], state[-1]
            q, q_slope = self.electric(self.rest + w)
            a, a_slope = self.attraction(self.rest + w)
            curve = self.second @ (w + self.shape)
            left = self.bending * (self.fourth @ w) + squared * q + a
            matrix = self.bending * self.fourth + diags(squared * q_slope + a_slope)
            if not self.free:
                # what it carried at rest was in balance with its shape at rest
                left -= force * curve - self.tension * (self.second @ self.shape)
                matrix = matrix - force * self.second
            grown = -self.stretching * self.h * curve
            force_left = force - self.tension
            if not self.free:
                force_left -= self.stretching * self._longer(w)
            mean_left = w.mean() - mean
            columns = np.column_stack([0 * curve if self.free else -curve, q])
            border = np.vstack([-grown, np.full(w.size, 1 / w.size)])
            corner = np.array([[1.0, 0.0], [0.0, 0.0]])
            whole = block_array(
                [[matrix, csc_matrix(columns)], [csc_matrix(border), csc_matrix(corner)]]
            )
            change = -splu(csc_matrix(whole)).solve(np.concatenate([left, [force_left, mean_left]]))
            state = state + change
            settled = np.abs(change[:-2]).max() < STILL_M
            if settled and abs(change[-1]) <= STILL * abs(state[-1]):
                return state
        raise AssertionError(f"no balance at a mean deflection of {mean}")

    def _longer(self, w: Array) -> float:
        """Elongation by the slopes between places."""
        at_rest, moved = np.pad(self.shape, 1), np.pad(w + self.shape, 1)
        return float(0.5 * (np.diff(moved) ** 2 - np.diff(at_rest) ** 2).sum() / self.h)

    def at_rest(self) -> Array:
        """The state without voltage: buckled to its side beyond Euler's load."""
        length = self.settings.length_um * 1e-6
        euler = 4 * np.pi**2 * self.bending / length**2
        if self.free or -self.tension <= euler:
            return np.concatenate([np.zeros(self.nodes), [self.tension, 0.0]])
        strain = (-self.tension - euler) / (self.stretching * length)
        height = 2 * length / np.pi * np.sqrt(strain)
        side = 1.0 if self.settings.buckled == "up" else -1.0
        w = side * height * 0.5 * (1 - np.cos(2 * np.pi * self.share))
        return np.concatenate([w, [-euler, 0.0]])

    def pull_in(self) -> tuple[float, bool]:
        """Largest voltage on the way to touch, and whether it is at its end."""
        state = self.at_rest()
        clear = float((self.rest + state[:-2] - self.touched).min())
        start = float(state[:-2].mean())
        way: list[Array] = [state]
        step = 1.2 * clear / STEPS
        mean = start
        for _ in range(20 * STEPS):
            mean -= step
            try:
                lower = self.balance(mean, way[-1])
            except (AssertionError, RuntimeError):
                break
            if (self.rest + lower[:-2] - self.touched).min() < 0:
                way += self._to_touch(way[-1], mean + step, step)
                break
            way.append(lower)
        squares = np.array([each[-1] for each in way])
        top = int(np.argmax(squares))
        shares = np.array([(self.rest + each[:-2] - self.touched).min() for each in way]) / clear
        touches = bool(shares[top] < 1 / 40)
        if 0 < top < len(way) - 1:
            means = [way[k][:-2].mean() for k in (top - 1, top, top + 1)]
            curve = np.polynomial.Polynomial.fit(means, squares[top - 1 : top + 2], 2)
            best = curve(curve.deriv().roots()[0])
            return float(np.sqrt(best)), touches
        return float(np.sqrt(squares[top])), touches

    def _to_touch(self, above: Array, mean: float, step: float) -> list[Array]:
        """Small steps from the last state above touch, halved until they end there."""
        found: list[Array] = []
        piece = step / 40
        while piece > 1e-13:
            lower = self.balance(mean - piece, found[-1] if found else above)
            if (self.rest + lower[:-2] - self.touched).min() < 0:
                piece *= 0.5
                continue
            mean -= piece
            found.append(lower)
        return found


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """The largest difference, and how many touch."""
    apart = [abs(float(row["pull_in_V"]) / float(row["differences_V"]) - 1) for row in table]
    alike = sum(row["touches"] == row["differences_touch"] for row in table)
    return {
        "devices": str(len(table)),
        "largest": f"{max(apart):.2%}",
        "alike": f"{alike} of {len(table)}",
    }
