"""Time the analysis of one scan, and of eleven on two cores with the fit: reading and imports included.

python -m benchmarks.scans      (docs/topography.md, Run time)
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before any library starts its threads

import subprocess
import sys
import tempfile
import time
from pathlib import Path

from mesoscale.settings import SyntheticScanSettings
from mesoscale.topography.measurements.loading import write_gwy
from mesoscale.topography.synthetic_scans import synthetic_scans

SPECTRA = """
import sys
from mesoscale.settings import TopographySettings
from mesoscale.topography.analysis import trusted_scan
from mesoscale.topography.measurements.loading import load_scan
settings = TopographySettings()
spectra = [trusted_scan(load_scan(path), settings) for path in sys.argv[2:]]
if sys.argv[1] == "fit":
    from mesoscale.topography.description.parameters import analyse
    assert analyse(spectra, settings).estimates
"""


def started(task: str, scans: list[Path]) -> subprocess.Popen[bytes]:
    """A fresh Python that reads the scans and computes their spectra (and fits them, for task `fit`)."""
    return subprocess.Popen([sys.executable, "-c", SPECTRA, task, *map(str, scans)])


def seconds(jobs: list[tuple[str, list[Path]]]) -> float:
    """Wall time of fresh Pythons side by side."""
    start = time.perf_counter()
    for process in [started(*job) for job in jobs]:
        if process.wait() != 0:
            raise SystemExit("the analysis failed")
    return time.perf_counter() - start


def main() -> None:
    """Print the table."""
    with tempfile.TemporaryDirectory() as folder:
        scans = []
        for item in synthetic_scans(SyntheticScanSettings()):
            scans.append(Path(folder) / f"{item.scan.name}.gwy")
            write_gwy(scans[-1], item.scan)
        seconds([("spectra", scans[:1])])  # compiled files and caches as on any but the first run
        print("scans of 1024 x 1024                       wall_s")
        print(f"one, spectra                               {seconds([('spectra', scans[:1])]):6.1f}")
        print(f"one, spectra and fit                       {seconds([('fit', scans[:1])]):6.1f}")
        halves = [("spectra", scans[:6]), ("spectra", scans[6:])]
        print(f"eleven in two processes, spectra           {seconds(halves):6.1f}")
        print(f"eleven in one process, spectra and fit     {seconds([('fit', scans)]):6.1f}")


if __name__ == "__main__":
    main()
