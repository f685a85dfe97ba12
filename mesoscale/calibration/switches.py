"""Pull-in and release voltages as the inputs predict them, for many inputs at once.

The switch is a plate on a spring (`mesoscale.device.plate`) on the law of one cell: W(s) = V^2 is the voltage that
balances spring and contact at the separation s. While it opens, the contact acts on the share of a bent beam that comes
off last. Release is the lowest point of W between the repulsive wall and the barrier; it is kept with its sign, so that
a switch that sticks lies below zero by as much as its spring lacks.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.observables import LAWS, Observable
from mesoscale.calibration.responses import Prediction
from mesoscale.device.plate import GPA, NM, VACUUM_PERMITTIVITY, Plate, plate_from_settings
from mesoscale.device.spread import departed
from mesoscale.law.compact import Law
from mesoscale.law.parameters import PARAMETERS
from mesoscale.law.samples import column, onset_nm, pressure_GPa
from mesoscale.settings import DeviceSettings

Array = NDArray[np.float64]

ONE_DEVIATION = 0.841345
"""Probability of a normal number one standard deviation out."""
TOUCH_NM = 20.0
"""Separation at the last touch, of films of 4 to 6 nm RMS; a release depends on it through the electric gap alone."""
INNER, OUTER = 120, 60
"""Separations in and beyond contact; release is then within 1e-3 of that on a fine grid (tests)."""


@dataclass(frozen=True)
class SwitchModel:
    """The switch on the laws that responses predict.

    Attributes
    ----------
    switch, cells : cells that a landed switch averages.
    last_share : share of the electrode that comes off last; 1 of a plate on a given spring.
    scatter_V : of pull-in and release, by what all devices share and by what differs between them (V).
    """

    switch: Plate
    last_share: float
    cells: float
    scatter_V: Mapping[str, tuple[float, float]]

    @classmethod
    def of(cls, device: DeviceSettings, cell_area_nm2: float) -> "SwitchModel":
        """The switch that the settings describe.

        A clamped beam held down at mid-span has the curvature 24 g / L^2 there, so what comes off last are the places
        within a distance x of mid-span with 12 g x^2 / L^2 below the range of adhesion: a share sqrt(range / (3 g)).
        """
        switch, last_share = plate_from_settings(device), 1.0
        if device.bends:
            last_share = min(float(np.sqrt(Law.rho_a_nm / (3.0 * switch.gap_nm))), 1.0)
        cells = max(last_share * switch.area_m2 * 1e18 / cell_area_nm2, 1.0)
        return cls(switch, last_share, cells, device_scatter_V(device))

    def path_V2(self, separation_nm: Array, law: Law, share: float) -> Array:
        """W(s) with the law on a share of the electrode; below zero where adhesion holds it without any voltage."""
        contact = share * self.switch.area_m2 * pressure_GPa(separation_nm, law) * GPA
        return self.switch.balancing_V2(separation_nm, self.switch.spring_force_N(separation_nm) + contact)

    def laws(self, values: Array, hamaker: Array) -> tuple[Law, Law]:
        """Laws of closing and opening from values (m, 8) of the observables LAWS."""
        count = len(PARAMETERS)
        laws = [
            Law(**dict(zip(PARAMETERS, part.T, strict=True)), hamaker=hamaker)
            for part in (values[:, :count], values[:, count:])
        ]
        return laws[0], laws[1]

    def release_V(self, opening: Law) -> Array:
        """Release voltages with sign: below zero by the square root of what keeps a stuck switch closed, shape (m,)."""
        law = column(opening)
        d_c, onset = np.asarray(law.d_c_nm), onset_nm(law)
        depth = np.minimum(12 * np.asarray(law.rho_r_nm), d_c + 0.9 * self.switch.dielectric_nm)
        inner = d_c - np.maximum(depth, 1e-6) * np.linspace(1, 0, INNER) ** 2
        near = d_c + (onset - d_c) * np.linspace(0, 1, 25)[1:]
        grid = np.concatenate([inner, near, self._outside(onset)], axis=1)
        path = self.path_V2(grid, law, self.last_share)
        wall = np.argmax(np.where(grid <= d_c, path, -np.inf), axis=1)
        barrier = np.argmax(np.where(grid >= onset, path, -np.inf), axis=1)
        places = np.arange(grid.shape[1])
        between = (places >= wall[:, None]) & (places <= barrier[:, None])
        return signed_root(np.where(between, path, np.inf).min(axis=1))

    def pull_in_V(self, closing: Law) -> Array:
        """Pull-in voltages, shape (m,)."""
        law = column(closing)
        grid = self._outside(onset_nm(law))
        return signed_root(self.path_V2(grid, law, 1.0).max(axis=1))

    def _outside(self, onset: Array) -> Array:
        """Separations from the onset of contact to rest, with the fold of an ideal plate among them, shape (m, p)."""
        thin = self.switch.dielectric_nm
        ratio = (self.switch.gap_nm + thin) / (onset + thin)
        far = (onset + thin) * ratio ** np.linspace(0, 1, OUTER)[1:] - thin
        fold = np.clip(np.full_like(onset, (2 * self.switch.gap_nm - thin) / 3), onset, self.switch.gap_nm)
        return np.sort(np.concatenate([far, fold], axis=1), axis=1)


def device_scatter_V(device: DeviceSettings) -> dict[str, tuple[float, float]]:
    """Standard deviations of pull-in and release by departures of the device, common to all and of each (V).

    Each property departs alone by one standard deviation to either side; the release is that without adhesion.
    """

    def voltages(switch: Plate) -> dict[str, float]:
        electric = (TOUCH_NM + switch.dielectric_nm) * NM
        spring = switch.spring_N_per_m * (switch.gap_nm - TOUCH_NM) * NM
        release = np.sqrt(2.0 * spring * electric**2 / (VACUUM_PERMITTIVITY * switch.area_m2))
        return {"pull_in": switch.pull_in_V, "release": float(release)}

    squares = {"pull_in": {"common": 0.0, "each": 0.0}, "release": {"common": 0.0, "each": 0.0}}
    for name, *devices in departed(device, ONE_DEVIATION):
        low, high = (voltages(plate_from_settings(moved)) for moved in devices)
        for kind, by in squares.items():
            by[getattr(device.spread, name).varies] += (0.5 * (high[kind] - low[kind])) ** 2
    return {kind: (float(np.sqrt(by["common"])), float(np.sqrt(by["each"]))) for kind, by in squares.items()}


def signed_root(squares: Array) -> Array:
    """Square root of the size with the sign."""
    return np.sign(squares) * np.sqrt(np.abs(squares))


def law_values(prediction: Prediction, observables: Sequence[Observable] = LAWS) -> Array:
    """Means over random surfaces of the law's parameters, in their units, shape (m, 8)."""
    is_log = np.array([row.scale != "length" for row in observables])
    half_variance = 0.5 * np.einsum("mkk->mk", prediction.scatter)
    return np.where(is_log, np.exp(np.where(is_log, prediction.mean + half_variance, 0.0)), prediction.mean)
