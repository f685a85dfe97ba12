"""Scene `ci`, real codes from melt to report: complete, reproducible, resumable.

One run is left alone; a second is killed with SIGKILL once in each stage and resumed. Both must end
with the same results. The second run takes over the melts and closings of the hardness stage, which
`test_ownership` and `test_closing` kill, and the quenched cell of the first run. It has no points,
whose pads are as the central one.
"""

import json
import shutil
import zipfile
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray

from workflow.files.results import is_length_alone, load_csv
from workflow.run.job import result_checksum

# one job of each stage; its log is opened when it starts, so killing at its first sight interrupts
# that very job
STAGES = {
    "elastic": "scan_glass",
    "topography": "analyse_scans",
    "inputs": "inputs",
    "pad": "press_pads",
    "contact": "contact",
    "law": "compute_runs",
    "uncertainty": "uncertainty",
    "answer": "answer",
    "report": "report",
}
RESULTS = (
    "scene.yaml",
    "hardness/points.csv",
    "hardness/fit.json",
    "elastic/points.csv",
    "elastic/bulk_moduli.csv",
    "elastic/e_star.json",
    "elastic/e_star.h5",
    "topography/spectra.h5",
    "topography/parameters.json",
    "inputs.csv",
    "contact/nominal.h5",
    "pad/curves.csv",
    "law/parameters.csv",
    "uncertainty/outputs.csv",
    "uncertainty/sensitivity.csv",
    "uncertainty/surrogate.json",
    "uncertainty/validation.csv",
    "report.html",
)


OF_POINTS = ("pad/model.h5", "answer/pad_switch.json")
"""What the points make, which the second run has not."""


@pytest.fixture(scope="module")
def finished(make_workflow, tmp_path_factory):
    """Scene `ci`, run once without interruption."""
    workflow = make_workflow(tmp_path_factory.mktemp("finished"))
    done = workflow.run("ci")
    assert done.returncode == 0, done.stdout + done.stderr
    last = done.stdout.rpartition("\n\n")[2]  # the answer, after what the scans said
    assert last.startswith(("The switch ", "Whether the switch "))
    assert last.endswith("\nresults are in results/ci; the report is results/ci/report.html\n")
    return workflow


def test_every_hdf5_result_opens_in_xarray(finished):
    """Pads did not: some of their dimensions had a scale, others none."""
    files = [path for path in (finished.folder / "results/ci").rglob("*.h5")]
    assert len(files) >= 8
    for path in files:
        with h5py.File(path) as file:
            groups = {item.parent.name for item in datasets(file).values()}
        for group in groups:
            xarray.open_dataset(path, group=group, engine="h5netcdf").close()


def datasets(file: h5py.File) -> dict[str, h5py.Dataset]:
    """Every dataset of a file by its path in it."""
    found = {}

    def visit(name, item):
        if isinstance(item, h5py.Dataset) and not is_length_alone(item):
            found[name] = item

    file.visititems(visit)
    return found


def content(path: Path):
    """What a result file says, without the machine times and the names of the files that it was
    made of.
    """
    if path.suffix == ".h5":
        with h5py.File(path) as file:
            return {name: item[()].tobytes() for name, item in datasets(file).items()}
    if path.suffix == ".json":
        named_alike = json.loads(
            path.read_text(encoding="utf-8").replace("results/killed/", "results/ci/")
        )
        return {key: value for key, value in named_alike.items() if key != "provenance"}
    return result_checksum(path)


def take_over(finished, results: Path, *folders: str) -> None:
    """Copy what stages of scene `ci` have made into the results of another scene."""
    for folder in folders:
        shutil.copytree(finished.folder / "results/ci" / folder, results / folder)
    (results / ".scene").touch()  # as of a scene that has moved


def test_every_promised_result_is_there(finished):
    missing = [
        name
        for name in (*RESULTS, *OF_POINTS)
        if not (finished.folder / "results/ci" / name).is_file()
    ]
    assert not missing


def test_every_part_of_the_page_is_drawn(finished):
    assert "could not be drawn" not in (finished.folder / "results/ci/report.html").read_text(
        encoding="utf-8"
    )


def test_the_pad_has_an_answer(finished):
    state = json.loads(
        (finished.folder / "results/ci/answer/pad_switch.json").read_text(encoding="utf-8")
    )
    assert state["answer_status"] == "ok"


def test_every_h5_file_is_complete_and_has_units(finished):
    for path in (finished.folder / "results/ci").rglob("*.h5"):
        with h5py.File(path) as file:
            assert file.attrs["complete"], path
            unlabelled = [
                name for name, item in datasets(file).items() if "units" not in item.attrs
            ]
            assert not unlabelled, path


def test_snakemake_reports_page_figures_and_tables_with_captions(finished):
    """Snakemake's own report; a missing caption or a page without figures would end it."""
    done = finished.run("ci", options=("--report", "ci.zip"))
    assert done.returncode == 0, done.stdout + done.stderr
    with zipfile.ZipFile(finished.folder / "ci.zip") as archive:
        names = {Path(name).name for name in archive.namelist()}
        text = archive.read("ci/report.html").decode()
    tables = {"inputs.csv", "points.csv", "bulk_moduli.csv", "parameters.csv", "budget.csv"}
    assert tables | {"report.html"} <= names
    drawn = {path.name for path in (finished.folder / "results/ci/figures").glob("*.svg")}
    assert len(drawn) > 8
    assert drawn <= names
    for words in ("Table 1 of the paper for this scene", "Figure budget-bars of the report page"):
        assert words in text


def test_a_second_run_has_nothing_to_do(finished):
    assert finished.planned("ci") == {}


def test_a_deleted_stage_is_made_again_with_what_depends_on_it(finished):
    path = finished.folder / "results/ci/law/parameters.csv"
    kept = path.with_suffix(".kept")
    path.rename(kept)
    planned = set(finished.planned("ci"))
    kept.rename(path)
    assert planned >= {"law", "uncertainty", "report"}
    assert not {"compute_runs", "run_closing", "scan_glass", "analyse_scans"} & planned


def test_a_run_killed_in_every_stage_ends_with_the_same_results(finished, make_workflow, tmp_path):
    workflow = make_workflow(tmp_path)
    scene = tmp_path / "killed.yaml"
    scene.write_text("extends: ci\nname: killed\npad: {points: 0}\n")
    take_over(finished, tmp_path / "results/killed", "hardness", "elastic/quenched")
    logs = tmp_path / "results/killed/logs"
    for job in STAGES.values():
        # a run killed in another stage may have come this far
        if not list(logs.glob(f"{job}*.log")):
            assert workflow.kill_when(
                str(scene), lambda job=job: bool(list(logs.glob(f"{job}*.log")))
            ), job
    done = workflow.run(str(scene))
    assert done.returncode == 0, done.stdout + done.stderr
    for name in RESULTS:
        if name in ("scene.yaml", "report.html") or name.startswith("hardness/"):
            continue
        first, second = (
            content(finished.folder / "results/ci" / name),
            content(tmp_path / "results/killed" / name),
        )
        np.testing.assert_equal(second, first, err_msg=name)


def test_another_glass_moves_what_meets_the_contact(finished, make_workflow, tmp_path):
    """Silicon nitride of another seed has another E*; hardness and roughness, which are taken over,
    stay.
    """
    workflow = make_workflow(tmp_path)
    scene = tmp_path / "other.yaml"
    scene.write_text("extends: ci\nname: other\nelastic: {seed: 4}\n")
    take_over(finished, tmp_path / "results/other", "hardness", "topography")
    done = workflow.run(str(scene), "inputs")
    assert done.returncode == 0, done.stdout + done.stderr
    before, after = (
        {row["parameter"]: row for row in load_csv(path)} for path in inputs_of(finished, tmp_path)
    )
    moved = {name for name in before if before[name]["a"] != after[name]["a"]}
    assert moved == {"e_star"}
    assert before["e_star"]["origin"] == "elastic"


def inputs_of(finished, folder: Path) -> tuple[str, str]:
    """Tables of the inputs of scene `ci` and of the other one."""
    return str(finished.folder / "results/ci/inputs.csv"), str(folder / "results/other/inputs.csv")
