"""Van der Waals attraction of a rough surface and a plane (eq. 1), and that of liquid.

Sum over the sites of 1/s^3. The distance s of the walls is g + D0 (offset) or max(g, D0) (clamped,
the paper's), with the gap g = h + separation. Sites far from contact are summed through a histogram
of their heights that keeps the first five moments of each bin; sites near contact, and all sites
that plastic flow has moved, are summed one by one.

Retardation: flats lose the energy A_H / (12 pi s^2) / (1 + c s), with c = 5.32 over the wavelength
(Gregory 1981, doi:10.1016/0021-9797(81)90018-7; its integral by Derjaguin is Gregory's sphere and
plate). So 1/s^3 becomes (1 + 3/2 c s) / (1 + c s)^2 / s^3, which is 1/s^3 - (c/2) (1/s^2 - 1/(s +
1/c)^2).
"""

import math

import numpy as np
from numba import njit

from mesoscale.contact.changes import Changes
from mesoscale.contact.menisci import Liquid, menisci_of
from mesoscale.contact.numerics import Numerics
from mesoscale.settings import ContactSettings

MOMENTS = 5
NEAR_BINS = 100  # a site is near while its gap is below this many bin widths
GREGORY = 5.32  # of c; see above
# Sites that touch cover more than the contact does, by this part of a site for each edge between a
# touching site and one that does not touch (Yastrebov, Anciaux and Molinari 2017,
# doi:10.1016/j.jmps.2017.07.016).
EXCESS = (math.pi - 1.0 + math.log(2.0)) / 24.0


def retardation_rate(wavelength_nm: float | None) -> float:
    """The c of retardation, 1/nm; 0 without it."""
    if not wavelength_nm:
        return 0.0
    return GREGORY / wavelength_nm


def wall_offset_nm(settings: ContactSettings) -> float:
    """Distance of the walls less the gap, nm, where the gap is wide."""
    if settings.attraction != "offset":
        return 0.0
    return settings.gap_cutoff_nm


class Attraction:
    """Eq. 1 on one surface: its law, and the histogram of the sites that flow has not moved.

    Attributes
    ----------
    cutoff : D0, nm.
    offset, least : the walls are max(gap, least) + offset apart, nm.
    touching : whether sites in contact attract.
    menisci : liquid in the gaps, where humid air condenses.
    filled : the liquid of the last force.
    kept : volume of the liquid that an opening keeps, over the area of a site, nm; None: in
        equilibrium.
    near_nm : gap below which sites of an undeformed surface are summed one by one, nm.
    """

    def __init__(
        self,
        heights: np.ndarray,
        site_area: float,
        hamaker: float,
        settings: ContactSettings,
        numerics: Numerics,
    ):
        """Take all heights (N^2,) in nm and the area of a site in nm^2."""
        self.cutoff = settings.gap_cutoff_nm
        self.offset = wall_offset_nm(settings)
        self.least = self.cutoff - self.offset
        self.touching = settings.reading.touching_attracts
        self.rate = retardation_rate(settings.retardation_nm)
        self.menisci = menisci_of(settings.air, hamaker)
        self.filled = Liquid(0.0, 0.0, self.reach_nm)
        self.kept: float | None = None
        self.site_area = site_area
        self.strength = hamaker * site_area / (6.0 * np.pi)
        self.lowest = float(heights.min())
        height_range = float(heights.max()) - self.lowest
        self.bin_width = max(height_range, 1e-6 * self.cutoff) / numerics.gap_bins
        self.near_nm = max(NEAR_BINS * self.bin_width, 2.0 * self.cutoff)
        self.moments = np.zeros((numerics.gap_bins, MOMENTS))
        self.taken_out = 0  # of the changed sites
        self.put_in(heights)

    def put_in(self, heights: np.ndarray) -> None:
        """Have the histogram hold further sites."""
        bin_heights(heights, self.lowest, self.bin_width, self.moments)
        self.before: np.ndarray | None = None  # cumulated, where asked for

    def take_out(self, changes: Changes) -> None:
        """Have the histogram hold the unchanged sites only."""
        count = int(changes.used[0])
        if count > self.taken_out:
            take_out(
                changes.original, self.taken_out, count, self.lowest, self.bin_width, self.moments
            )
            self.taken_out, self.before = count, None

    @property
    def reach_nm(self) -> float:
        """Gap below which there is liquid in equilibrium, nm."""
        if self.menisci is None:
            return 0.0
        return self.menisci.reach_nm

    def adopt(self, changes: Changes, heights: np.ndarray) -> None:
        """Have the histogram hold the changed sites, too, at their present heights (nm)."""
        self.take_out(changes)
        self.put_in(heights)
        self.taken_out = 0

    def share_before(self, far: int) -> float:
        """Share of the sites in the bins before one."""
        if self.before is None:
            self.before = np.cumsum(self.moments[:, 0])
        if far == 0:
            return 0.0
        return float(self.before[far - 1] / self.before[-1])

    def far_edge(self, near: float, separation: float) -> tuple[int, float]:
        """First bin all of whose sites are at least a gap (nm) away, and its lower edge (nm)."""
        far = first_far_bin(near, separation, self.lowest, self.bin_width, len(self.moments))
        return far, self.lowest + far * self.bin_width

    def deformed(
        self, gap: np.ndarray, weight: np.ndarray, separation: float = 0.0, far: int | None = None
    ) -> float:
        """Force (nN, negative) on sites with gaps (nm), weights, and the bins from `far` on."""
        total = inverse_cubes_of(gap, weight, self.least, self.offset, self.rate)
        if far is not None:
            total += far_inverse_cubes(
                separation + self.offset, far, self.lowest, self.bin_width, self.moments, self.rate
            )
        return -self.strength * total + self.liquid(gap, weight, separation, far)

    def liquid(
        self, gap: np.ndarray, weight: np.ndarray, separation: float = 0.0, far: int | None = None
    ) -> float:
        """What liquid adds to the force (nN); see `deformed` for the sites."""
        if self.menisci is None:
            return 0.0
        if far is None:
            far = len(self.moments)
        walls = (self.least, self.offset, self.rate)
        bins = (separation, far, self.lowest, self.bin_width, self.moments)
        films = (self.menisci.films_nm, self.menisci.pulled_from_nm)
        reach = self.menisci.reach_nm
        if self.kept is None:
            sites, pulled, volume, cubes = fill(gap, weight, *bins, reach, *films, *walls)
        else:
            volume = self.kept
            sites, pulled, reach, cubes = hold(gap, weight, *bins, volume, reach, *films, *walls)
        self.filled = Liquid(sites, volume, reach)
        less = (1.0 - self.menisci.dispersion) * self.strength * cubes
        return less - self.menisci.pull_at(reach) * self.site_area * pulled

    def around(
        self,
        heights: np.ndarray,
        separation: float,
        displacement: np.ndarray,
        sites: np.ndarray,
        place: np.ndarray,
        pressure: np.ndarray,
    ) -> float:
        """Force (nN, negative) on all sites with displacements (nm), (N^2,)."""
        walls = (self.least, self.offset, self.rate)
        touching = self.touching
        force = -self.strength * inverse_cubes_around(
            heights, separation, displacement, sites, place, pressure, touching, *walls
        )
        if self.menisci is None:
            return force
        weight = all_attracting(heights.size, sites, place, pressure, touching)
        return force + self.liquid(heights + separation + displacement, weight)

    def undeformed(
        self,
        heights: np.ndarray,
        separation: float,
        order: np.ndarray,
        order_heights: np.ndarray,
        changes: Changes,
        changed: np.ndarray,
    ) -> float:
        """Force (nN, negative) on a surface that nothing deforms; see `inverse_cubes`."""
        walls = (self.least, self.offset, self.touching)
        bins = (self.lowest, self.bin_width, self.moments)
        flowed = (changed, changes.sites, changes.used[0])
        return -self.strength * inverse_cubes(
            heights, separation, *walls, order, order_heights, *flowed, *bins, self.rate
        )


@njit(cache=True)
def attracting(count, rank, sites, place, pressure, pixels, touching):
    """How many sites' areas attract with the gap of each of so many sites, which `rank` numbers.

    Without `touching` sites under pressure do not, but for the strip along their edges where there
    is no contact: it counts with the gap of the site beyond the edge. `place` holds the position of
    each site of the cell in the list that `pressure` belongs to, or -1.
    """
    weight = np.ones(count)
    if touching:
        return weight
    for k in range(sites.size):
        if not pressure[k] > 0.0:
            continue
        if rank[sites[k]] < count:
            weight[rank[sites[k]]] = 0.0
        for beside in _beside(sites[k], pixels):
            number = rank[beside]
            if not 0 <= number < count:
                continue
            if place[beside] < 0 or not pressure[place[beside]] > 0.0:
                weight[number] += EXCESS
    return weight


@njit(cache=True, inline="always")
def _beside(site, pixels):
    """The four neighbours of a site in its periodic cell."""
    col = site % pixels
    size = pixels * pixels
    up = site - pixels
    if up < 0:
        up += size
    down = site + pixels
    if down >= size:
        down -= size
    left = site - 1
    if col == 0:
        left += pixels
    right = site + 1
    if col == pixels - 1:
        right -= pixels
    return up, down, left, right


def all_attracting(
    size: int, sites: np.ndarray, place: np.ndarray, pressure: np.ndarray, touching: bool
) -> np.ndarray:
    """`attracting` of all sites of a cell, of which few are under pressure, (N^2,)."""
    rank = np.arange(size, dtype=np.int32)
    return attracting(size, rank, sites, place, pressure, math.isqrt(size), touching)


@njit(cache=True, inline="always")
def inverse_cube(gap, rate):
    """1/g^3, retarded where the rate is not 0."""
    cube = 1.0 / (gap * gap * gap)
    if rate == 0.0:
        return cube
    reach = rate * gap
    return cube * (1.0 + 1.5 * reach) / ((1.0 + reach) * (1.0 + reach))


@njit(cache=True)
def bin_heights(heights, lowest, width, moments):
    """Add every site to the moments of its bin: sums of t^0..t^4, t = h - bin centre."""
    last = moments.shape[0] - 1
    for site in range(heights.size):
        x = (heights[site] - lowest) / width
        b = max(0, min(int(x), last))
        t = (x - b - 0.5) * width
        moments[b, 0] += 1.0
        moments[b, 1] += t
        moments[b, 2] += t * t
        moments[b, 3] += t * t * t
        moments[b, 4] += t * t * t * t


@njit(cache=True)
def take_out(originals, start, stop, lowest, width, moments):
    """Remove sites (given by their original heights) from the moments."""
    last = moments.shape[0] - 1
    for k in range(start, stop):
        x = (originals[k] - lowest) / width
        b = max(0, min(int(x), last))
        t = (x - b - 0.5) * width
        moments[b, 0] -= 1.0
        moments[b, 1] -= t
        moments[b, 2] -= t * t
        moments[b, 3] -= t * t * t
        moments[b, 4] -= t * t * t * t


@njit(cache=True)
def first_far_bin(gap, separation, lowest, width, bins):
    """First of the bins all of whose sites are at least a gap away."""
    far = int(np.floor((gap - separation - lowest) / width)) + 1
    return min(max(far, 0), bins)


@njit(cache=True)
def far_inverse_cubes(separation, far, lowest, width, moments, rate):
    """Sum over the sites of 1/s^3 in the bins from `far` on: (s + t)^-3 expanded in t / s."""
    total = 0.0
    for b in range(far, moments.shape[0]):
        gap = lowest + (b + 0.5) * width + separation
        u = 1.0 / gap
        # (s + t)^-3 = u^3 (1 - 3 u t + 6 (u t)^2 - ...), u = 1/s, from the last term on (Horner)
        series = -10.0 * moments[b, 3] + u * 15.0 * moments[b, 4]
        series = 6.0 * moments[b, 2] + u * series
        series = -3.0 * moments[b, 1] + u * series
        total += u**3 * (moments[b, 0] + u * series)
        if rate > 0.0:
            near_squares = _inverse_squares(u, moments[b])
            far_squares = _inverse_squares(1.0 / (gap + 1.0 / rate), moments[b])
            total -= 0.5 * rate * (near_squares - far_squares)
    return total


@njit(cache=True)
def _inverse_squares(u, moments):
    """Sum over the sites of a bin of (1/u + t)^-2, expanded in t u."""
    # from the last term on (Horner)
    series = -4.0 * moments[3] + u * 5.0 * moments[4]
    series = 3.0 * moments[2] + u * series
    series = -2.0 * moments[1] + u * series
    return u * u * (moments[0] + u * series)


@njit(cache=True)
def inverse_cubes_of(gap, weight, narrowest, offset, rate):
    """Sum of 1/s^3, s = max(g, narrowest) + offset, over given gaps, each with its weight."""
    total = 0.0
    for k in range(gap.size):
        if weight[k] > 0.0:
            total += weight[k] * inverse_cube(max(gap[k], narrowest) + offset, rate)
    return total


@njit(cache=True)
def fill(
    gap,
    weight,
    separation,
    far,
    lowest,
    width,
    moments,
    reach,
    films,
    pulled_from,
    narrowest,
    offset,
    rate,
):
    """Sites with gaps below `reach`, those that are pulled, volume beside films, sum of 1/s^3.

    The bins from `far` on count, too. The bin in which liquid ends is filled in part.
    """
    sites = pulled = volume = cubes = 0.0
    for k in range(gap.size):
        if weight[k] > 0.0 and gap[k] < reach:
            sites += weight[k]
            if gap[k] >= pulled_from:
                pulled += weight[k]
            volume += weight[k] * max(gap[k] - films, 0.0)
            cubes += weight[k] * inverse_cube(max(gap[k], narrowest) + offset, rate)
    for b in range(far, moments.shape[0]):
        edge = lowest + b * width + separation
        if edge >= reach:
            break
        if moments[b, 0] > 0.0:
            share = min((reach - edge) / width, 1.0) * moments[b, 0]
            mean = edge + 0.5 * width + moments[b, 1] / moments[b, 0]
            sites += share
            if mean >= pulled_from:
                pulled += share
            volume += share * max(mean - films, 0.0)
            cubes += share * inverse_cube(max(mean, narrowest) + offset, rate)
    return sites, pulled, volume, cubes


@njit(cache=True)
def hold(
    gap,
    weight,
    separation,
    far,
    lowest,
    width,
    moments,
    volume,
    reach,
    films,
    pulled_from,
    narrowest,
    offset,
    rate,
):
    """Sites that a volume of liquid fills from the narrowest gap on, those that are pulled, its
    reach, sum of 1/s^3.

    Where it fills all sites, more stands around them, and the gap is `reach`.
    """
    bins = moments.shape[0]
    # gap at which the first bin begins; sites with less are in this bin, too
    start = lowest + separation
    sums = np.zeros((bins, 4))
    for k in range(gap.size):
        b = min(max(int((gap[k] - start) / width), 0), bins - 1)
        sums[b, 0] += weight[k]
        sums[b, 1] += weight[k] * max(gap[k] - films, 0.0)
        sums[b, 2] += weight[k] * inverse_cube(max(gap[k], narrowest) + offset, rate)
        if gap[k] >= pulled_from:
            sums[b, 3] += weight[k]
    sites = pulled = filled = cubes = 0.0
    for b in range(bins):
        if b >= far and moments[b, 0] > 0.0:
            mean = start + (b + 0.5) * width + moments[b, 1] / moments[b, 0]
            sums[b, 0] += moments[b, 0]
            sums[b, 1] += moments[b, 0] * max(mean - films, 0.0)
            sums[b, 2] += moments[b, 0] * inverse_cube(max(mean, narrowest) + offset, rate)
            if mean >= pulled_from:
                sums[b, 3] += moments[b, 0]
        share = 1.0
        if filled + sums[b, 1] > volume:
            share = (volume - filled) / sums[b, 1]
        sites += share * sums[b, 0]
        pulled += share * sums[b, 3]
        filled += share * sums[b, 1]
        cubes += share * sums[b, 2]
        if share < 1.0:
            return sites, pulled, start + (b + share) * width, cubes
    return sites, pulled, reach, cubes


@njit(cache=True, fastmath={"contract", "reassoc", "nsz"}, error_model="numpy")  # in parallel lanes
def inverse_cubes_around(
    heights, separation, displacement, sites, place, pressure, touching, narrowest, offset, rate
):
    """Sum of 1/s^3 over all sites of a cell, weighted by `attracting` around `sites`."""
    pixels = int(np.sqrt(heights.size) + 0.5)
    total = 0.0
    for k in range(heights.size):
        gap = heights[k] + separation + displacement[k]
        total += inverse_cube(max(gap, narrowest) + offset, rate)
    if touching:
        return total
    for k in range(sites.size):
        if not pressure[k] > 0.0:
            continue
        site = sites[k]
        gap = heights[site] + separation + displacement[site]
        total -= inverse_cube(max(gap, narrowest) + offset, rate)
        for beside in _beside(site, pixels):
            if place[beside] < 0 or not pressure[place[beside]] > 0.0:
                gap = heights[beside] + separation + displacement[beside]
                total += EXCESS * inverse_cube(max(gap, narrowest) + offset, rate)
    return total


@njit(cache=True)
def inverse_cubes(
    heights,
    separation,
    narrowest,
    offset,
    touching,
    order,
    order_heights,
    changed,
    changed_sites,
    changed_count,
    lowest,
    width,
    moments,
    rate,
):
    """Sum over the sites of 1/s^3, s = max(g, narrowest) + offset; g < 0 counts if ``touching``.

    ``order`` holds at least all sites of the near bins, by rising original height.
    """
    bins = moments.shape[0]
    near_nm = max(NEAR_BINS * width, 2.0 * (narrowest + offset))
    far = first_far_bin(near_nm, separation, lowest, width, bins)
    near = 0.0
    for place in range(order.size):
        bin_of_site = int((order_heights[place] - lowest) / width)
        if min(bin_of_site, bins - 1) >= far:
            break
        if changed[order[place]] == 0:
            gap = order_heights[place] + separation
            if gap >= 0.0 or touching:
                near += inverse_cube(max(gap, narrowest) + offset, rate)
    moved = 0.0
    for place in range(changed_count):
        gap = heights[changed_sites[place]] + separation
        if gap >= 0.0 or touching:
            moved += inverse_cube(max(gap, narrowest) + offset, rate)
    return near + moved + far_inverse_cubes(separation + offset, far, lowest, width, moments, rate)
