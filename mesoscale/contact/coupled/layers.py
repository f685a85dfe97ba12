"""Elastic layers on a base, bonded: by how much they are softer or stiffer than the base, wave by
wave.

A pressure p cos(qx) on an isotropic stack makes plane strain. With Airy's function F = f(z) cos(qx)
the stresses are f (normal, but for its sign) and f' (shear), and f'''' - 2 q^2 f'' + q^4 f = 0 in
each layer (Timoshenko and Goodier, Theory of Elasticity, 1970, section 24). Stresses and
displacements are continuous from layer to layer. Lengths are in units of 1/q here.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from mesoscale.settings.contact import Body, MaterialSettings, base_modulus

Array = NDArray[np.float64]

# thickness times q: below, the hyperbolic solutions are the farther apart, above, the exponential
# ones
THIN = 1.0
STEP = 0.02  # of ln q between computed waves; the spline between them errs by less than 1e-8
HYPERBOLIC = 0.5 * np.array(
    [[1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0], [1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.0]]
)
"""From exp(-z), z exp(-z), exp(z), z exp(z) to cosh z, sinh z, z cosh z, z sinh z."""


@lru_cache(maxsize=4)
def softness_spline(bodies: tuple[Body, ...], lowest_q: float, highest_q: float) -> CubicSpline:
    """`softness` between two wave vectors (1/nm), over ln q."""
    log_range = np.log([lowest_q, highest_q])
    log_q = np.linspace(
        log_range[0] - STEP,
        log_range[1] + STEP,
        3 + int(np.ceil((log_range[1] - log_range[0]) / STEP)),
    )
    return CubicSpline(log_q, softness(bodies, np.exp(log_q)))


def softness(bodies: tuple[Body, ...], q_per_nm: Array) -> Array:
    """Compliance of all bodies together over that of their bases alone, shape that of
    `q_per_nm`.
    """
    return (
        sum(compliance(body, q_per_nm) for body in bodies) * q_per_nm / 2.0 * base_modulus(bodies)
    )


def compliance(body: Body, q_per_nm: Array) -> Array:
    """Normal displacement (nm) of a stack by a pressure of 1 GPa and the wave vector q, shape that
    of `q_per_nm`.

    Parameters
    ----------
    body : materials from the surface down; all but the last, the base, have a thickness.
    """
    *layers, _ = body
    unknown = 4 * len(layers) + 2
    matrix = np.zeros((q_per_nm.size, unknown, unknown))
    load = np.zeros((q_per_nm.size, unknown, 1))
    load[:, 0] = 1.0  # at the surface f = 1 and f' = 0
    surface = np.empty((q_per_nm.size, 0))
    for i, material in enumerate(body):
        waves = slice(4 * i, min(4 * i + 4, unknown))  # in the base only the falling ones
        thickness = None if material.thickness_nm is None else q_per_nm * material.thickness_nm
        top = _state(_waves(thickness, np.zeros_like(q_per_nm)), material)[
            :, :, : waves.stop - waves.start
        ]
        if i == 0:
            matrix[:, :2, waves] = top[:, :2]
            surface = top[:, 3]
        else:
            matrix[:, 4 * i - 2 : 4 * i + 2, waves] = -top
        if thickness is not None:
            matrix[:, 4 * i + 2 : 4 * i + 6, waves] = _state(_waves(thickness, thickness), material)
    amplitudes = np.linalg.solve(matrix, load)[:, : surface.shape[1], 0]
    return np.einsum("ij,ij->i", surface, amplitudes) / q_per_nm


def _waves(thickness: Array | None, depth: Array) -> Array:
    """f and its first three derivatives (rows) of four solutions (columns) at a depth, shape
    (waves, 4, 4).

    They are exp(-z), z exp(-z), and the same rising from the bottom; in thin layers cosh z, sinh z,
    z cosh z, z sinh z.
    """
    thin = np.zeros(depth.shape, bool) if thickness is None else thickness < THIN
    waves = np.empty((depth.size, 4, 4))
    for column, sign in ((0, -1.0), (2, 1.0)):
        z = depth if sign < 0.0 or thickness is None else np.where(thin, depth, depth - thickness)
        decay = np.exp(sign * z)
        for n in range(4):
            waves[:, n, column] = sign**n * decay
            waves[:, n, column + 1] = (n * sign ** (n - 1) + sign**n * z) * decay
    waves[thin] = waves[thin] @ HYPERBOLIC
    return waves


def _state(waves: Array, material: MaterialSettings) -> Array:
    """Stresses f, f' (GPa) and displacements along and into the body (in 1/q) of solutions f, as
    rows.
    """
    nu = material.poisson
    twice_shear = material.young_GPa / (1.0 + nu)
    f, slope, second, third = (waves[:, n] for n in range(4))
    lateral = ((1.0 - nu) * second + nu * f) / twice_shear
    into = ((1.0 - nu) * third - (2.0 - nu) * slope) / twice_shear
    return np.stack([f, slope, lateral, into], axis=1)
