"""What a contact consists of: its asperities, its constants, and the record of its plastic changes."""

from typing import NamedTuple

import numpy as np


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
    return Asperities(
        np.zeros(sites, np.int32),
        np.empty(3 * sites, np.int32),
        np.empty(2 * sites, np.int32),
        np.empty(2 * sites, np.int32),
        np.empty(2 * sites, np.int32),
        np.empty(2 * sites),
        np.empty(2 * sites),
        np.zeros(2, np.int64),
    )


class Mechanics(NamedTuple):
    """Constants of eqs 2-4.

    Attributes
    ----------
    stiffness : p E*, GPa.
    h_macro : hardness of large asperities, GPa.
    h_prime : size effect of hardness, GPa nm^0.5.
    site_area : area of a site, nm^2.
    curvature_radius : radius from the mean curvature of an asperity's sites, else from its truncation.
    area_of_sites : area from the number of sites, else Hertz's.
    eight : a site has 8 neighbours, else 4.
    flattened_radius : whether an asperity that has yielded has R >= A / (pi delta).
    not_less : whether an asperity carries at least what its parts carried before they merged.
    """

    stiffness: float
    h_macro: float
    h_prime: float
    site_area: float
    curvature_radius: bool
    area_of_sites: bool
    eight: bool
    flattened_radius: bool
    not_less: bool


class FlowRule(NamedTuple):
    """Shape and size of one flow, see ContactSettings.

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


class Changes(NamedTuple):
    """What flow has done to a surface of N^2 sites, and what undoes the step under way.

    Attributes
    ----------
    changed : (N^2,) uint8: 1 where the height is no longer the original.
    sites : (N^2,) int32: the changed sites.
    original : (N^2,) float64: their heights before the first change, nm.
    journal : (N^2,) int32: sites changed in this step.
    before : (N^2,) float64: their heights before it.
    stamp : (N^2,) int32: last step in which a site changed.
    flattened : (N^2,) int32: step in which the site's asperity first yielded; 0: never, -1: in an earlier cycle.
    used : (4,) int64: changed sites, journal entries, number of this step, changed sites before it.
    """

    changed: np.ndarray
    sites: np.ndarray
    original: np.ndarray
    journal: np.ndarray
    before: np.ndarray
    stamp: np.ndarray
    flattened: np.ndarray
    used: np.ndarray


def no_changes(sites: int) -> Changes:
    """An untouched surface; the memory is touched only as flow spreads."""
    return Changes(
        np.zeros(sites, np.uint8),
        np.empty(sites, np.int32),
        np.empty(sites),
        np.empty(sites, np.int32),
        np.empty(sites),
        np.zeros(sites, np.int32),
        np.zeros(sites, np.int32),
        np.zeros(4, np.int64),
    )


class Parts(NamedTuple):
    """Parts of one asperity as its sites join them, by place in the order of heights; see `kernels.force_of_parts`.

    Attributes
    ----------
    place : (N^2,) int32: place + 1 of a site, 0 while it has none.
    parent : (N^2,) int32: place of another site of the same part, the place itself at its root.
    sites : (N^2,) int32: number of sites of a root.
    peak : (N^2,) int32: lowest site of a root (the smaller number among equals).
    lowest : (N^2,) float64: its height, nm.
    curvature : (N^2,) float64: sum of the mean curvatures of a root's sites, 1/nm.
    carried : (N^2,) float64: force that the root's sites carried as they joined, nN.
    """

    place: np.ndarray
    parent: np.ndarray
    sites: np.ndarray
    peak: np.ndarray
    lowest: np.ndarray
    curvature: np.ndarray
    carried: np.ndarray


def no_parts(sites: int) -> Parts:
    """Room for the parts of any asperity of N^2 sites; the memory is touched only as needed."""
    return Parts(
        np.zeros(sites, np.int32),
        np.empty(sites, np.int32),
        np.empty(sites, np.int32),
        np.empty(sites, np.int32),
        np.empty(sites),
        np.empty(sites),
        np.empty(sites),
    )


class Workspace(NamedTuple):
    """Lists that a sweep fills anew; preallocated because growing arrays are slow in compiled loops.

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
    return Workspace(
        np.empty(2 * sites, np.int32),
        np.empty(sites, np.int32),
        np.empty(sites, np.int32),
        np.empty(sites),
        np.empty(sites),
        np.empty(sites),
        np.empty(sites, np.int32),
        np.empty(sites, np.int32),
        np.empty(sites, np.int32),
        np.empty(sites, np.int32),
        np.empty(sites),
        np.empty(sites),
    )
