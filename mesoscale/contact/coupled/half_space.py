"""The elastic half-space under a periodic cell: its Green's function, as a table and by FFT.

A pressure of wave vector q bends the surface by 2 / (E* abs(q)) times itself (K. L. Johnson,
Contact Mechanics, 1985, section 13.2), times the softness of its layers (`layers`). The mean is
left out: it shifts the half-space as a whole, and the separation of the mean planes is what is
prescribed.
"""

from functools import lru_cache

import numpy as np
from scipy import fft

from mesoscale.contact.coupled import layers
from mesoscale.settings.contact import Body

BLOCK = 2**17  # sites whose rows are transformed at a time, so that they stay in the cache


def wave_numbers(pixels: int) -> np.ndarray:
    """abs(q) L / 2 pi of the modes of a real transform, shape (pixels, pixels // 2 + 1)."""
    along_x = np.fft.fftfreq(pixels, 1 / pixels)
    along_y = np.fft.rfftfreq(pixels, 1 / pixels)
    return np.hypot(along_x[:, None], along_y[None, :])


@lru_cache(maxsize=4)
def softness(pixels: int, length: float, bodies: tuple[Body, ...]) -> np.ndarray:
    """Compliance of all modes over that of the bases alone, shape (pixels, pixels // 2 + 1) or ();
    1 for the mean.
    """
    if not bodies:
        return np.ones(())
    number = wave_numbers(pixels)
    number[0, 0] = 1.0
    q = number * (2.0 * np.pi / length)
    shares = layers.softness_spline(bodies, float(q.min()), float(q.max()))(np.log(q))
    shares[0, 0] = 1.0
    return shares


def wave_compliance(
    pixels: int, length: float, e_star: float, bodies: tuple[Body, ...]
) -> np.ndarray:
    """Compliance of all modes, nm/GPa, shape (pixels, pixels // 2 + 1); 0 for the mean."""
    number = wave_numbers(pixels)
    number /= softness(pixels, length, bodies)
    number[0, 0] = np.inf
    return np.divide(length / (np.pi * e_star), number, out=number)


@lru_cache(maxsize=4)
def influence(pixels: int, length: float, bodies: tuple[Body, ...]) -> np.ndarray:
    """Displacement (in L / E*) at sites 0 .. pixels/2 in x and y from a unit pressure on one site
    (in E*).

    Shape (pixels // 2 + 1, pixels // 2 + 1); the rest of the cell follows by its symmetry.
    """
    half = pixels // 2 + 1
    number = wave_numbers(pixels)
    number[0, 0] = np.inf
    spectrum = softness(pixels, length, bodies) / number
    table = np.asarray(fft.irfft2(spectrum, s=(pixels, pixels))) / np.pi
    table = np.ascontiguousarray(table[:half, :half])
    table.flags.writeable = False
    return table


def convolve(
    pressure: np.ndarray,
    rows: np.ndarray,
    compliance: np.ndarray,
    room: np.ndarray,
    wanted: np.ndarray,
) -> np.ndarray:
    """Displacements (nm) of wanted rows of a cell by the pressures (GPa) on some rows, the others
    having none.

    Only these rows are transformed, and the columns in place. On 2048^2 sites this takes two thirds
    of the time of `rfft2` and `irfft2` for all rows, and half for a quarter of them.

    Parameters
    ----------
    pressure : (rows, N), single or double precision, as `compliance` (N, N // 2 + 1), nm/GPa
    rows, wanted : numbers of rows, rising
    room : for the spectrum, as large as `compliance`, complex in double precision; its contents are
        lost
    """
    pixels = pressure.shape[1]
    in_its_precision = room.view(np.result_type(pressure, np.complex64))
    spectrum = in_its_precision[: compliance.size].reshape(compliance.shape)
    moved = np.empty((wanted.size, pixels), pressure.dtype)
    step = max(BLOCK // pixels, 1)
    if rows.size < len(spectrum):
        spectrum[:] = 0.0
    for start in range(0, rows.size, step):
        spectrum[rows[start : start + step]] = fft.rfft(pressure[start : start + step])
    spectrum = np.asarray(fft.fft(spectrum, axis=0, overwrite_x=True))
    spectrum *= compliance
    spectrum = np.asarray(fft.ifft(spectrum, axis=0, overwrite_x=True))
    for start in range(0, wanted.size, step):
        block = wanted[start : start + step]
        moved[start : start + step] = fft.irfft(spectrum[block], n=pixels)
    return moved


def convolve_map(pressure: np.ndarray, compliance: np.ndarray, room: np.ndarray) -> np.ndarray:
    """Displacements (nm) of the sites of a map by their pressures (GPa), in the corner of a cell
    whose other sites have none.

    They lie at the start of the room, over the spectrum. On 16,384^2 sites new memory for them
    takes as long as the transforms.

    Parameters
    ----------
    pressure : (nx, ny), single or double precision, as `compliance` (N, N // 2 + 1), nm/GPa
    room : for the spectrum, as large as `compliance`, complex in this precision
    """
    rows, columns = pressure.shape
    pixels = len(compliance)
    spectrum = room.reshape(compliance.shape)
    moved = room.view(pressure.dtype)[: pressure.size].reshape(pressure.shape)
    step = max(BLOCK // pixels, 1)
    blocks = [slice(start, min(start + step, rows)) for start in range(0, rows, step)]
    spectrum[rows:] = 0.0
    for block in blocks:
        spectrum[block] = fft.rfft(pressure[block], n=pixels)
    spectrum = np.asarray(fft.fft(spectrum, axis=0, overwrite_x=True))
    spectrum *= compliance
    spectrum = np.asarray(fft.ifft(spectrum, axis=0, overwrite_x=True))
    for block in blocks:
        rows_moved = np.asarray(fft.irfft(spectrum[block], n=pixels))
        moved[block] = rows_moved[:, :columns]
    return moved


def rows_of(row: np.ndarray, pixels: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows of a cell in which sites lie, rising, and the place of each site's row among them."""
    present = np.bincount(row, minlength=pixels) > 0
    return np.flatnonzero(present), (np.cumsum(present) - 1)[row]


def stiffness_between_neighbours(table: np.ndarray) -> np.ndarray:
    """Pressures (E* / L) on a site and the eight around it that move this site alone by 1, row by
    row, shape (9,).

    The stiffness of the half-space falls off with the third power of the distance. So these
    precondition a contact nearly as well as the stiffness of all sites: 11 to 16 steps to 1e-6 for
    10 to 15, at 1 to 75 % contact.
    """
    row, col = np.divmod(np.arange(9), 3)
    between = table[np.abs(row[:, None] - row), np.abs(col[:, None] - col)]
    return np.linalg.inv(between)[4]
