"""More direct runs add files and leave those that are there as they are; memory does not grow with
them.
"""

import tracemalloc

import pytest

from mesoscale.inputs.table import collect
from mesoscale.settings import ContactSettings
from mesoscale.uncertainty.designs import random_runs
from mesoscale.uncertainty.runs import compute_rows
from workflow.scene import load_scene

SCENE = """
inputs:
  e_star: {{origin: literature, distribution: normal, values: [91, 3.8]}}
  h_prime: {{origin: literature, values: [1.95, 14.8]}}
  q0: {{origin: literature, values: [0.015, 0.035]}}
  hurst: {{origin: literature, values: [0.5, 1.0]}}
  rms: {{origin: literature, values: [2, 15]}}
contact: {{pixels: 64}}
uncertainty: {{direct_runs: {runs}}}
"""


def test_more_runs_reuse_the_old_files(workflow_in):
    path = workflow_in.folder / "grown.yaml"
    path.write_text(SCENE.format(runs=220))
    made = {f"chunk_{name}.csv" for name in ("000", "001", "again")}
    done = workflow_in.run(
        str(path), *(f"results/grown/uncertainty/direct/{name}" for name in sorted(made))
    )
    assert done.returncode == 0, done.stderr
    folder = workflow_in.folder / "results/grown/uncertainty/direct"
    old = {file.name: file.read_bytes() for file in folder.iterdir()}
    assert made <= set(old)

    path.write_text(SCENE.format(runs=620))
    assert workflow_in.planned(str(path), "uncertainty")["compute_direct_runs"] == 2
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == old


@pytest.fixture(scope="module")
def peak_of():
    table = collect(load_scene("paper").inputs, {}, {})

    def measure(count: int) -> int:
        runs = random_runs(table, 0, count)
        tracemalloc.start()
        try:
            for _ in compute_rows(runs, ContactSettings(mechanics="asperity", pixels=64)):
                pass
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    measure(2)  # loads the engine
    return measure


def test_memory_of_a_chunk_does_not_grow_with_its_runs(peak_of):
    # a surface of 64 x 64 is 32 kB; forty cycles kept would be some MB
    assert peak_of(40) < 1.2 * peak_of(4) + 1e5
