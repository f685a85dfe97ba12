"""More direct runs add files and leave those that are there as they are; memory does not grow with them."""

import tracemalloc

import pytest

from mesoscale.inputs.table import collect
from mesoscale.settings import ContactSettings, LawSettings, UncertaintySettings
from mesoscale.uncertainty.designs import random_runs
from mesoscale.uncertainty.runs import compute_rows
from workflow.scene import load_scene

SCENE = """
inputs:
  e_star: {{origin: literature, distribution: normal, a: 91, b: 3.8}}
  h_prime: {{origin: literature, a: 1.95, b: 14.8}}
  q0: {{origin: literature, a: 0.015, b: 0.035}}
  hurst: {{origin: literature, a: 0.5, b: 1.0}}
  rms: {{origin: literature, a: 2, b: 15}}
contact: {{pixels: 64}}
uncertainty: {{study_runs: {runs}, chunk_runs: 50}}
"""


def test_more_runs_reuse_the_old_files(workflow_in):
    path = workflow_in.folder / "grown.yaml"
    path.write_text(SCENE.format(runs=120))
    done = workflow_in.run(str(path), "brute_force")
    assert done.returncode == 0, done.stderr
    folder = workflow_in.folder / "results/grown/uq/direct"
    old = {file.name: file.read_bytes() for file in folder.iterdir()}
    assert {f"chunk_{k:03d}.csv" for k in range(3)} <= set(old)

    path.write_text(SCENE.format(runs=220))
    assert workflow_in.planned(str(path), "brute_force")["compute_direct_runs"] == 2
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == old


@pytest.fixture(scope="module")
def peak_of():
    table = collect(load_scene("paper").inputs, {}, {}, 0.999)

    def measure(count: int) -> int:
        runs = random_runs(table, UncertaintySettings(), 0, count)
        tracemalloc.start()
        try:
            for _ in compute_rows(runs, ContactSettings(pixels=64), LawSettings()):
                pass
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    measure(2)  # loads the engine
    return measure


def test_memory_of_a_chunk_does_not_grow_with_its_runs(peak_of):
    # a surface of 64 x 64 is 32 kB; forty cycles kept would be some MB
    assert peak_of(40) < 1.2 * peak_of(4) + 1e5
