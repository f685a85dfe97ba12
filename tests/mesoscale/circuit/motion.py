"""Lumps in motion, by the equations of `mesoscale.circuit.lumps` as they stand there: a plain twin
of the netlists.
"""

import numpy as np
from scipy.integrate import solve_ivp

from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.switch.beam_kernels import least_gap_nm
from mesoscale.units import GPA, NM, VACUUM_PERMITTIVITY


def _gap_m(lumps, separation_nm):
    return np.maximum(separation_nm + lumps.dielectric_nm, least_gap_nm(lumps.dielectric_nm)) * NM


def capacitance_F(lumps, separation_nm):
    """Capacitance at separations of shape (..., n)."""
    gap, edge = _gap_m(lumps, separation_nm), lumps.fringe / lumps.width_m
    return (
        VACUUM_PERMITTIVITY
        * (1.0 / gap + edge * np.log(np.pi * lumps.width_m / gap))
        @ lumps.area_m2
    )


def pull_Pa(lumps, separation_nm):
    """Electrostatic pull of 1 V."""
    gap = _gap_m(lumps, separation_nm)
    return 0.5 * VACUUM_PERMITTIVITY * (1.0 / gap**2 + lumps.fringe / lumps.width_m / gap)


def held_Pa(lumps, bent_nm):
    """Pressure of the bent electrode on its lumps."""
    z, rest = (lumps.height_nm + bent_nm) * NM, lumps.height_nm * NM
    longer = 0.5 * (z @ lumps.drawn_m @ z - rest @ lumps.drawn_m @ rest)
    force = lumps.stiffness_N_m @ bent_nm * NM + lumps.stretching_N_m * longer * lumps.drawn_m @ z
    return force / lumps.area_m2


def gas_flow(lumps, separation_nm, amount_nm):
    """Pressure of the gas over that around (Pa), and its flow out (nm/us)."""
    s = np.maximum(separation_nm, CIRCUIT.least_film_nm)
    excess = amount_nm / s - 1.0
    dense = np.maximum(1.0 + excess, CIRCUIT.least_density)
    knudsen = CIRCUIT.free_path_nm_Pa / (lumps.gas_Pa * dense * s)
    viscosity = CIRCUIT.viscosity_Pa_s / (1.0 + 9.638 * knudsen**1.159)
    return lumps.gas_Pa * excess, 1e3 * lumps.gas_Pa * dense * excess * (s * NM) ** 3 / (
        viscosity * lumps.width_m**2
    )


def rates(lumps, state, voltage, pad):
    """Changes per us of separations (nm), velocities (nm/us), depths closed (nm) and gas (nm),
    shape (4 n,).
    """
    s, v, closed, amount = state.reshape(4, -1)
    deepest = np.minimum(CIRCUIT.start_nm - closed, s)
    excess, flow = gas_flow(lumps, s, amount)
    pressure = (
        pad(s[:, None], deepest[:, None])[0][:, 0] * GPA - voltage**2 * pull_Pa(lumps, s) + excess
    )
    pressure -= held_Pa(lumps, s - lumps.rest_nm + lumps.loss_us * v)
    follow = (np.maximum(CIRCUIT.start_nm - s - closed, 0.0) - CIRCUIT.leak * closed) / (
        1e6 * CIRCUIT.follow_s
    )
    return np.concatenate([v, 1e-3 * pressure / lumps.mass_kg_m2, follow, -flow])


def move(lumps, pad, voltage, end_us, precision=1e-4):
    """Times (us) and separations (nm) from rest under a voltage, shape (times,) and (n, times)."""
    nothing = np.zeros(lumps.count)
    solved = solve_ivp(
        lambda _, state: rates(lumps, state, voltage, pad),
        (0.0, end_us),
        np.concatenate([lumps.rest_nm, nothing, nothing, lumps.rest_nm]),
        method="Radau",
        rtol=precision,
        atol=precision * np.repeat([1e2, 1e3, 1e2, 1e2], lumps.count),
        first_step=1e-3,
    )
    assert solved.success
    return solved.t, solved.y[: lumps.count]
