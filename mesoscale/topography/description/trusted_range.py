"""The range of wave vectors in which an instrument leaves a spectrum undisturbed, and what its tip and window change.

Levelling and the window change the longest waves, pixels, noise and the tip the shortest.
"""

from dataclasses import dataclass

import numpy as np

from mesoscale.topography.spectrum import Spectrum

# dilation lowers C by exp(-a k^b), k = R sqrt(2 pi q^6 C) the tip's radius times the curvature per octave;
# measured on slopes 2.3-3.8, RMS 3 and 8 nm, tips of 2-10 nm: one curve to 3 %
TIP_BIAS = (0.5, 1.3)
# beyond k = 0.5 the same comparison (slopes 2.4-4.2, tips of 5-20 nm) gives 0.45 k, to 0.15 at 1.5 and 0.2 at 2.5
BLUNT_BIAS = 0.45
BLUNT_ERROR = 0.3  # of that correction
MOST_CURVED = 2.0
LEVELLED_ERROR = 0.5  # of ln C in the first shells, after their blur is taken out


def tip_bias(curvature: np.ndarray) -> np.ndarray:
    """-ln of what dilation leaves of C where a tip's radius times the curvature per octave is `curvature`."""
    return TIP_BIAS[0] * np.minimum(curvature, 3.0) ** TIP_BIAS[1]


def blur(slope: float, shell: np.ndarray) -> np.ndarray:
    """ln of what the Hann window and the shells' width add to a power law at shell number `shell`.

    The window spreads each wave vector over its neighbours (variance 1/3 shell^2 along each axis), the shell
    averages over its width (variance 1/12); both lift a convex spectrum.
    """
    return np.log1p((slope**2 / 6 + slope * (slope + 1) / 24) / shell**2)


@dataclass(frozen=True)
class TrustedSpectrum:
    """A scan's spectrum with the range of wave vectors that the instrument leaves undisturbed.

    Attributes
    ----------
    low, high : trusted wave vectors, 1/nm.
    limit : what ends the range above: `tip`, `noise` or `pixels`.
    tip_radius_nm : radius used for the tip's correction.
    rms_nm : RMS of the cleaned heights.
    reach : where the range would end without the tip, 1/nm; between `high` and here the tip's correction is large.
    side_nm : side of a square of a measured map's area; 0 for a line profile.
    form : ln of what a parabola would take of the mean square height, besides the levelling.
    line : of a line profile, C1(k) in nm^3 on bins inside its trusted range; None for a scan.
    """

    name: str
    spectrum: Spectrum
    low: float
    high: float
    limit: str
    tip_radius_nm: float
    rms_nm: float = 0.0
    reach: float = 0.0
    side_nm: float = 0.0
    form: float = 0.0
    line: Spectrum | None = None

    @property
    def trusted(self) -> np.ndarray:
        """(m,) bool: shells inside the range."""
        return (self.spectrum.q >= self.low) & (self.spectrum.q <= self.high)

    def corrected_psd(self) -> np.ndarray:
        """(m,) C with the tip's bias taken out, nm^4; meaningful inside the trusted range."""
        q, psd = self.spectrum.q, self.spectrum.psd
        smooth = np.exp(_running_mean(np.log(psd), q))
        bias = np.zeros_like(q)
        for _ in range(5):
            bias = tip_bias(self.tip_radius_nm * np.sqrt(2 * np.pi * smooth * np.exp(bias)) * q**3)
        return psd * np.exp(bias)


def with_ends(item: TrustedSpectrum) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The trusted shells with those beyond its ends that can be corrected, at a price.

    Above, up to where the roughness is MOST_CURVED times as curved as the tip; below, down to the first shell.

    Returns
    -------
    use : (m,) bool, the shells.
    psd : (m,) C with the tip's bias and the window's blur taken out, nm^4.
    error : (m,) error of ln C that the correction leaves; 0 in the trusted range.
    """
    q, psd = item.spectrum.q, item.spectrum.psd
    smooth = np.exp(_running_mean(np.log(psd), q))
    curvature = bias = np.zeros_like(q)
    for _ in range(12):
        curvature = item.tip_radius_nm * np.sqrt(2 * np.pi * smooth * np.exp(bias)) * q**3
        bias = np.where(curvature < 0.5, tip_bias(curvature), BLUNT_BIAS * np.minimum(curvature, 2 * MOST_CURVED))
    use = (q >= item.low) & (q <= max(item.high, item.reach))
    blunt = curvature > MOST_CURVED
    if (blunt & use).any():
        use &= q < q[blunt & use][0]
    error = np.where(q > item.high, BLUNT_ERROR * bias, 0.0)
    psd = psd * np.exp(bias)
    if not item.spectrum.sharp and use.sum() > 3:  # the window lifts long waves, levelling takes the longest
        long = (q < item.low) & (q > 0.9 * item.spectrum.spacing)
        start = np.flatnonzero(use)[: max(4, int(np.sum(use & (q < 3 * item.low))))]
        slope = float(np.clip(-np.polyfit(np.log(q[start]), np.log(psd[start]), 1)[0], 0.0, 6.0))
        psd = psd * np.exp(-blur(slope, q / item.spectrum.spacing))
        error = np.where(long, LEVELLED_ERROR, error)
        use |= long
    return use, psd, error


def trusted_range(
    name: str,
    spectrum: Spectrum,
    tip_radius_nm: float,
    lowest_shell: float = 2.5,
    noise_margin: float = 20.0,
    tip_margin: float = 0.5,
    rms_nm: float = 0.0,
    shortest_wave_nm: float | None = None,
    noise_psd: float = 0.0,
) -> TrustedSpectrum:
    """Bound a spectrum to what the instrument resolves.

    Below, `lowest_shell` shells: levelling and the window change longer waves. Above, the first of

    - *pixels*: 0.7 of the Nyquist wave vector;
    - *noise*: C falls under `noise_margin` times its level at the Nyquist wave vector, which bounds noise and
      short waves folded back by the pixels;
    - *tip*: the roughness of an octave is curved like the tip, R sqrt(2 pi q^6 C) > `tip_margin` (dilation
      takes 20 % of C there; the fit corrects the known part);
    - *filter*: the instrument's shortest wave, where `shortest_wave_nm` states one.

    `noise_psd` (nm^4) is a stated white level; the level at Nyquist counts where it is higher.
    """
    q, psd = spectrum.q, spectrum.psd
    low = lowest_shell * spectrum.spacing
    tail = float(psd[-1])
    if len(q) > 20:  # a converted profile ends before, where its noise has been looked for
        end = psd[q > 0.93 * spectrum.nyquist]
        tail = float(np.median(end)) if len(end) else 0.0
    tail = max(tail, noise_psd)
    smooth = np.exp(_running_mean(np.log(psd), q))
    limits = {"pixels": 0.7 * spectrum.nyquist}
    if shortest_wave_nm:
        limits["filter"] = 2 * np.pi / shortest_wave_nm
    above = q > low
    noisy = above & (smooth < noise_margin * tail)
    if noisy.any():
        limits["noise"] = float(q[noisy][0])
    reach = min(limits.values())
    if tip_radius_nm > 0:
        blunt = above & (tip_radius_nm * np.sqrt(2 * np.pi * smooth) * q**3 > tip_margin)
        if blunt.any():
            limits["tip"] = float(q[blunt][0])
    limit = min(limits, key=lambda key: limits[key])
    return TrustedSpectrum(name, spectrum, low, limits[limit], limit, tip_radius_nm, rms_nm, reach)


def _running_mean(values: np.ndarray, q: np.ndarray, width: float = 0.12) -> np.ndarray:
    """Mean over q (1 - width) ... q (1 + width)."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    first = np.searchsorted(q, q * (1 - width), side="left")
    last = np.searchsorted(q, q * (1 + width), side="right")
    return (total[last] - total[first]) / (last - first)
