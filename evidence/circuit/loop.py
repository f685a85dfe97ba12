"""Does a slow loop of the lumped switch pull in and let go as finite elements do, in balance and in
ngspice?

`fe`: 1,024 elements. `lumps`: so many pairs in balance. `ngspice`: `slow_switch` of the exported
netlist, with the fewest pairs whose release is within 1 %, and with as many as the export has; the
voltage rises for 3 s and falls for 11 s. All go up to the same voltage, since the pad remembers it.
`ended_s`: where ngspice stopped; a release before 14 s is none. Folders hold results of target
`answer`, with their cells at central inputs. Attraction is that of the scene times the column.
"""

import subprocess
import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from time import process_time
from typing import Any

import numpy as np

from evidence.scenes import finished
from mesoscale.circuit.lumps import LumpErrors, Lumps, choose_lumps, lumps_of
from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.circuit.spice import spice_switch
from mesoscale.pad.curves import PadCurves, attracting, on_deep_enough
from mesoscale.settings import DeviceSettings
from mesoscale.switch.beam import beam_of, lumped_beam
from mesoscale.switch.beam_switch import BeamStates, BeamSwitch

PAIRS = (4, 8, 12, 16, 20, 24, 28, 32, 40, 48)
ELEMENTS = 1024
STEP_S = 1e-3
"""Of ngspice, at most."""
SAME = ("scene", "attraction")
OVER, TIMES_S, SHARES = 1.02, (0.0, 1.0, 3.0, 6.0, 14.0), (0.0, 0.93, 1.0, 0.5, 0.0)
"""The largest voltage over that of the pull-in, and shares of it in time."""
NGSPICE = f"""* a slow loop
.include switch.sub
Vdrive drive 0 PWL({{voltages}})
X1 drive 0 middle slow_switch
.options method=gear maxord=1 itl4=100 reltol=1e-5 abstol=1e-3 vntol=1e-3
.tran {STEP_S} {TIMES_S[-1]} 0 {STEP_S}
.control
set wr_singlescale
set numdgt=12
run
wrdata out.txt v(drive) v(middle) v(x1.charge)
quit
.endc
.end
"""


def arguments(parser: ArgumentParser) -> None:
    """Results to take pads from."""
    parser.add_argument("results", nargs="+", type=Path)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each scene, attraction and model."""
    for folder in given.results:
        device, scene_pad = central_pad(folder)
        for times in (1.0, 0.0):
            same = {"scene": folder.name, "attraction": times}
            pad = attracting(scene_pad, times)
            beam = beam_of(device, ELEMENTS)
            once, _ = on_deep_enough(pad, BeamSwitch(device, beam).states_on)
            top_V = OVER * once.pull_in_V
            held = device.model_copy(update={"hold_voltage_V": top_V})
            started = process_time()
            exact, pad = on_deep_enough(pad, BeamSwitch(held, beam).states_on)
            yield same | _of("fe", ELEMENTS, exact, started)
            enough = 0
            for pairs in PAIRS:
                started = process_time()
                states = BeamSwitch(held, lumped_beam(held, pairs)).states_on(pad)
                yield same | _of("lumps", pairs, states, started)
                if (
                    not enough
                    and abs(states.release_V / exact.release_V - 1.0) <= CIRCUIT.release_error
                ):
                    enough = pairs
            if times:
                for pairs in sorted({enough, choose_lumps(device, pad).lumps}):
                    loop = _by_ngspice(lumps_of(device, pairs), pad, top_V)
                    yield same | {"by": "ngspice", "pairs": pairs} | loop


def central_pad(results: Path) -> tuple[DeviceSettings, PadCurves]:
    """The switch of a scene, and its pad at central inputs."""
    points, model = finished(results)
    return points.device, model.central.pressed.curves


def _of(by: str, pairs: int, states: BeamStates, started: float) -> dict[str, Any]:
    volts = {
        "pull_in_V": states.pull_in_V,
        "release_V": states.release_V,
        "held_fF": states.capacitance_fF,
    }
    return {
        "by": by,
        "pairs": pairs,
        **volts,
        "cpu_s": process_time() - started,
        "ended_s": TIMES_S[-1],
    }


def _loop(time_s: Any, volts: Any, middle_nm: Any, held_fF: float, cpu_s: float) -> dict[str, Any]:
    """Voltages at which mid-span leaves and comes back to half its separation at rest; `held_fF` at
    the top.
    """
    top, half = int(np.argmax(volts)), 0.5 * middle_nm[0]
    closed, opened = middle_nm[:top] < half, middle_nm[top:] > half
    return {
        "pull_in_V": float(volts[:top][closed.argmax()]) if closed.any() else 0.0,
        "release_V": float(volts[top:][opened.argmax()]) if opened.any() else 0.0,
        "held_fF": held_fF,
        "cpu_s": cpu_s,
        "ended_s": float(time_s[-1]),
    }


def _by_ngspice(lumps: Lumps, pad: PadCurves, top: float) -> dict[str, Any]:
    started = getrusage(RUSAGE_CHILDREN).ru_utime
    voltages = " ".join(
        f"{at} {share * top:.9g}" for at, share in zip(TIMES_S, SHARES, strict=True)
    )
    with tempfile.TemporaryDirectory() as folder:
        netlist = spice_switch(lumps, LumpErrors(lumps.count, *[0.0] * 6), pad, 1, top / OVER)
        (Path(folder) / "switch.sub").write_text(netlist, encoding="utf-8")
        (Path(folder) / "loop.cir").write_text(NGSPICE.format(voltages=voltages), encoding="utf-8")
        subprocess.run(["ngspice", "-b", "loop.cir"], cwd=folder, check=True, capture_output=True)
        time_s, volts, moved, charge = np.loadtxt(Path(folder) / "out.txt").T
    top_at = int(np.argmax(volts))
    cpu_s = getrusage(RUSAGE_CHILDREN).ru_utime - started
    return _loop(
        time_s, volts, lumps.rest_nm[-1] - moved, float(charge[top_at] / volts[top_at]), cpu_s
    )


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Largest errors of lumps in balance, and of the loops in motion."""

    def error(row: Mapping[str, str], column: str) -> float:
        (other,) = (
            one for one in rows if one["by"] == "fe" and all(one[key] == row[key] for key in SAME)
        )
        return abs(float(row[column]) / float(other[column]) - 1.0)

    def ended(row: Mapping[str, str]) -> bool:
        return float(row["ended_s"]) >= TIMES_S[-1]

    def largest(by: str, column: str, pairs: str = "") -> str:
        kept = [
            row for row in rows if row["by"] == by and pairs in ("", row["pairs"]) and ended(row)
        ]
        return f"{max(error(row, column) for row in kept):.1%}"

    spice = [row for row in rows if row["by"] == "ngspice" and ended(row)]
    return {
        **{f"release_{pairs}": largest("lumps", "release_V", str(pairs)) for pairs in PAIRS},
        **{f"held_{pairs}": largest("lumps", "held_fF", str(pairs)) for pairs in PAIRS},
        "pull_in": largest("lumps", "pull_in_V", "20"),
        "spice_pull_in": largest("ngspice", "pull_in_V"),
        "spice_release": largest("ngspice", "release_V"),
        "pairs": ", ".join(f"{row['pairs']} on `{row['scene']}`" for row in spice),
        "cpu_s": f"{max(float(row['cpu_s']) for row in spice):.0f}",
    }
