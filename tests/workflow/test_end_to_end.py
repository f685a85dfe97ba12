"""Scene `ci`, real codes from melt to report: complete, reproducible, resumable.

One run is left alone; a second is killed with SIGKILL once in each stage and resumed. Both must end with the
same results.
"""

import csv
import json
import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from workflow.results import read_csv, read_json

# a job's log is opened when it starts: killing at its first sight interrupts that very job
STAGES = (
    "make_glass",
    "run_closing",
    "scan_volumes",
    "write_scans",
    "analyse_scans",
    "collect_inputs",
    "compute_nominal",
    "compute_runs",
    "fit_law",
    "propagate_uncertainty",
    "solve_switch",
    "render_report",
)
MEASURED = re.compile(r"wall_s|cpu_s|peak_rss|_seconds|wall")  # machine time is no result


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    from conftest import Workflow

    workflow = Workflow(tmp_path_factory.mktemp("uninterrupted"))
    done = workflow.run("ci")
    assert done.returncode == 0, done.stdout + done.stderr
    return workflow


def results(workflow) -> Path:
    return workflow.folder / "results/ci"


def content(path: Path):
    """A result file without the machine times in it."""
    if path.suffix == ".csv":
        with path.open(newline="") as stream:
            rows = list(csv.DictReader(stream))
        return [{key: value for key, value in row.items() if not MEASURED.search(key)} for row in rows]
    if path.suffix == ".json":

        def strip(value):
            if isinstance(value, dict):
                return {key: strip(item) for key, item in value.items() if not MEASURED.search(key)}
            return [strip(item) for item in value] if isinstance(value, list) else value

        return strip(json.loads(path.read_text()))
    return path.read_bytes()
