"""A contact of single asperities: its asperities, its constants, and room for the loops."""

from typing import NamedTuple

import numpy as np

from mesoscale.inputs.hardness import HardnessLaw


class Asperities(NamedTuple):
    """Asperities of one surface; a dead (merged) one has ``sites`` 0. Sizes: N^2 sites.

    Attributes
    ----------
    label : (N^2,) int32: asperity number + 1 of each site, 0 where there is no contact.
    arena : (3 N^2,) int32: sites, those of one asperity in a row.
    first : (2 N^2,) int32: where an asperity's sites start in the arena.
    sites : (2 N^2,) int32: number of sites.
    peak : (2 N^2,) int32: lowest site (the smaller number among equals).
    lowest : (2 N^2,) float64: its height, nm.
    curvature : (2 N^2,) float64: sum of the sites' mean curvature, 1/nm.
    used : (2,) int64: asperity numbers and arena places in use.
    """

    label: np.ndarray
    arena: np.ndarray
    first: np.ndarray
    sites: np.ndarray
    peak: np.ndarray
    lowest: np.ndarray
    curvature: np.ndarray
    used: np.ndarray


def no_asperities(sites: int) -> Asperities:
    """Empty set for a surface of N^2 sites; the memory is touched only as contact grows."""
    label = np.zeros(sites, np.int32)
    arena = np.empty(3 * sites, np.int32)
    first = np.empty(2 * sites, np.int32)
    counts = np.empty(2 * sites, np.int32)
    peak = np.empty(2 * sites, np.int32)
    lowest = np.empty(2 * sites)
    curvature = np.empty(2 * sites)
    used = np.zeros(2, np.int64)
    return Asperities(label, arena, first, counts, peak, lowest, curvature, used)


class Mechanics(NamedTuple):
    """Constants of eqs 2 and 3, and the hardness.

    Attributes
    ----------
    stiffness : p E*, GPa.
    hardness : hardness against area (eq. 4).
    site_area : area of a site, nm^2.
    curvature_radius : radius from the mean curvature of an asperity's sites, else from its
        truncation.
    area_of_sites : area from the number of sites, else Hertz's.
    """

    stiffness: float
    hardness: HardnessLaw
    site_area: float
    curvature_radius: bool
    area_of_sites: bool


class FlowRule(NamedTuple):
    """Shape and size of one flow, see `numerics.Numerics`.

    Attributes
    ----------
    fixed : flow by a fixed increment, else by return mapping.
    increment : height of one flow, nm.
    width : length w of the narrow Gaussian, s1 = sqrt(w R), nm.
    floor : smallest s1, nm.
    ratio : s2 / s1.
    """

    fixed: bool
    increment: float
    width: float
    floor: float
    ratio: float
    tolerance: float
    max_sweeps: int


class Workspace(NamedTuple):
    """Lists that a sweep fills anew; preallocated, as growing arrays are slow in compiled loops.

    Attributes
    ----------
    active : int32: asperities to look at.
    yielding : int32: asperities above their hardness.
    peak : int32: their lowest sites.
    goal : float64: height to which flow raises their sites, nm.
    margin : float64: how far below a site may stay, nm.
    width : float64: s1, nm.
    low : int32: sites of one asperity that are to be raised.
    site : int32: where the flows of this sweep are.
    half : int32: half-widths of their patches in sites.
    seeds : int32: sites waiting to be joined to asperities.
    narrow : float64: values of a flow's narrow Gaussian.
    wide : float64: values of its wide Gaussian.
    """

    active: np.ndarray
    yielding: np.ndarray
    peak: np.ndarray
    goal: np.ndarray
    margin: np.ndarray
    width: np.ndarray
    low: np.ndarray
    site: np.ndarray
    half: np.ndarray
    seeds: np.ndarray
    narrow: np.ndarray
    wide: np.ndarray


def workspace(sites: int) -> Workspace:
    """Room for the worst case; the memory is touched only as needed."""

    def places(count: int) -> np.ndarray:
        return np.empty(count, np.int32)

    return Workspace(
        active=places(2 * sites),
        yielding=places(sites),
        peak=places(sites),
        goal=np.empty(sites),
        margin=np.empty(sites),
        width=np.empty(sites),
        low=places(sites),
        site=places(sites),
        half=places(sites),
        seeds=places(sites),
        narrow=np.empty(sites),
        wide=np.empty(sites),
    )
