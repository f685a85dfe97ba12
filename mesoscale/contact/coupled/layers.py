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
    first, last = np.log([lowest_q, highest_q])
    count = 3 + int(np.ceil((last - first) / STEP))
    log_q = np.linspace(first - STEP, last + STEP, count)
    return CubicSpline(log_q, softness(bodies, np.exp(log_q)))


def softness(bodies: tuple[Body, ...], q_per_nm: Array) -> Array:
    """Compliance of all bodies together over that of their bases alone, shape that of
    `q_per_nm`.
    """
    together = sum(compliance(body, q_per_nm) for body in bodies)
    return together * q_per_nm / 2.0 * base_modulus(bodies)


def compliance(body: Body, q_per_nm: Array) -> Array:
    """Normal displacement (nm) of a stack by a pressure of 1 GPa and the wave vector q, shape that
    of `q_per_nm`.

    Parameters
    ----------
    body : materials from the surface down; all but the last, the base, have a thickness.
    """
    *layers, _ = body
    # four amplitudes a layer, and two of the base, in which only falling solutions are
    unknown = 4 * len(layers) + 2
    matrix = np.zeros((q_per_nm.size, unknown, unknown))
    load = np.zeros((q_per_nm.size, unknown, 1))
    load[:, 0] = 1.0  # at the surface f = 1 and f' = 0
    sinks_by = np.empty((q_per_nm.size, 0))  # of the surface, by each amplitude of the first layer
    for i, material in enumerate(body):
        amplitudes = slice(4 * i, min(4 * i + 4, unknown))
        count = amplitudes.stop - amplitudes.start
        thickness = None
        if material.thickness_nm is not None:
            thickness = q_per_nm * material.thickness_nm
        at_top = _state(_waves(thickness, np.zeros_like(q_per_nm)), material)[:, :, :count]
        if i == 0:
            matrix[:, :2, amplitudes] = at_top[:, :2]
            sinks_by = at_top[:, 3]
        else:  # continuous with the layer above
            matrix[:, 4 * i - 2 : 4 * i + 2, amplitudes] = -at_top
        if thickness is not None:
            at_bottom = _state(_waves(thickness, thickness), material)
            matrix[:, 4 * i + 2 : 4 * i + 6, amplitudes] = at_bottom
    of_first_layer = np.linalg.solve(matrix, load)[:, : sinks_by.shape[1], 0]
    return np.einsum("ij,ij->i", sinks_by, of_first_layer) / q_per_nm


def _waves(thickness: Array | None, depth: Array) -> Array:
    """f and its first three derivatives (rows) of four solutions (columns) at a depth, shape
    (waves, 4, 4).

    They are exp(-z), z exp(-z), and the same rising from the bottom; in thin layers cosh z, sinh z,
    z cosh z, z sinh z.
    """
    thin = np.zeros(depth.shape, bool)
    from_bottom = depth
    if thickness is not None:
        thin = thickness < THIN
        from_bottom = np.where(thin, depth, depth - thickness)
    waves = np.empty((depth.size, 4, 4))
    for column, sign, z in ((0, -1.0, depth), (2, 1.0, from_bottom)):
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
