"""How hard do capillaries pull rough titanium and titanium oxide? A prediction, before the measurement was looked up.

Van Zwol, Palasantzas and De Hosson (Phys. Rev. E 78 (2008) 031606, arXiv 0809.1502) measured spheres on films with an
RMS height of 0.2 to 15 nm in air of 2 to 40 % humidity. Only this sentence of theirs was known when the rows were made.
A sphere much larger than its roughness is pulled off with 2 pi R W (Derjaguin), W the work of a pad of flats. So a row
states F / (4 pi R gamma), which is 1 for smooth walls that water wets. A Latin hypercube over what they may have had
gives median, 5 and 95 %. Rows keep inputs, commit and date; a comparison goes beside them and changes none.
"""

import argparse
from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np
from scipy.stats import qmc

from evidence.contact.humid import open_pad
from mesoscale.contact.menisci import surface_tension_mN_m
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings.contact import AirSettings

ROUGHNESS_NM, HUMIDITIES = (1.0, 2.0, 5.0, 15.0), (0.02, 0.4)
DRAWS, CELLS = 16, 4
ANGLES_DEG = {"titanium": (40.0, 75.0), "titanium oxide in ultraviolet light": (0.0, 10.0)}  # assumptions
# Ranges. A_H of titanium oxide (Bergstrom 1997); an adsorbed film of up to a layer of water; the rest is assumed.
RANGES = {
    "hamaker": (0.15, 0.20),
    "e_star": (60.0, 120.0),
    "h_macro": (3.0, 10.0),
    "q0": (0.01, 0.05),
    "hurst": (0.6, 0.95),
    "film_nm": (0.0, 0.3),
    "load_GPa": (1e-3, 1e-2),
}


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each wall, roughness and humidity."""
    units = qmc.LatinHypercube(len(RANGES) + 1, rng=0).random(DRAWS)  # the last is the angle
    low, high = np.array(list(RANGES.values())).T
    drawn = low + (high - low) * units[:, :-1]
    for (wall, (least, most)), rms, humidity in product(ANGLES_DEG.items(), ROUGHNESS_NM, HUMIDITIES):
        pulls = []
        for values, share in zip(drawn, units[:, -1].tolist(), strict=True):
            inputs = dict(zip(RANGES, values.tolist(), strict=True))
            film, load = inputs.pop("film_nm"), inputs.pop("load_GPa")
            angle = least + (most - least) * share
            air = AirSettings(humidity=humidity, contact_angles_deg=(angle, angle), film_nm=film)
            opened = open_pad(ContactInputs(**inputs, h_prime=0.0, rms=rms), air, load, CELLS)
            pulls.append(opened["work_mJ_m2"] / (2.0 * surface_tension_mN_m(air)))
        bounds = dict(zip(("low", "median", "high"), np.quantile(pulls, (0.05, 0.5, 0.95)).tolist(), strict=True))
        ranges = {name: f"{a:g} to {b:g}" for name, (a, b) in {"angle_deg": (least, most), **RANGES}.items()}
        yield {"wall": wall, "rms_nm": rms, "humidity": humidity, **bounds, "draws": DRAWS, **ranges}
