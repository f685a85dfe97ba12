"""What the page needs to follow the switch itself: the pad's curves, the switch and the ranges of its sliders."""

import base64
from dataclasses import asdict
from typing import Any

import numpy as np

from asperity.foreign_yaml import load_mapping
from mesoscale.device.beam import beam_of, rests_as_stated
from mesoscale.device.plate import plate_from_settings
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.pad.memory import flats_of
from mesoscale.settings import ContactSettings, DeviceSettings
from workflow.report.available import Results
from workflow.report.numbers import column

WIDEST = 3.0
"""A slider reaches from a third of the scene's value to three times it."""
LARGEST_BOW_NM = 500.0


def switch_data(results: Results) -> dict[str, Any] | None:
    """Curves of the pad (GPa against nm, near to far), settings of the switch, and its sliders."""
    if not results.has("pad/curves.csv", "device/pad_switch.json", "scene.yaml"):
        return None
    scene = load_mapping(results.root / "scene.yaml", "record of a run")["scene"]
    device = DeviceSettings(**scene["device"])
    bends = device.bends and device.electrode_um2 is None
    if results.json("device/pad_switch.json")["central"] is None:
        return None
    if bends and (device.without_lumps or not rests_as_stated(device)):
        return None  # a beam that the page's own model does not follow
    switch = plate_from_settings(device)
    return {
        "device": device.model_dump(mode="json", exclude={"spread"}) | _elastic(device, switch.spring_N_per_m),
        "bends": bends,
        "curves": _curves(results, ContactSettings(**scene["contact"])),
        "sliders": [
            _slider("gap_um", "gap at rest", "µm", device.gap_um),
            _slider("spring_N_per_m", "stiffness", "N/m", switch.spring_N_per_m),
            _slider("area_um2", "area of the pad", "µm²", switch.area_m2 * 1e12),
            *([_bow(device.bow_nm)] if bends else []),
            {**_slider("adhesion", "adhesion, times the scene's", "", 1.0), "low": 0.0},
        ],
    }


def _elastic(device: DeviceSettings, stiffness_N_per_m: float) -> dict[str, Any]:
    """The beam's elastic numbers, which the slider of the stiffness multiplies."""
    if not device.bends:
        return {"elastic": {}, "stiffness_N_per_m": stiffness_N_per_m}
    beam = beam_of(device, 1)
    names = ("bending_N_m2", "tension_N", "stretching_N_m")
    return {"elastic": {name: getattr(beam, name) for name in names}, "stiffness_N_per_m": stiffness_N_per_m}


def _curves(results: Results, contact: ContactSettings) -> dict[str, Any]:
    """The mean pad."""
    rows = results.csv("pad/curves.csv")
    closing = [row for row in rows if row["branch"] == "closing"][::-1]
    separation = column(closing, "separation_nm")
    depths = sorted({float(row["depth_nm"]) for row in rows if row["branch"] == "opening"})
    branches = [closing] + [
        [row for row in rows if row["depth_nm"] and float(row["depth_nm"]) == depth][::-1] for depth in depths
    ]
    mean = [column(branch, f"{kind}_MPa") * 1e-3 for branch in branches for kind in ("repulsive", "attractive")]
    return {
        "separation_nm": _packed(separation),
        "depth_nm": _packed(np.array(depths)),
        "mean": _packed(np.concatenate(mean)),
        "flats": asdict(flats_of(*contact_of(medians(results.csv("inputs.csv")), contact))),
    }


def _packed(values: np.ndarray) -> str:
    return base64.b64encode(values.astype("<f8").tobytes()).decode()


def _slider(name: str, label: str, unit: str, value: float) -> dict[str, Any]:
    return {"name": name, "label": label, "unit": unit, "value": value, "low": value / WIDEST, "high": value * WIDEST}


def _bow(value: float) -> dict[str, Any]:
    reach = max(LARGEST_BOW_NM, 2.0 * abs(value))
    ends = {"low": -reach, "high": reach}
    return {"name": "bow_nm", "label": "bow of the beam at rest", "unit": "nm", "value": value, **ends}
