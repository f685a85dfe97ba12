"""The contact model written down plainly in NumPy and SciPy: its definition, and the oracle of the
engine.

Whole-grid passes, no local updates, no history beyond the heights. Slow and meant to be read beside
docs/contact.md. Units nm, nN, GPa. It shares no code with the engine.
"""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings


@dataclass
class Asperity:
    """One set of connected touching sites.

    Attributes
    ----------
    sites : flat indices.
    area : the one of eq. 4, nm^2.
    elastic_force : eq. 3, nN.
    """

    sites: np.ndarray
    peak: tuple[int, int]
    indentation: float
    radius: float
    area: float
    elastic_force: float
    hardness: float


def hardness(area: float, inputs: ContactInputs) -> float:
    """H of a contact (GPa; area in nm^2): eq. 4, or a film on a base."""
    if inputs.t_film == 0:
        return inputs.h_macro + inputs.h_prime * area**-0.25
    softening = inputs.k_film * (area**0.5 / inputs.t_film) ** inputs.m_film
    return (inputs.h_film + softening * inputs.h_macro) / (1 + softening)


def connected_sites(touching: np.ndarray) -> list[np.ndarray]:
    """Connected sets of touching sites on the periodic grid, as flat indices."""
    labels, count = ndimage.label(touching, np.ones((3, 3)))
    parent = np.arange(count + 1)

    def root(label):
        while parent[label] != label:
            label = parent[label]
        return label

    # join what meets across the cell's edges
    for shift in [(1, 0), (0, 1), (1, 1), (1, -1)]:
        other = np.roll(labels, shift, (0, 1))
        edge = np.zeros_like(touching)
        edge[0, :] = edge[:, 0] = edge[:, -1] = True
        meet = edge & (labels > 0) & (other > 0) & (labels != other)
        for a, b in set(zip(labels[meet].tolist(), other[meet].tolist(), strict=True)):
            parent[root(a)] = root(b)
    joined = np.array([root(label) for label in range(count + 1)])[labels.ravel()]
    sites = np.flatnonzero(joined)
    order = sites[np.argsort(joined[sites], kind="stable")]
    return np.split(order, np.flatnonzero(np.diff(joined[order])) + 1) if len(order) else []


def curvature(h: np.ndarray, spacing: float) -> np.ndarray:
    """Mean of the x and y profile curvatures at every site (eq. 2, corrected)."""
    total = np.zeros_like(h)
    for axis in (0, 1):
        ahead, behind = np.roll(h, -1, axis), np.roll(h, 1, axis)
        slope = (ahead - behind) / (2 * spacing)
        total += (ahead + behind - 2 * h) / spacing**2 / (1 + slope**2) ** 1.5
    return total / 2


def asperities(
    h: np.ndarray, separation: float, inputs: ContactInputs, settings: ContactSettings
) -> list[Asperity]:
    """All asperities in contact at a separation, with eq. 3 and eq. 4."""
    spacing = settings.length_nm / len(h)
    reading = settings.reading
    p = {"paper": 2 / 3, "hertz": 4 / 3}[reading.prefactor]
    kappa = curvature(h, spacing)
    touching = []
    for sites in connected_sites(h + separation < 0):
        heights = h.ravel()[sites]
        peak = sites[heights == heights.min()].min()
        indentation = -(heights.min() + separation)
        area = len(sites) * spacing**2
        mean = kappa.ravel()[sites].mean()
        if reading.radius == "curvature":
            # no stiffer than a rigid flat punch of the same area, which also bounds flattened tops
            bound = 9 * area / (4 * np.pi * indentation)
            radius = min(1 / mean, bound) if mean > 0 else bound
        else:
            radius = area / (2 * np.pi * indentation)
        force = p * inputs.e_star * np.sqrt(radius * indentation**3)
        if reading.area == "hertz":
            area = np.pi * radius * indentation
        yields = hardness(area, inputs)
        touching.append(
            Asperity(sites, divmod(int(peak), len(h)), indentation, radius, area, force, yields)
        )
    return touching


def repulsion(h, separation, inputs: ContactInputs, settings: ContactSettings) -> float:
    """Repulsive force in nN: eq. 3, or eq. 4 for the non-linear elastic model."""
    touching = asperities(h, separation, inputs, settings)
    if settings.model == "nonlinear":
        return sum(min(a.elastic_force, a.hardness * a.area) for a in touching)
    return sum(a.elastic_force for a in touching)


def attraction(h, separation, inputs: ContactInputs, settings: ContactSettings) -> float:
    """Attractive force in nN, negative (eq. 1)."""
    gap = h + separation
    if not settings.reading.touching_attracts:
        gap = gap[gap >= 0]
    cutoff = settings.gap_cutoff_nm
    gap = (
        np.maximum(gap, 0.0) + cutoff
        if settings.attraction == "offset"
        else np.maximum(gap, cutoff)
    )
    area = (settings.length_nm / len(h)) ** 2
    return -inputs.hamaker * area / (6 * np.pi) * np.sum(gap**-3)


def raise_site(
    h: np.ndarray,
    site: tuple[int, int],
    rise: float,
    asperity: Asperity,
    settings: ContactSettings,
    numerics: Numerics,
):
    """One flow, in place: a narrow Gaussian up, a wide one down, no change of volume on the
    periodic grid.
    """
    n = len(h)
    spacing = settings.length_nm / n
    contact = np.sqrt(asperity.area / np.pi)
    s1 = min(np.sqrt(numerics.flow_width_nm * asperity.radius), contact)
    s1 = max(s1, numerics.flow_floor_pixels * spacing)
    s2 = s1 * {"paper": 3**0.25, "wide": 3.0}[settings.reading.flow_pair]
    reach = min(int(np.ceil(3 * s2 / spacing)), (n - 1) // 2)
    offsets = np.arange(-reach, reach + 1)
    patch = np.ix_(*((p + offsets) % n for p in site))
    squared = (offsets[:, None] ** 2 + offsets[None, :] ** 2) * spacing**2
    narrow = np.exp(-squared / (2 * s1**2))
    wide = np.exp(-squared / (2 * s2**2))
    change = narrow - wide * narrow.sum() / wide.sum()
    if numerics.flow == "return":
        change = change / change[reach, reach]
    h[patch] += rise * change


def settle(
    h, separation, inputs: ContactInputs, settings: ContactSettings, numerics: Numerics = NUMERICS
) -> tuple[np.ndarray, int, bool]:
    """Let yielding asperities flow until none is above its hardness.

    Returns the surface, the sweeps, and whether flow came to its end. Nothing flows where every
    site touches.
    """
    h = h.copy()
    returning = numerics.flow == "return"
    tolerance = numerics.flow_tolerance if returning else 0.0
    for sweeps in range(numerics.max_sweeps + 1):
        touching = asperities(h, separation, inputs, settings)
        limits = [a.hardness * a.area for a in touching]
        yielding = [
            (a, limit)
            for a, limit in zip(touching, limits, strict=True)
            if a.elastic_force > limit * (1 + tolerance) and a.sites.size < h.size
        ]
        if not yielding:
            return h, sweeps, True
        if sweeps == numerics.max_sweeps:
            break
        for a, limit in sorted(yielding, key=lambda pair: pair[0].peak):
            if not returning:
                raise_site(h, a.peak, numerics.flow_increment_nm, a, settings, numerics)
                continue
            # to the indentation at which eq. 3 would give the limit, R and A unchanged
            goal = -separation - a.indentation * (limit / a.elastic_force) ** (2 / 3)
            margin = tolerance * a.indentation / 3
            low = a.sites[h.ravel()[a.sites] < goal - margin]
            # the lowest first; in whole margins, so that rounding does not decide between equals
            depth = np.floor((goal - margin - h.ravel()[low]) / margin)
            for site in low[np.lexsort((low, -depth))]:
                place = divmod(int(site), len(h))
                if h[place] < goal - margin:
                    raise_site(h, place, goal - h[place], a, settings, numerics)
    return h, numerics.max_sweeps, False


def walk(
    h, separations, inputs: ContactInputs, settings: ContactSettings, numerics: Numerics = NUMERICS
):
    """Repulsion and attraction at falling separations; returns them and the final surface."""
    forces = []
    for separation in separations:
        if settings.model == "plastic":
            h, _, _ = settle(h, separation, inputs, settings, numerics)
        pull = attraction(h, separation, inputs, settings)
        forces.append((repulsion(h, separation, inputs, settings), pull))
    return np.array(forces), h
