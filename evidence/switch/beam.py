"""What does the beam do to pull-in and release, cause by cause, and is it that of finite
differences?

Causes are added one by one: `bending` alone, `stretching`, `plate` for the modulus of a wide beam,
`fringe` for the field at the sides. Then each property of the device departs by one standard
deviation to either side, and E is that of other nickel. `by`: the product's elements, or a plain
twin by finite differences, from the snap on. Folders hold results of target `answer`, with their
cells at central inputs.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from time import process_time
from typing import Any

from evidence.circuit.loop import central_pad
from evidence.switch import finite_differences
from mesoscale.answer.spread import departed
from mesoscale.pad.curves import on_deep_enough
from mesoscale.settings import DeviceSettings
from mesoscale.studies.answer_stability import solved_beam
from mesoscale.switch import switch_of

CAUSES = {
    "bending": {"bends_as": "beam", "fringe": 0.0, "anchor_um_per_N": 1e9},
    "stretching": {"bends_as": "beam", "fringe": 0.0},
    "plate": {"fringe": 0.0},
    "fringe": {},
}
OTHER_NICKEL_GPa = 200.0
"""Of plated nickel bridges (Cantwell et al., J. MEMS 21 (2012) 840)."""
ELEMENTS = (64, 128, 256)


def arguments(parser: ArgumentParser) -> None:
    """Results to take pads from."""
    parser.add_argument("results", nargs="+", type=Path)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each scene, case and method."""
    for folder in given.results:
        device, pad = central_pad(folder)
        for case, change in CAUSES.items():
            settings = device.model_copy(update=change)
            for elements in ELEMENTS:
                yield {"scene": folder.name, "case": case, **_by_elements(settings, pad, elements)}
            if case != "bending":  # whose twin has rigid anchors
                yield {"scene": folder.name, "case": case, **_by_differences(settings, pad)}
        for case, settings in _departed(device):
            yield {"scene": folder.name, "case": case, **_by_elements(settings, pad, ELEMENTS[1])}


def _departed(device: DeviceSettings) -> Iterator[tuple[str, DeviceSettings]]:
    # the probability one standard deviation out
    for name, less, more in departed(device, 0.841345):
        yield f"{name} -", less
        yield f"{name} +", more
    yield "temperature_C +", device.model_copy(update={"temperature_C": device.temperature_C + 1.0})
    yield "other nickel", device.model_copy(update={"youngs_modulus_GPa": OTHER_NICKEL_GPa})


def _by_elements(settings: DeviceSettings, pad: Any, elements: int) -> dict[str, Any]:
    started = process_time()
    states = solved_beam(settings, pad, elements)
    volts = {"pull_in_V": states.pull_in_V, "release_V": states.release_V}
    return {"by": f"{elements} elements", **volts, "cpu_s": process_time() - started}


def _by_differences(settings: DeviceSettings, pad: Any) -> dict[str, Any]:
    started = process_time()
    _, pad = on_deep_enough(pad, switch_of(settings).states_on)
    pull_in, release = finite_differences.release(settings, pad)
    return {
        "by": "finite differences",
        "pull_in_V": pull_in,
        "release_V": release,
        "cpu_s": process_time() - started,
    }


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Release by cause, and what elements and finite differences differ by."""
    shown, wanted = {}, f"{ELEMENTS[1]} elements"
    by = {(row["scene"], row["case"], row["by"]): row for row in table}
    for scene in dict.fromkeys(row["scene"] for row in table):
        for case in CAUSES:
            shown[f"{scene}_{case}"] = f"{float(by[scene, case, wanted]['release_V']):.3g} V"
    for column in ("pull_in_V", "release_V"):
        apart = [
            abs(float(by[scene, case, wanted][column]) / float(row[column]) - 1.0)
            for (scene, case, method), row in by.items()
            if method == "finite differences"
        ]
        # rows have four digits
        shown[f"differences_{column.removesuffix('_V')}"] = f"{max(*apart, 1e-4):.2%}"
    central = {scene: by[scene, "fringe", wanted] for scene, _, _ in by}
    for case in dict.fromkeys(row["case"] for row in table if row["case"] not in CAUSES):
        moved = [
            float(row["release_V"]) - float(central[s]["release_V"])
            for (s, c, _), row in by.items()
            if c == case
        ]
        shown[case.replace(" ", "_").replace("+", "more").replace("-", "less")] = (
            f"{min(moved):+.2f} to {max(moved):+.2f} V"
        )
    return shown
