"""How does the work that opens rough films grow with humidity, and where does it jump?

Polysilicon on polysilicon with a native oxide, uncorrelated or correlated: two surfaces of RMS height s whose heights
have the correlation c are one of s sqrt(2 (1 - c)) on a flat, and a row states that. Pads of a few cells are closed to
1 MPa and opened from there; the work counts from zero net force on. DelRio et al. (2007, doi:10.1063/1.2723658) found
the work of dispersion up to a threshold of humidity, and then a jump towards 144 mJ/m2. Nothing here is fitted to them.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import product
from typing import Any

import numpy as np

from mesoscale.contact.menisci import reach_nm
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.cells import SideBySide, sample_cells
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import AirSettings

ROUGHNESS_NM = (0.5, 1.0, 2.0, 3.5, 5.0, 10.0, 15.0)
HUMIDITIES = (0.0, 0.02, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95)
CELLS = 8
LOAD_GPa = 1e-3
STEP_NM = 0.1
WET_J_M2 = 0.144
# E* of two walls of polysilicon, 169 GPa and nu 0.22 (Sharpe, Yuan and Edwards, J. MEMS 6 (1997) 193); A_H of silica
FILM = {"hamaker": 0.065, "e_star": 88.8, "h_macro": 12.0, "h_prime": 0.0, "q0": 0.02, "hurst": 0.75}


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each roughness and humidity."""
    with ProcessPoolExecutor(2) as pool:
        yield from pool.map(_opened, *zip(*product(ROUGHNESS_NM, HUMIDITIES), strict=True))


def _opened(rms: float, humidity: float) -> dict[str, Any]:
    inputs = ContactInputs(**FILM, rms=rms)
    air = AirSettings(humidity=humidity)
    contact = ContactSettings(
        mechanics="coupled", pixels=128, q1_per_nm=0.4, gap_cutoff_nm=0.2, air=air if humidity else None
    )
    pad = SideBySide(inputs, contact, sample_cells(inputs, CELLS))
    top = float(pad.first_contact_nm.max()) + STEP_NM
    filled = reach_nm(contact.air)
    far = np.geomspace(max(200.0, 3.0 * (top + filled)), top + filled, 40)
    bridged = np.linspace(top + filled, top, 40)[1:] if filled else np.empty(0)
    way = [*far, *bridged]
    for separation in way:
        pad.close_to(float(separation))
    load = 0.0
    while load < LOAD_GPa:
        way.append(way[-1] - min(STEP_NM, 0.02 * rms))
        load = pad.close_to(float(way[-1]))
    forces = np.array([cell.opening().sum(axis=0) for cell in pad.cells])
    separation, net = np.array(way)[::-1], (pad.share @ forces)[::-1]
    first = int(np.argmax(net < 0.0))
    work = -np.trapezoid(net[first:], separation[first:])
    return {
        "rms_nm": rms,
        "humidity": humidity,
        "d_c_nm": filled,
        "zero_force_nm": separation[first],
        "work_mJ_m2": 1e3 * work,
        "pull_off_MPa": -1e3 * net.min(),
        "settled": all(cell.settled for cell in pad.cells),
    }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Work (mJ/m2) dry, at 50 and 95 %; the first humidity with a tenth of the work of wet flats."""
    said = {}
    for rms in ROUGHNESS_NM:
        part = [row for row in rows if float(row["rms_nm"]) == rms]
        work = {float(row["humidity"]): float(row["work_mJ_m2"]) for row in part}
        wet = [humidity for humidity, value in work.items() if value > 1e2 * WET_J_M2]
        name = f"{rms:g}".replace(".", "_")
        for key, humidity in (("dry", 0.0), ("half", 0.5), ("damp", 0.95)):
            said[f"{key}_{name}"] = f"{work[humidity]:.{2 if work[humidity] < 100 else 3}g}"
        said[f"jump_{name}"] = f"{min(wet):.0%}" if wet else "above 95%"
    return said
