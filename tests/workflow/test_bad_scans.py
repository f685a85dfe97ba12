"""Scans that cannot be used are refused in one line each, and what is finished stays."""

import os

import numpy as np
import pytest

from evidence.attacks.runs import TRACE
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.loading import write_gwy
from workflow.run import ownership

PER_JOB = 6  # scans that one job analyses
MATERIAL = """
inputs:
  e_star: {origin: literature, distribution: normal, values: [91, 3.8], source: test}
  h_prime: {origin: literature, values: [2, 15], source: test}
"""


def scene(folder, *scans, **topography):
    """A scene whose roughness comes from these scans."""
    path = folder / "mine.yaml"
    keys = {"scans": f"[{', '.join(scans)}]", **topography}
    path.write_text(
        "topography: {"
        + ", ".join(f"{key}: {value}" for key, value in keys.items())
        + "}"
        + MATERIAL
    )
    return str(path)


def errors(done):
    assert not TRACE.search(done.stderr)
    return sorted(
        {line for line in (done.stdout + done.stderr).splitlines() if line.startswith("ERROR")}
    )


def rough(seed=0, pixels=64):
    """Heights with a plateau and a power law."""
    k = np.hypot(*np.meshgrid(np.fft.fftfreq(pixels), np.fft.fftfreq(pixels)))
    noise = np.fft.fft2(np.random.default_rng(seed).standard_normal((pixels, pixels)))
    return np.fft.ifft2(noise * np.maximum(k, 0.05) ** -1.5).real


@pytest.fixture(scope="module")
def refused(make_workflow, tmp_path_factory):
    """One run over good scans and two bad ones, each of these in a job of its own."""
    folder = tmp_path_factory.mktemp("bad_scans")
    fillers = [folder / f"good_{k}.gwy" for k in range(PER_JOB)]
    for path in fillers:
        write_gwy(path, Scan(rough(), (1000.0, 1000.0), "good"))
    good = fillers[0]
    (folder / "unreadable.gwy").write_bytes(good.read_bytes()[:3000])
    np.savetxt(folder / "sizeless.txt", rough())
    names = [path.name for path in fillers]
    for bad in ("unreadable.gwy", "sizeless.txt"):
        names += [bad, *(f"{bad}_{k}.gwy" for k in range(1, PER_JOB))]
        for name in names[1 - PER_JOB :]:
            (folder / name).write_bytes(good.read_bytes())
    workflow = make_workflow(folder)
    done = workflow.run(scene(folder, *names), "topography", options=("--keep-going",))
    return done, folder


def test_each_bad_scan_gets_one_line(refused):
    done, _ = refused
    assert done.returncode != 0
    unreadable, sizeless = errors(done)
    assert "sizeless.txt: has no physical size and no length unit" in sizeless
    assert "unreadable.gwy: no reader understands this file" in unreadable


def test_a_mended_scan_is_read_and_finished_ones_are_not_read_again(refused, make_workflow):
    _, folder = refused
    finished, mended = (
        f"results/mine/topography/spectra/chunk_{number:03d}.h5" for number in (0, 1)
    )
    before = (folder / finished).stat().st_mtime_ns
    write_gwy(folder / "unreadable.gwy", Scan(rough(1), (1000.0, 1000.0), "mended"))
    done = make_workflow(folder).run(str(folder / "mine.yaml"), finished, mended)
    assert done.returncode == 0, done.stderr
    assert (folder / finished).stat().st_mtime_ns == before
    assert (folder / mended).is_file()


def test_a_missing_scan_is_named_before_anything_runs(workflow_in):
    done = workflow_in.run(scene(workflow_in.folder, "nothing.gwy", "nowhere.ibw"), "topography")
    assert done.returncode != 0
    nothing, nowhere = errors(done)
    assert "nothing.gwy: no such file" in nothing
    assert "nowhere.ibw: no such file" in nowhere
    assert not list(workflow_in.folder.glob("results/*/topography/**/*.h5"))


def test_a_constant_scan_stops_where_its_numbers_would_be_used(workflow_in):
    write_gwy(workflow_in.folder / "flat.gwy", Scan(np.zeros((64, 64)), (1000.0, 1000.0), "flat"))
    done = workflow_in.run(scene(workflow_in.folder, "flat.gwy"), "results/mine/inputs.csv")
    assert done.returncode != 0
    (line,) = errors(done)
    assert "not identifiable" in line
    assert (workflow_in.folder / "results/mine/topography/parameters.json").is_file()


def test_a_failing_run_whose_reader_went_away_ends(workflow_in):
    """As where the pager that it writes to is closed: it must not wait for ever and keep the next
    run out.
    """
    (workflow_in.folder / "bad.gwy").write_bytes(b"nothing")
    run = workflow_in.start(scene(workflow_in.folder, "bad.gwy"), "topography")
    assert run.stderr is not None
    for line in run.stderr:
        if "jobs, about" in line:
            break
    run.stderr.close()
    assert run.wait(300) != 0
    os.close(ownership.take(workflow_in.folder / "results/mine"))  # the next run is not kept out
