"""Do intervals of measured devices hold their truths, and what does a measurement take off?

`made up`: devices are drawn from the stated spread and measured with an error; `held` of their
properties lie in their 90 % intervals. `release`: devices of the spread are solved on a pad, as
stated (`none`) and after what was measured. Folders hold results of target `answer`, whose pads at
central inputs are taken; other devices than the default on the same pads.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from evidence.circuit.loop import central_pad
from mesoscale.answer.departures import departed_properties, with_properties
from mesoscale.answer.measured import narrowed, observed
from mesoscale.answer.spread import properties_at
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import DeviceSettings
from mesoscale.switch import release_or_nan_V

ERRORS = {"pull_in_V": 1.0, "capacitance_fF": 1.0, "resonance_kHz": 0.3}
SETS = (
    ("pull_in_V",),
    ("pull_in_V", "capacitance_fF"),
    ("pull_in_V", "capacitance_fF", "resonance_kHz"),
)
NICKEL = {"density_g_cm3": 8.9}
ALUMINIUM = {
    "youngs_modulus_GPa": 70.3,
    "poisson_ratio": 0.345,
    "density_g_cm3": 2.7,
    "excess_expansion_ppm_C": 20.5,
}
DEVICES: dict[str, dict[str, Any]] = {
    "default": NICKEL,
    "aluminium_bridge": ALUMINIUM
    | {
        "length_um": 300.0,
        "width_um": 100.0,
        "thickness_um": 2.0,
        "gap_um": 2.0,
        "residual_stress_MPa": 40.0,
    },
    "cantilever": NICKEL
    | {
        "ends": "cantilever",
        "length_um": 150.0,
        "width_um": 100.0,
        "thickness_um": 4.0,
        "gap_um": 2.0,
        "electrode": (0.3, 0.8),
        "contact": (0.9, 1.0),
        "dimple_nm": 500.0,
    },
}
"""Sizes were chosen before anything was solved; all else is the default."""
STATED = DeviceSettings(**NICKEL)
SWITCHES = 48
"""Of a release interval."""


def arguments(parser: ArgumentParser) -> None:
    """Results to take pads from, or how many devices to make up."""
    parser.add_argument("results", nargs="*", type=Path)
    parser.add_argument("--made-up", type=int, default=0)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each made-up device, and for each pad and set of measurements."""
    for number in range(given.made_up):
        yield _made_up(number)
    for folder in given.results:
        pad = central_pad(folder)[1]
        for device in DEVICES:
            for names in ((), *SETS):
                yield {"pad": folder.name} | _release(device, names, pad)


def _made_up(number: int) -> dict[str, Any]:
    rng = np.random.default_rng(np.random.SeedSequence([76, number]))
    truth = properties_at(STATED, rng.random((1, len(STATED.varied))))[0]
    names = SETS[number % len(SETS)]
    true = observed(with_properties(STATED, truth))
    measured = {name: (true[name] + ERRORS[name] * rng.normal(), ERRORS[name]) for name in names}
    found = narrowed(DeviceSettings(density_g_cm3=8.9, measured=measured))
    moved = found.table.transform(rng.random((4000, len(truth))))
    low, high = np.quantile(departed_properties(STATED, moved), (0.05, 0.95), axis=0)
    return {
        "kind": "made up",
        "pad": "",
        "device": f"{number}",
        "measured": " ".join(names),
        "held": int(((low < truth) & (truth < high)).sum()),
        "of": truth.size,
        "low_V": "",
        "high_V": "",
    }


def _release(device: str, names: tuple[str, ...], pad: PadCurves) -> dict[str, Any]:
    from scipy.stats import qmc

    stated = DeviceSettings(**DEVICES[device])
    true = observed(stated)
    measured = {name: (true[name], ERRORS[name]) for name in names}
    settings = DeviceSettings(**DEVICES[device], measured=measured or None)
    units = qmc.LatinHypercube(len(stated.varied), rng=0).random(SWITCHES)
    releases = [
        release_or_nan_V(with_properties(stated, row), pad, coarse=True)
        for row in properties_at(settings, units)
    ]
    low_V, high_V = np.nanquantile(releases, (0.05, 0.95))
    return {
        "kind": "release",
        "device": device,
        "measured": " ".join(names) or "none",
        "held": "",
        "of": np.isfinite(releases).sum(),
        "low_V": float(low_V),
        "high_V": float(high_V),
    }


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Shares of truths in their intervals, and release intervals."""
    shown = {}
    made_up = [row for row in table if row["kind"] == "made up"]
    for names in ("", *map(" ".join, SETS)):
        these = [row for row in made_up if names in ("", row["measured"])]
        if these:
            share = sum(int(row["held"]) for row in these) / sum(int(row["of"]) for row in these)
            shown[f"held_{len(names.split()) or 'all'}"] = f"{share:.0%}"
    shown["devices"] = str(len(made_up))
    for row in table:
        if row["kind"] == "release":
            count = 0 if row["measured"] == "none" else len(row["measured"].split())
            name = f"{row['pad']}_{row['device']}_{count}"
            shown[name] = f"{float(row['low_V']):.3g} to {float(row['high_V']):.3g} V"
    return shown
