"""A measured map: its roughness in numbers, and its closing and opening."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.film import Shown
from asperity.pressed_map import (
    map_on_sides,
    material_of_map,
    remark_on_sides,
    surface_of_maps,
)
from mesoscale.contact.compiling import announced
from mesoscale.contact.cycle import Cycle, run_cycle
from mesoscale.contact.surface import ContactAt
from mesoscale.errors import InputError
from mesoscale.extras import needs
from mesoscale.settings import ContactSettings


@dataclass(frozen=True, repr=False)
class Roughness(Shown):
    """What a map says of its roughness, down to its pixels.

    Attributes
    ----------
    rms_nm : RMS height about the mean.
    rms_slope : RMS of the gradient.
    rms_curvature_per_nm : half the RMS of the Laplacian, as summits have it.
    wave_vector_per_nm : of the spectrum, rising, shape (k,).
    psd_nm4 : two-dimensional power spectrum averaged over directions, shape (k,).
    """

    rms_nm: float
    rms_slope: float
    rms_curvature_per_nm: float
    wave_vector_per_nm: np.ndarray
    psd_nm4: np.ndarray

    def lines(self) -> Iterator[str]:
        """One line."""
        yield (
            f"Roughness: RMS height {self.rms_nm:.4g} nm, slope {self.rms_slope:.4g}, curvature"
            f" {self.rms_curvature_per_nm:.4g} /nm"
        )

    def plot(self) -> Any:
        """The spectrum as a Matplotlib figure."""
        with needs("plot"):
            import matplotlib.pyplot as plt
        figure, axes = plt.subplots(figsize=(4.8, 3.6), layout="constrained")
        axes.loglog(self.wave_vector_per_nm, self.psd_nm4)
        axes.set(xlabel="wave vector (1/nm)", ylabel="power spectrum (nm⁴)")
        return figure


def roughness(
    heights: Any, side_nm: float | tuple[float, float], periodic: bool = False
) -> Roughness:
    """RMS height, slope and curvature of a map, and its spectrum, by SurfaceTopography.

    Slope and curvature are those of differences between neighbours. They grow with the resolution,
    unless the map resolves its shortest waves.

    Parameters
    ----------
    heights : (nx, ny) in nm, levelled, without missing values.
    side_nm : length of the map, or its lengths along x and y.
    periodic : the map repeats without end. False: its edges are left out, and windowed in the
        spectrum.

    Raises
    ------
    InputError : no such map or side.
    """
    from SurfaceTopography import Topography  # slow to import

    surface, sides = map_on_sides(heights, side_nm)
    remark_on_sides(surface, sides, calls=1)
    if not (sides > 0.0).all():
        raise InputError(f"side_nm = {side_nm!r:.60}: accepted are lengths in nm, above 0")
    topography = Topography(surface, tuple(sides.tolist()), periodic=periodic)
    wave_vector, psd = topography.power_spectrum_from_area()
    known = np.isfinite(psd) & (wave_vector > 0.0)
    return Roughness(
        float(surface.std()),
        float(topography.rms_gradient()),
        float(topography.rms_curvature_from_area()),
        wave_vector[known],
        psd[known],
    )


def cycle(
    heights: Any,
    side_nm: float | tuple[float, float],
    load_nN: float,
    e_star: float,
    *,
    h_macro: float | None = None,
    h_prime: float = 0.0,
    hamaker: float = 0.0,
    gap_cutoff_nm: float | None = None,
    counterface: Any = None,
    contact_at: ContactAt = "highest",
) -> Cycle:
    """Close a flat onto a map up to a load, and open it again: force against separation.

    The map is square and repeats without end; all sites share one elastic half-space.

    Parameters
    ----------
    heights : (n, n) in nm, levelled, without missing values.
    side_nm : length of the map, or its lengths along x and y, which are the same.
    load_nN : largest repulsive force on the whole map (nN).
    e_star : effective modulus of both bodies, GPa.
    h_macro : hardness (GPa), at which the surface yields; None: elastic.
    h_prime : its size effect, GPa nm^0.5.
    hamaker : Hamaker constant (1e-18 J), by which both walls attract; 0: they do not.
    gap_cutoff_nm : least distance D0 of the attraction; None: that of a scene.
    counterface : (n, n) heights of the second surface as an instrument sees it, as in `press`.
    contact_at : which heights touch first: the highest of measured maps, the lowest of
        `random_surface`.

    Returns
    -------
    The cycle; `plot()` and `to_frame()` of it, and `work` and `dissipated_energy` of its branches.

    Raises
    ------
    InputError : no such map, side, load or material; a load beyond full contact; a tilted map.
    """
    model, inputs = material_of_map(e_star, h_macro, h_prime, hamaker)
    surface, spacing = surface_of_maps(heights, counterface, side_nm, True, contact_at, 0, False)
    chosen: dict[str, Any] = {"model": model, "pixels": len(surface)}
    chosen["length_nm"] = spacing * len(surface)
    if gap_cutoff_nm is not None:
        chosen["gap_cutoff_nm"] = gap_cutoff_nm
    settings = ContactSettings(mechanics="coupled").model_copy(update=chosen)
    with announced():
        return run_cycle(inputs, settings, 0, load_nN, heights=surface, contact_at="lowest")
