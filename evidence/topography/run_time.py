"""How long does the analysis of scans take, reading and imports included?

Fresh Pythons of one thread each read scans of 1024 x 1024 pixels from Gwyddion files.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from mesoscale.topography.measurements.loading import write_gwy
from mesoscale.topography.synthetic_scans import ScanSet, synthetic_scans

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


def rows(_given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Wall times."""
    with tempfile.TemporaryDirectory() as folder:
        scans = []
        for item in synthetic_scans(ScanSet()):
            scans.append(Path(folder) / f"{item.scan.name}.gwy")
            write_gwy(scans[-1], item.scan)
        seconds([("spectra", scans[:1])])  # compiled files and caches as on any but the first run
        yield {"scans": 1, "processes": 1, "fit": False, "wall_s": seconds([("spectra", scans[:1])])}
        halves = [("spectra", scans[:6]), ("spectra", scans[6:])]
        yield {"scans": len(scans), "processes": 2, "fit": False, "wall_s": seconds(halves)}
        yield {"scans": len(scans), "processes": 1, "fit": True, "wall_s": seconds([("fit", scans)])}


def seconds(jobs: list[tuple[str, list[Path]]]) -> float:
    """Wall time of fresh Pythons side by side."""
    start = time.perf_counter()
    for process in [subprocess.Popen([sys.executable, "-c", SPECTRA, task, *map(str, scans)]) for task, scans in jobs]:
        if process.wait() != 0:
            raise SystemExit("the analysis failed")
    return time.perf_counter() - start


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Seconds of the last run."""
    one, halves, fit = (f"{float(row['wall_s']):.0f} s" for row in rows[-3:])
    return {"one": one, "eleven_in_two": halves, "eleven_with_fit": fit}
