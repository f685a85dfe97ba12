"""How does the work that opens rough films grow with humidity, and where does it jump?

Polysilicon on polysilicon with a native oxide. Each wall has the RMS height s; two whose heights
have the correlation c are one of s sqrt(2 (1 - c)) on a flat. Pads of a few cells are closed to 1
MPa and opened from there; the work counts from zero net force on. DelRio et al. (2007,
doi:10.1063/1.2723658) found the work of dispersion up to a threshold of humidity, and then a jump
towards 144 mJ/m2. Nothing here is fitted to them.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np

from mesoscale.contact.menisci import reach_nm
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.cells import sample_cells
from mesoscale.pad.pilots import SideBySide
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import AirSettings

ROUGHNESS_NM = (2.0, 5.0, 10.0, 15.0)
CORRELATIONS = (0.0, 0.9)
HUMIDITIES = (0.0, 0.05, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95)
CELLS = 16
LOAD_GPa = 1e-3
STEP_NM = 0.1
WET_J_M2 = 0.144
# E* of two walls of polysilicon, 169 GPa and nu 0.22 (Sharpe, Yuan and Edwards, J. MEMS 6 (1997)
# 193)
FILM = {"e_star": 88.8, "h_macro": 12.0, "h_prime": 0.0, "q0": 0.02, "hurst": 0.75}
# A_H of silica, and its share across water (Bergstrom 1997, doi:10.1016/S0001-8686(97)00003-1)
HAMAKER, SHARE = 0.065, 0.07


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each roughness, correlation and humidity."""
    for rms, correlation, humidity in product(ROUGHNESS_NM, CORRELATIONS, HUMIDITIES):
        both = rms * float(np.sqrt(2.0 * (1.0 - correlation)))
        inputs = ContactInputs(**FILM, hamaker=HAMAKER, rms=both)
        opened = open_pad(
            inputs, AirSettings(humidity=humidity, hamaker_share=SHARE), LOAD_GPa, CELLS
        )
        yield {
            "rms_nm": rms,
            "correlation": correlation,
            "combined_nm": both,
            "humidity": humidity,
            **opened,
        }


def open_pad(
    inputs: ContactInputs, air: AirSettings, load_GPa: float, cells: int
) -> dict[str, Any]:
    """Work that opens a pad after a load, and its pull-off."""
    contact = ContactSettings(
        mechanics="coupled",
        pixels=128,
        q1_per_nm=0.4,
        gap_cutoff_nm=0.2,
        air=air if air.humidity else None,
    )
    pad = SideBySide(inputs, contact, sample_cells(inputs, cells))
    top = float(pad.first_contact_nm.max()) + STEP_NM
    filled = reach_nm(contact.air, inputs.hamaker)
    far = np.geomspace(max(200.0, 3.0 * (top + filled)), top + filled, 40)
    bridged = np.linspace(top + filled, top, 40)[1:] if filled else np.empty(0)
    way = [*far, *bridged]
    for separation in way:
        pad.close_to(float(separation))
    load = 0.0
    while load < load_GPa:
        way.append(way[-1] - min(STEP_NM, 0.02 * inputs.rms))
        load = pad.close_to(float(way[-1]))
    forces = np.array([cell.opening().sum(axis=0) for cell in pad.cells])
    separation, net = np.array(way)[::-1], (pad.share @ forces)[::-1]
    first = int(np.argmax(net < 0.0))
    work = -np.trapezoid(net[first:], separation[first:])
    return {
        "d_c_nm": filled,
        "work_mJ_m2": 1e3 * work,
        "pull_off_MPa": -1e3 * net.min(),
        "settled": all(cell.settled for cell in pad.cells),
    }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Work (mJ/m2) dry, at 50 and 95 %; the first humidity with a tenth of the work of wet
    flats.
    """
    said = {}
    for rms, correlation in product(ROUGHNESS_NM, CORRELATIONS):
        part = [
            row
            for row in rows
            if (float(row["rms_nm"]), float(row["correlation"])) == (rms, correlation)
        ]
        work = {float(row["humidity"]): float(row["work_mJ_m2"]) for row in part}
        wet = [humidity for humidity, value in work.items() if value > 1e2 * WET_J_M2]
        name = f"{rms:g}_{'like' if correlation else 'own'}"
        for key, humidity in (("dry", 0.0), ("half", 0.5), ("damp", 0.95)):
            said[f"{key}_{name}"] = f"{work[humidity]:.{2 if work[humidity] < 100 else 3}g}"
        said[f"jump_{name}"] = f"{min(wet):.0%}" if wet else "above 95%"
    return said
