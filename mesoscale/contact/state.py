"""What a contact consists of: its asperities, its constants, and the record of its plastic changes."""

from typing import NamedTuple

import numpy as np


class Asperities(NamedTuple):
    """Asperities of one surface; a dead (merged) one has ``sites`` 0. Sizes: N^2 sites."""

    label: np.ndarray  # (N^2,) int32: asperity number + 1 of each site, 0 where there is no contact
    arena: np.ndarray  # (3 N^2,) int32: sites, those of one asperity in a row
    first: np.ndarray  # (2 N^2,) int32: where an asperity's sites start in the arena
    sites: np.ndarray  # (2 N^2,) int32: number of sites
    peak: np.ndarray  # (2 N^2,) int32: lowest site (the smaller number among equals)
    lowest: np.ndarray  # (2 N^2,) float64: its height, nm
    curvature: np.ndarray  # (2 N^2,) float64: sum of the sites' mean curvature, 1/nm
    used: np.ndarray  # (2,) int64: asperity numbers and arena places in use


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
    """Constants of eqs 2-4."""

    stiffness: float  # p E*, GPa
    h_macro: float  # GPa
    h_prime: float  # GPa nm^0.5
    site_area: float  # nm^2
    curvature_radius: bool  # else truncation
    area_of_sites: bool  # else Hertz's
    eight: bool  # 8 neighbours, else 4
    flattened_radius: bool  # an asperity that has yielded has R >= A / (pi delta)
    not_less: bool  # an asperity carries at least what its parts carried before they merged


class FlowRule(NamedTuple):
    """Shape and size of one flow, see ContactSettings."""

    fixed: bool  # fixed increment, else return mapping
    increment: float  # nm
    width: float  # nm: s1 = sqrt(width * R)
    floor: float  # nm: smallest s1
    ratio: float  # s2 / s1
    tolerance: float
    max_sweeps: int


class Changes(NamedTuple):
    """What flow has done to a surface of N^2 sites, and what undoes the step under way."""

    changed: np.ndarray  # (N^2,) uint8: 1 where the height is no longer the original
    sites: np.ndarray  # (N^2,) int32: the changed sites
    original: np.ndarray  # (N^2,) float64: their heights before the first change, nm
    journal: np.ndarray  # (N^2,) int32: sites changed in this step
    before: np.ndarray  # (N^2,) float64: their heights before it
    stamp: np.ndarray  # (N^2,) int32: last step in which a site changed
    flattened: (
        np.ndarray
    )  # (N^2,) int32: step in which the site's asperity first yielded; 0: never, -1: in an earlier cycle
    used: np.ndarray  # (4,) int64: changed sites, journal entries, number of this step, changed sites before it


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
    """Parts of one asperity as its sites join them, by place in the order of heights; see `kernels.force_of_parts`."""

    place: np.ndarray  # (N^2,) int32: place + 1 of a site, 0 while it has none
    parent: np.ndarray  # (N^2,) int32: place of another site of the same part, the place itself at its root
    sites: np.ndarray  # (N^2,) int32: number of sites of a root
    peak: np.ndarray  # (N^2,) int32: lowest site of a root (the smaller number among equals)
    lowest: np.ndarray  # (N^2,) float64: its height, nm
    curvature: np.ndarray  # (N^2,) float64: sum of the mean curvatures of a root's sites, 1/nm
    carried: np.ndarray  # (N^2,) float64: force that the root's sites carried as they joined, nN


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
    """Lists that a sweep fills anew; preallocated because growing arrays are slow in compiled loops."""

    active: np.ndarray  # int32: asperities to look at
    yielding: np.ndarray  # int32: asperities above their hardness
    peak: np.ndarray  # int32: their lowest sites
    goal: np.ndarray  # float64: height to which flow raises their sites, nm
    margin: np.ndarray  # float64: how far below a site may stay, nm
    width: np.ndarray  # float64: s1, nm
    low: np.ndarray  # int32: sites of one asperity that are to be raised
    site: np.ndarray  # int32: where the flows of this sweep are
    half: np.ndarray  # int32: half-widths of their patches in sites
    seeds: np.ndarray  # int32: sites waiting to be joined to asperities
    narrow: np.ndarray  # float64: values of a flow's narrow Gaussian
    wide: np.ndarray  # float64: values of its wide Gaussian


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
