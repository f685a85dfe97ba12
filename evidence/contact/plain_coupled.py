"""The coupled contact written down plainly: one dense matrix for the whole cell, SciPy's bounded
least squares.

For small grids, meant to be read beside docs/contact.md. Units nm, nN, GPa. It shares no code with
the engine.
"""

import numpy as np
from scipy import linalg, optimize

from evidence.contact.plain_contact import connected_sites
from evidence.contact.plain_contact import hardness as hardness_of
from mesoscale.contact import ContactInputs
from mesoscale.settings import ContactSettings


def influence_matrix(pixels: int, length: float, e_star: float) -> np.ndarray:
    """Displacement (nm) of every site by a unit pressure (GPa) on every other: 2 / (E* |q|) summed
    wave by wave.
    """
    waves = np.fft.fftfreq(pixels, length / pixels) * 2 * np.pi
    q = np.hypot(waves[:, None], waves[None, :])
    q[0, 0] = np.inf
    first = np.fft.ifft2(2 / (e_star * q)).real
    rows = np.arange(pixels)
    apart = (rows[:, None] - rows[None, :]) % pixels
    return first[apart[:, None, :, None], apart[None, :, None, :]].reshape(pixels**2, pixels**2)


def pressures(gap: np.ndarray, limit: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """p that minimises p G p / 2 + p gap with 0 <= p <= limit; the site farthest away is left out,
    p = 0 there.
    """
    kept = np.delete(np.arange(gap.size), np.argmax(gap))
    root = linalg.cholesky(matrix[np.ix_(kept, kept)])
    wanted = -linalg.solve_triangular(root, gap[kept], trans="T")
    p = np.zeros(gap.size)
    if np.isinf(limit).all():
        p[kept] = optimize.nnls(root, wanted, maxiter=100 * kept.size)[0]
    else:
        p[kept] = optimize.lsq_linear(
            root, wanted, (0, limit[kept]), method="bvls", tol=1e-15, max_iter=5000
        ).x
    return p


def hardness(touching: np.ndarray, inputs: ContactInputs, settings: ContactSettings) -> np.ndarray:
    """H of the cluster of each site (eq. 4); of a cluster of one site where nothing touches."""
    site_area = (settings.length_nm / len(touching)) ** 2
    ceilings = np.full(touching.size, hardness_of(site_area, inputs))
    for sites in connected_sites(touching):
        ceilings[sites] = hardness_of(len(sites) * site_area, inputs)
    return ceilings


def walk(h, separations, inputs: ContactInputs, settings: ContactSettings):
    """Pressures at falling separations, shape (separations, N, N), and the final surface."""
    h = h.astype(float).copy()
    pixels = len(h)
    matrix = influence_matrix(pixels, settings.length_nm, inputs.e_star)
    limit = (
        np.full(h.size, np.inf)
        if settings.model == "elastic"
        else hardness(h > np.inf, inputs, settings)
    )
    rows = []
    for separation in separations:
        for _ in range(50):
            p = pressures(h.ravel() + separation, limit, matrix)
            if settings.model == "elastic":
                break
            ceilings = hardness(p.reshape(h.shape) > 0, inputs, settings)
            same = np.array_equal(ceilings[p > 0], limit[p > 0])
            limit = ceilings
            if same:
                break
        if settings.model == "plastic":
            overlap = -(h.ravel() + separation + matrix @ p)
            # the solver's own rounding lies below the limit
            yields = (p >= limit * (1 - 1e-12)) & (overlap > 0)
            h.ravel()[yields] += overlap[yields]
        rows.append(p.reshape(h.shape))
    return np.array(rows), h
