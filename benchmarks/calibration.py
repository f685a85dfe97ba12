"""Time of a posterior from twenty force curves: from the first contact cycle to samples of the inputs.

python -m benchmarks.calibration

The curves are those of scene `made_up` (docs/calibration.md), the settings its own; one core.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before any library starts its threads

import time
from pathlib import Path

from mesoscale.calibration.measurements import load_measurements
from mesoscale.calibration.posterior import FIRST_SEED, calibrate, cycles_of_rows, observe_runs
from mesoscale.calibration.studies.made_up import CONTACT
from mesoscale.inputs.table import input_table
from mesoscale.settings import (
    DeviceSettings,
    LawSettings,
    MeasurementsSettings,
    MeasurementTable,
    UncertaintySettings,
)
from mesoscale.uncertainty.designs import random_runs

CURVES = Path(__file__).parents[1] / "config/measurements/made_up/closing_curves.csv"


def main() -> None:
    """Print wall and processor time of the cycles and of all that follows."""
    table, law, settings = input_table(), LawSettings(), MeasurementsSettings()
    data = load_measurements(MeasurementTable(kind="closing_curves", file=str(CURVES)))
    first = random_runs(table, UncertaintySettings(), 0, 1, first_surface=FIRST_SEED)
    observe_runs(first, CONTACT, law)  # compiles
    clocks = [(time.perf_counter(), time.process_time())]
    runs = random_runs(table, UncertaintySettings(), 0, settings.runs, first_surface=FIRST_SEED)
    cycles = cycles_of_rows(observe_runs(runs, CONTACT, law), table.names)
    clocks.append((time.perf_counter(), time.process_time()))
    result = calibrate(table, [data], cycles, CONTACT, law, DeviceSettings(), settings)
    clocks.append((time.perf_counter(), time.process_time()))
    for name, start, end in (
        (f"{settings.runs} cycles over the prior", clocks[0], clocks[1]),
        (f"{result.cycles - settings.runs} cycles where the posterior lies, and chains", clocks[1], clocks[2]),
        ("in all", clocks[0], clocks[2]),
    ):
        print(f"{name}: {end[0] - start[0]:.0f} s, processor {end[1] - start[1]:.0f} s")
    rms = result.x[:, table.names.index("rms")]
    said = "converged" if result.chain.converged else result.chain.reason
    print(f"{said}, {result.chain.effective:.0f} independent draws; RMS {rms.mean():.2f} +- {rms.std():.2f} nm")


if __name__ == "__main__":
    main()
