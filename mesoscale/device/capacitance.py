"""Capacitance of the switch in its two states, with the roughness of the contact."""

import numpy as np

from mesoscale.device.switch import NM, VACUUM_PERMITTIVITY, Switch


def rough_capacitance_F(switch: Switch, separation_nm: np.ndarray, rms_nm: np.ndarray) -> np.ndarray:
    """Capacitance of a flat plate over Gaussian heights, contacting sites flattened to zero gap.

    C/A = eps0 <1 / (max(s + h, 0) + t/eps)>, h normal with deviation rms: each site is a small plate
    capacitor of its own (slopes are neglected).  Always above the plate value at the same mean separation.

    Parameters
    ----------
    separation_nm, rms_nm : arrays of one shape, nm
    """
    separation = np.atleast_1d(np.asarray(separation_nm, dtype=float))
    rms = np.broadcast_to(np.asarray(rms_nm, dtype=float), separation.shape)
    # trapezoidal sum over +-8 deviations: exponentially accurate for the smooth part, 1e-4 at the kink
    heights = np.linspace(-8, 8, 641)
    weights = np.exp(-(heights**2) / 2)
    weights /= weights.sum()
    gaps = np.maximum(separation[:, None] + rms[:, None] * heights, 0.0) + switch.dielectric_nm
    return VACUUM_PERMITTIVITY * switch.area_m2 / NM * (weights / gaps).sum(axis=1)
