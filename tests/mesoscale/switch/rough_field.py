"""The field of charge under a rough electrode: finite elements, and the formula gap by gap."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from mesoscale.units import NM, VACUUM_PERMITTIVITY

COLUMNS = 480
BELOW, ABOVE = 60, 16


@dataclass(frozen=True)
class Roughness:
    """A periodic electrode with one wave, over a flat dielectric."""

    length_nm: float
    wave_nm: float
    height_nm: float
    gap_nm: float

    @property
    def places(self):
        return self.length_nm * np.arange(COLUMNS) / COLUMNS

    @property
    def gaps(self):
        wave = np.cos(2.0 * np.pi * self.places / self.wave_nm + 0.3)
        return self.gap_nm + self.height_nm * wave


def pull_Pa(rough, density, device, step_nm=0.05):
    """Pressure on the electrode: energy of the charge, by the gap; linear triangles."""
    nearer, farther = (_energy_J_m2(rough, density, device, sign * step_nm) for sign in (-1.0, 1.0))
    return (farther - nearer) / (2.0 * step_nm * NM)


def _energy_J_m2(rough, density, device, lifted_nm):
    """Energy per area of the charge between grounded electrodes."""
    gaps = rough.gaps + lifted_nm
    # nodes: grounded bottom, dielectric (finer towards the charge), gap, grounded top
    below = device.dielectric_nm * (1.0 - (1.0 - np.arange(BELOW + 1) / BELOW) ** 2)
    above = device.dielectric_nm + np.outer(gaps, np.arange(1, ABOVE + 1) / ABOVE)
    heights = np.column_stack([np.broadcast_to(below, (COLUMNS, BELOW + 1)), above])
    rows = heights.shape[1]
    number = np.arange(COLUMNS * rows).reshape(COLUMNS, rows)
    right = np.roll(number, -1, axis=0)
    corners = [
        np.stack([number[:, :-1], right[:, :-1], right[:, 1:]], -1).reshape(-1, 3),
        np.stack([number[:, :-1], right[:, 1:], number[:, 1:]], -1).reshape(-1, 3),
    ]
    spacing = rough.length_nm / COLUMNS
    y = heights.ravel()
    layer = np.broadcast_to(np.arange(rows - 1) < BELOW, (COLUMNS, rows - 1)).ravel()
    relative = np.where(layer, device.permittivity, 1.0)
    rows_at, columns_at, entries = [], [], []
    for triangles, across in zip(corners, ((0.0, 1.0, 1.0), (0.0, 1.0, 0.0)), strict=True):
        x = np.broadcast_to(spacing * np.array(across), triangles.shape)
        tall = y[triangles]
        b = np.roll(tall, -1, axis=1) - np.roll(tall, 1, axis=1)
        c = np.roll(x, 1, axis=1) - np.roll(x, -1, axis=1)
        twice = np.abs(x[:, 0] * b[:, 0] + x[:, 1] * b[:, 1] + x[:, 2] * b[:, 2])
        local = (b[:, :, None] * b[:, None] + c[:, :, None] * c[:, None]) / (2.0 * twice)[
            :, None, None
        ]
        entries.append((relative[:, None, None] * local).ravel())
        rows_at.append(np.repeat(triangles, 3, axis=1).ravel())
        columns_at.append(np.tile(triangles, 3).ravel())
    size = number.size
    matrix = coo_matrix(
        (np.concatenate(entries), (np.concatenate(rows_at), np.concatenate(columns_at))),
        shape=(size, size),
    ).tocsc()
    surface = number[:, BELOW]
    free = number[:, 1:-1].ravel()
    source = np.zeros(size)
    source[surface] = density * spacing * NM / VACUUM_PERMITTIVITY
    potential = np.zeros(size)
    potential[free] = splu(matrix[free][:, free]).solve(source[free])
    return 0.5 * float((density * potential[surface]).mean())


def gap_by_gap_Pa(rough, density, device):
    """The same by the field of waves between flats, each place with its own gap."""
    waves = np.fft.rfft(density)
    wave_numbers = 2.0 * np.pi * np.arange(waves.size) / rough.length_nm
    gaps = np.broadcast_to(rough.gaps, density.shape)
    field = np.empty(density.size)
    for place, gap in enumerate(gaps):
        filtered = np.zeros_like(waves)
        k = wave_numbers[1:]
        screened = np.sinh(k * gap) * (
            1.0 / np.tanh(k * gap) + device.permittivity / np.tanh(k * device.dielectric_nm)
        )
        filtered[1:] = waves[1:] / screened
        field[place] = np.fft.irfft(filtered, density.size)[place] / VACUUM_PERMITTIVITY
    return 0.5 * VACUUM_PERMITTIVITY * float(np.mean(field**2))
