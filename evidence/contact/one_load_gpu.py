"""How much faster is one load of `asp.press` on a GPU, and is it the same contact?

The maps of `contact.one_load`, pressed with the solver of `asp.press` by NumPy on one core and by
CuPy or PyTorch on a GPU (`pip install 'asperity-contact[gpu]'`), alternating. Seconds are those of
the clock: the way of the map to the device and of the answer back is in them, and so are the tables
of the half-space, which the processor makes. `first_s` is the first time on a grid, in which a
library plans its transforms; `s` is the median of the later ones. `sites` counts the sites that
touch by one device alone, and `difference` is that of the pressures over the largest one.
"""

import argparse
import subprocess
import time
from collections.abc import Iterator
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from evidence.contact.one_load import Case, case_of
from mesoscale.contact.coupled import one_load
from mesoscale.contact.coupled.devices import Device, fetched, placed

DEVICES: tuple[Device, ...] = ("cpu", "cuda")
SMALL = 64  # sites a side of a map that has all compiled


class Run(NamedTuple):
    """A load: seconds, answer with NumPy's arrays, library of the solver."""

    seconds: float
    pressed: one_load.Pressed
    library: str


def arguments(parser: argparse.ArgumentParser) -> None:
    """What is timed."""
    parser.add_argument("--pixels", type=int, nargs="+", default=[512, 1024, 2048, 4096, 8192])
    parser.add_argument("--shares", type=float, nargs="+", default=[0.01, 0.2])
    parser.add_argument("--maps", nargs="+", default=["smooth", "rough", "smooth alone"])
    parser.add_argument("--repeats", type=int, default=4)
    parser.add_argument("--largest-cpu", type=int, default=4096)


def rows(options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each map, load and device."""
    for device in DEVICES:
        _run(case_of("smooth", SMALL, 0.05), device)
    gpu = _name_of_gpu()
    for pixels in options.pixels:
        devices = DEVICES if pixels <= options.largest_cpu else ("cuda",)
        for what in options.maps:
            for share in options.shares:
                case = case_of(what, pixels, share)
                yield from _compared(case, devices, options.repeats, gpu)


def _compared(
    case: Case, devices: tuple[Device, ...], repeats: int, gpu: str
) -> Iterator[dict[str, Any]]:
    """Rows of one load by the devices; the last repeat of each is compared with NumPy's."""
    runs: dict[Device, list[Run]] = {device: [] for device in devices}
    for _ in range(repeats):
        for device in devices:
            runs[device].append(_run(case, device))
    known = runs["cpu"][-1].pressed.pressure if "cpu" in runs else None
    for device, repeated in runs.items():
        last = repeated[-1]
        pressure = last.pressed.pressure
        seconds = [run.seconds for run in repeated]
        row = {
            "pixels": case.settings.pixels,
            "what": case.what,
            "share": float((pressure > 0.0).mean()),
            "device": device,
            "library": last.library,
            "gpu": gpu,
            "first_s": seconds[0],
            "s": median(seconds[1:] or seconds),
            "transforms": last.pressed.transforms,
            "settled": last.pressed.settled,
            "sites": np.nan,
            "difference": np.nan,
        }
        if known is not None:
            row["sites"] = int(((pressure > 0.0) != (known > 0.0)).sum())
            row["difference"] = float(np.abs(pressure - known).max() / known.max())
        yield row


def _run(case: Case, device: Device) -> Run:
    """One load on a device, timed from map to answer."""
    start = time.perf_counter()
    base = case.base()
    sides = 1 if base.repeats else 2
    heights = placed(case.heights, device, sides**2 * case.heights.size)
    pressed = one_load.press(heights, case.load_nN, base)
    library = type(pressed.pressure).__module__.partition(".")[0]
    pressed = pressed._replace(pressure=fetched(pressed.pressure), gap=fetched(pressed.gap))
    return Run(time.perf_counter() - start, pressed, library)


def _name_of_gpu() -> str:
    """As its driver gives it."""
    command = ["nvidia-smi", "--query-gpu=name", "--format=csv,noheader"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
