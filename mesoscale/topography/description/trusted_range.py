"""The wave vectors that an instrument leaves undisturbed, and what its tip and window change.

Levelling and the window change the longest waves, pixels, noise and the tip the shortest.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from mesoscale.errors import InputError
from mesoscale.topography.description.treatment import restored, treatment_of
from mesoscale.topography.measurements.cleaning import Scan, form_share
from mesoscale.topography.measurements.loading import Measurement
from mesoscale.topography.measurements.profiles import Profile
from mesoscale.topography.profile_conversion import binned_line, isotropic_spectrum, line_spectrum
from mesoscale.topography.spectrum import Spectrum, hann_spectrum


@dataclass(frozen=True)
class Trust:
    """How far spectra are trusted and corrected, by simulated scans of known truth."""

    tip_bias: tuple[float, float] = (0.5, 1.3)
    """Dilation lowers C by exp(-a k^b), k = R sqrt(2 pi q^6 C) the tip's curvature per octave.

    Measured on slopes 2.3-3.8, RMS 3 and 8 nm, tips of 2-10 nm: one curve to 3 %."""

    blunt_bias: float = 0.45
    """Times k is -ln of what dilation leaves beyond k = 0.5 (slopes 2.4-4.2, tips of 5-20 nm)."""

    blunt_error: float = 0.3
    """Share of this correction that is unknown: 0.15 of ln C at k = 1.5 and 0.2 at 2.5."""

    curved: float = 0.5
    """k at which a range ends."""

    most_curved: float = 2.0
    """k up to which a range can be corrected beyond its end."""

    levelled_error: float = 0.5
    """Of ln C in the first shells, after their blur is taken out."""

    noise: float = 20.0
    """C over the level of the noise at which a range ends."""

    lowest_shell: float = 2.5
    """Below, levelling and the window change a map's waves."""

    lowest_wave: float = 2.5
    """Below, the window and the line taken off a profile change its waves."""

    lowest_wave_bow: float = 4.0
    """Below, the parabola taken off a profile changes its waves."""

    pixels: float = 0.7
    """Of Nyquist: end of a map's range."""

    even_line: float = 0.35
    """Of Nyquist, of a line. Short waves folded back lift C1 by 6 % here (slope 2.84)."""

    uneven_line: float = 0.5
    """Of Nyquist: straight lines between uneven points smooth."""


TRUST = Trust()
MOST_ROUNDS = 12  # for the tip's correction, whose error falls to a half or less in each
SETTLED = 1e-3  # change of ln C in the last round; beyond, a correction has not settled


def curvature(
    radius_nm: np.ndarray | float, q: np.ndarray, psd: np.ndarray, raised: np.ndarray | float = 1
) -> np.ndarray:
    """A tip's radius times the curvature per octave of roughness of spectrum `psd` x `raised`."""
    return radius_nm * np.sqrt(2 * np.pi * psd * raised) * q**3


def tip_bias(curved: np.ndarray) -> np.ndarray:
    """-ln of what dilation leaves of C where the `curvature` is `curved`."""
    return TRUST.tip_bias[0] * np.minimum(curved, 3.0) ** TRUST.tip_bias[1]


def blur(slope: float, shell: np.ndarray) -> np.ndarray:
    """ln of what the Hann window and the shells' width add to a power law at shell number `shell`.

    The window spreads each wave vector over its neighbours (variance 1/3 shell^2 along each axis),
    the shell averages over its width (variance 1/12); both lift a convex spectrum.
    """
    return np.log1p((slope**2 / 6 + slope * (slope + 1) / 24) / shell**2)


@dataclass(frozen=True)
class TrustedSpectrum:
    """A scan's spectrum with the range of wave vectors that the instrument leaves undisturbed.

    Attributes
    ----------
    low, high : trusted wave vectors, 1/nm.
    limit : what ends the range above: `tip`, `noise`, `pixels` or `filter`.
    tip_radius_nm : radius used for the tip's correction.
    rms_nm : RMS of the cleaned heights, with what a filter took of it.
    reach : where the range would end without the tip, 1/nm; between `high` and here the tip's
        correction is large.
    side_nm : side of a square of a measured map's area; 0 for a line profile.
    form : ln of what a parabola would take of the mean square height, besides the levelling.
    parabola : the levelling took one.
    line : of a line profile, C1(k) in nm^3 on bins inside its trusted range; None for a scan.
    treatment : what was done to a map, a kind of `treatment.Treatment`; empty where nothing shows.
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
    parabola: bool = False
    line: Spectrum | None = None
    treatment: str = ""

    @property
    def trusted(self) -> np.ndarray:
        """(m,) bool: shells inside the range."""
        return (self.spectrum.q >= self.low) & (self.spectrum.q <= self.high)

    def corrected_psd(self) -> np.ndarray:
        """(m,) C with the tip's bias taken out, nm^4; meaningful inside the trusted range."""
        q, psd = self.spectrum.q, self.spectrum.psd
        smooth = _smooth(psd, q)
        bias = np.zeros_like(q)
        for _ in range(5):
            bias = tip_bias(curvature(self.tip_radius_nm, q, smooth, np.exp(bias)))
        return psd * np.exp(bias)


def with_ends(item: TrustedSpectrum) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The trusted shells with those beyond its ends that can be corrected, at a price.

    Above, up to where the roughness is `most_curved` times as curved as the tip; below, down to the
    first shell.

    Returns
    -------
    use : (m,) bool, the shells.
    psd : (m,) C with the tip's bias and the window's blur taken out, nm^4.
    error : (m,) error of ln C that the correction leaves; 0 in the trusted range.

    Raises
    ------
    InputError : the tip's correction does not settle.
    """
    q, psd = item.spectrum.q, item.spectrum.psd
    smooth = _smooth(psd, q)
    curved = bias = np.zeros_like(q)
    previous = bias
    for _ in range(MOST_ROUNDS):
        previous = bias
        curved = curvature(item.tip_radius_nm, q, smooth, np.exp(bias))
        blunt = TRUST.blunt_bias * np.minimum(curved, 2 * TRUST.most_curved)
        bias = np.where(curved < 0.5, tip_bias(curved), blunt)
    use = (q >= item.low) & (q <= max(item.high, item.reach))
    blunt = curved > TRUST.most_curved
    if (blunt & use).any():
        use &= q < q[blunt & use][0]
    _check_settled(item, np.abs(bias - previous)[use])
    error = np.where(q > item.high, TRUST.blunt_error * bias, 0.0)
    psd = psd * np.exp(bias)
    # the window lifts long waves, levelling takes the longest
    if not item.spectrum.sharp and use.sum() > 3:
        long = (q < item.low) & (q > 0.9 * item.spectrum.spacing)
        first_shells = max(4, int(np.sum(use & (q < 3 * item.low))))
        start = np.flatnonzero(use)[:first_shells]
        slope = -np.polyfit(np.log(q[start]), np.log(psd[start]), 1)[0]
        slope = float(np.clip(slope, 0.0, 6.0))
        psd = psd * np.exp(-blur(slope, q / item.spectrum.spacing))
        error = np.where(long, TRUST.levelled_error, error)
        use |= long
    return use, psd, error


def _check_settled(item: TrustedSpectrum, change: np.ndarray) -> None:
    """Refuse a correction of the tip that still changes ln C in its last round."""
    if change.max(initial=0.0) > SETTLED:
        raise InputError(
            f"{item.name}: the correction of a tip of {item.tip_radius_nm:g} nm does not settle:"
            f" ln C still changes by {change.max():.2g} in its last round; state the tip's radius"
            " (topography.instruments), or leave the scan out"
        )


def trusted_map(cleaned: Scan, measured: Measurement) -> TrustedSpectrum:
    """Spectrum of a cleaned scan within what its instrument shows."""
    pixel_nm2 = float(np.prod(cleaned.pixel_nm))
    white = (measured.noise_nm or 0.0) ** 2 * pixel_nm2 / (2 * np.pi) ** 2
    spectrum = hann_spectrum(cleaned)
    rms_nm = cleaned.rms_nm
    shortest_nm = measured.shortest_wave_nm
    raw = measured.data
    treated = None
    if isinstance(raw, Scan):
        treated = treatment_of(raw, cleaned, spectrum)
    if treated is not None:
        spectrum, rms_nm = restored(spectrum, treated, rms_nm)
        shortest_nm = max(shortest_nm or 0.0, 2 * np.pi / treated.end)
    limits = trusted_range(
        cleaned.name, spectrum, measured.tip_radius_nm, rms_nm, shortest_nm, white
    )
    side_nm = float(np.sqrt(np.prod(cleaned.lengths_nm)))
    form = form_share(cleaned.heights_nm)
    treatment = treated.kind if treated is not None else ""
    return replace(limits, side_nm=side_nm, form=form, treatment=treatment)


def trusted_range(
    name: str,
    spectrum: Spectrum,
    tip_radius_nm: float,
    rms_nm: float = 0.0,
    shortest_wave_nm: float | None = None,
    noise_psd: float = 0.0,
) -> TrustedSpectrum:
    """Bound a spectrum to what the instrument resolves.

    Above, the first of

    - *pixels*: 0.7 of the Nyquist wave vector;
    - *noise*: C falls under 20 times its level at the Nyquist wave vector, which bounds noise and
      short waves folded
      back by the pixels;
    - *tip*: the roughness of an octave is curved like the tip, R sqrt(2 pi q^6 C) > 0.5 (dilation
      takes 20 % of C
      there; the fit corrects the known part);
    - *filter*: the instrument's shortest wave, where `shortest_wave_nm` states one, or the end of
      what a map shows
      that was treated (`treatment`).

    `noise_psd` (nm^4) is a stated white level; the level at Nyquist counts where it is higher.
    """
    q, psd = spectrum.q, spectrum.psd
    low = TRUST.lowest_shell * spectrum.spacing
    tail = float(psd[-1])
    if len(q) > 20:  # a converted profile ends before, where its noise has been looked for
        shortest = psd[q > 0.93 * spectrum.nyquist]
        tail = float(np.median(shortest)) if len(shortest) else 0.0
    smooth = _smooth(psd, q)
    limits = {"pixels": TRUST.pixels * spectrum.nyquist}
    if shortest_wave_nm:
        limits["filter"] = 2 * np.pi / shortest_wave_nm
    end = q > 0.7 * spectrum.nyquist
    falls = False
    if end.sum() > 8 and noise_psd < tail:
        slope = np.polyfit(np.log(q[end]), np.log(smooth[end]), 1)[0]
        falls = bool(slope < -1.0)
    # noise is flat at the end; what still falls there are short waves that the pixels fold back
    drowned = smooth < TRUST.noise * max(tail, noise_psd)
    for cause, end_q in _first("pixels" if falls else "noise", q, (q > low) & drowned).items():
        limits[cause] = min(end_q, limits.get(cause, np.inf))
    reach = min(limits.values())
    blunt = curvature(tip_radius_nm, q, smooth) > TRUST.curved
    limits |= _first("tip", q, (q > low) & blunt)
    limit = min(limits, key=lambda key: limits[key])
    return TrustedSpectrum(name, spectrum, low, limits[limit], limit, tip_radius_nm, rms_nm, reach)


def trusted_profile(cleaned: Profile, measured: Measurement) -> TrustedSpectrum:
    """Isotropic spectrum of a levelled profile within what its instrument shows.

    Above, the first of pixels, noise (as seen at the Nyquist wave vector, or as stated), the
    instrument's shortest wave, and the tip, by the same measure as for scans.

    Raises
    ------
    InputError : hardly a wave between the ends of what is trusted.
    """
    k, c1 = line_spectrum(cleaned)
    nyquist = np.pi / cleaned.step_nm
    radius = measured.tip_radius_nm
    lowest_wave = TRUST.lowest_wave_bow if cleaned.bow else TRUST.lowest_wave
    low = lowest_wave * 2 * np.pi / cleaned.length_nm
    pixels = TRUST.uneven_line if cleaned.resampled else TRUST.even_line
    limits = {"pixels": pixels * nyquist}
    if measured.shortest_wave_nm:
        limits["filter"] = 2 * np.pi / measured.shortest_wave_nm
    noise = TRUST.noise * _noise_level(k, c1, cleaned, measured)
    limits |= _first("noise", k, (k > low) & (_smooth_line(k, c1) < noise))
    limit = min(limits, key=lambda key: limits[key])
    high = reach = limits[limit]
    _check_span(cleaned, low, high, limit)
    spectrum = isotropic_spectrum(cleaned, low, reach)
    curved = curvature(radius, spectrum.q, spectrum.psd)
    if blunt := _first("tip", spectrum.q, curved > TRUST.curved):
        limit = "tip"
        high = blunt["tip"]
        _check_span(cleaned, low, high, limit)
        # what the tip has taken beyond would pull the waves below down with it
        reach = float(spectrum.q[curved < TRUST.most_curved][-1])
        spectrum = isotropic_spectrum(cleaned, low, reach)
    line = binned_line(k, c1, low, high)
    return TrustedSpectrum(
        cleaned.name, spectrum, low, high, limit, radius, cleaned.rms_nm, reach, line=line
    )


def _noise_level(k: np.ndarray, c1: np.ndarray, profile: Profile, measured: Measurement) -> float:
    """White level of C1 (nm^3): the stated one, or that seen at Nyquist."""
    if measured.noise_nm is not None:
        return measured.noise_nm**2 * profile.step_nm / (2 * np.pi)
    end = k > 0.93 * np.pi / profile.step_nm
    # the median of an exponential distribution of mean 1
    return float(np.median(c1[end])) / np.log(2)


def _check_span(profile: Profile, low: float, high: float, limit: str) -> None:
    if high < 2 * low:
        raise InputError(
            f"{profile.name}: nothing to see: its waves are trusted from {low:.2g} /nm, but the"
            f" {limit} limit ends them at {high:.2g} /nm; give a longer or finer profile, state its"
            " own tip (topography.instruments; 0 for a side view), or leave it out"
        )


def _first(name: str, q: np.ndarray, reached: np.ndarray) -> dict[str, float]:
    """A limit at the first wave vector where it is reached; none where it never is."""
    if not reached.any():
        return {}
    return {name: float(q[reached][0])}


def _smooth(psd: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Geometric mean over 12 % to each side of q."""
    low = q * (1 - 0.12)
    high = q * (1 + 0.12)
    return np.exp(_windowed_mean(np.log(psd), q, low, high, "right"))


def _smooth_line(k: np.ndarray, c1: np.ndarray) -> np.ndarray:
    """Mean over a quarter to each side, at least 8 wave numbers: single ones scatter by 100 %."""
    width = np.maximum(0.25 * k, 8 * (k[1] - k[0]))
    return _windowed_mean(c1, k, k - width, k + width, "left")


def _windowed_mean(
    values: np.ndarray,
    q: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    side: Literal["left", "right"],
) -> np.ndarray:
    total = np.concatenate([[0.0], np.cumsum(values)])
    first = np.searchsorted(q, low)
    last = np.searchsorted(q, high, side=side)
    return (total[last] - total[first]) / (last - first)
