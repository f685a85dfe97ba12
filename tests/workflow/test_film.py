"""From measured files to a scene, and the Python object beside that scene: the same numbers, digit
for digit.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import yaml

import asperity as asp
from asperity.__main__ import main
from asperity.door import KNOWN_IF_STATED
from asperity.words import SCALAR_KEYS
from mesoscale.topography.measurements.loading import load_measurements, write_gwy
from mesoscale.topography.measurements.opening import write_channels
from workflow.scene import load_scene

ROOT = Path(__file__).resolve().parents[2]
AFM = ROOT.parent / "shared" / "afm"


@pytest.fixture(scope="module")
def scans(tmp_path_factory):
    """Two places of a film whose heights are skewed, and a file that is no scan."""
    folder = tmp_path_factory.mktemp("film") / "scans"
    folder.mkdir()
    settings = asp.ContactSettings(mechanics="asperity", pixels=256, length_nm=2500.0)
    inputs = asp.ContactInputs(0.215, 91.0, 1.95, 8.375, q0=0.025, hurst=0.7, rms=5.0)
    for seed in (1, 2):
        heights = 5.0 * np.exp(asp.random_surface(inputs, settings, seed) / 10.0)
        write_gwy(folder / f"place_{seed}.gwy", asp.Scan(heights, (2500.0, 2500.0), "place"))
    (folder / "notes.txt").write_text("made up")
    return folder


@pytest.fixture
def started(monkeypatch):
    """What the command would start in its place."""
    given = []
    monkeypatch.setattr("os.execv", lambda program, arguments: given.append(arguments))
    return given


def test_a_folder_becomes_a_scene_and_a_run(scans, started, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    words = ["--tip-nm", "8", "--material", "e_star=75+-4", "h_macro=1:1.6", "--device", "gap_um=2"]
    main([str(scans), *words])
    said = capsys.readouterr().out
    assert "left out: " in said
    assert "notes.txt" in said
    assert all(len(line) <= 80 for line in said.splitlines() if str(tmp_path.parent) not in line)
    assert "scans.yaml is the scene of this film" in said
    assert "defaults" not in said
    assert "scene=scans.yaml" in started[0]
    scene = load_scene("scans.yaml")
    assert (scene.contact.mechanics, scene.topography.tip_radius_nm, scene.device.gap_um) == (
        "coupled",
        8.0,
        2.0,
    )
    rows = scene.inputs.rows()
    assert (rows["e_star"].distribution, rows["e_star"].values) == ("normal", (75.0, 4.0))
    assert (rows["h_macro"].distribution, rows["h_macro"].values) == ("uniform", (1.0, 1.6))
    assert {name for name, row in rows.items() if row.origin == "topography"} == {
        "q0",
        "hurst",
        "rms",
        "q1",
    }
    main([str(scans), *words])  # the same scene again: it goes on
    assert len(started) == 2
    assert main([str(scans), "--device", "gap_um=3"]) == 1  # another scene would overwrite this one


def test_options_on_a_file_reach_its_scene(scans, started, tmp_path, monkeypatch):
    """A map of nm without size and unit; the scene has all numbers of the device with their
    meaning.
    """
    monkeypatch.chdir(tmp_path)
    np.savetxt("bare.txt", load_measurements(scans / "place_1.gwy")[0].data.heights_nm)
    words = [
        "--size",
        "2.5x2.5",
        "--unit",
        "um,nm",
        "--detrend",
        "none",
        "--tip-nm",
        "0",
        "--channel",
        "Default",
    ]
    assert main(["bare.txt", *words]) is None
    scene = load_scene("bare.yaml")
    (instrument,) = scene.topography.instruments
    assert (instrument.size, instrument.unit, instrument.height_unit) == ((2.5, 2.5), "um", "nm")
    assert (scene.topography.detrend, scene.topography.channel) == ("none", "Default")
    text = Path("bare.yaml").read_text(encoding="utf-8")
    for name in SCALAR_KEYS:
        untold = "# " * (name in KNOWN_IF_STATED)
        assert f"\n  {untold}{name}: " in text
    assert main(["bare.txt", *words[:-2]]) == 1  # the scene of other words stays


def test_a_file_is_described_by_one_thread_as_its_scene_does(scans, started, tmp_path, monkeypatch):
    """Threads cost three times the processor time, and the last digits of the scene's job."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "3")
    main([str(scans / "place_1.gwy")])
    assert os.environ["OMP_NUM_THREADS"] == "1"
    assert os.environ["OPENBLAS_NUM_THREADS"] == "3"  # the user's own


def follow(said):
    """Options that a refusal names, with its values; of several channels the first."""
    options = []
    for name, value in re.findall(
        r"--(size|unit|crop|points|channel)(?: ([\w:.x]+(?:,[\w:.]+)*))?", said
    ):
        if name == "channel":
            value = re.search(r"several height channels: ([^,]+),", said)[1]
        options += [f"--{name}", *([value] if value else [])]
    return options


def made_files(folder, heights):
    """Files that leave something open, or that are not as they should be, by name."""
    pixels, x = len(heights), np.arange(len(heights))
    line = heights[:, 5]
    aperture = np.hypot(*np.meshgrid(x - pixels / 2, x - pixels / 2)) < pixels / 2
    scattered = np.random.default_rng(0).uniform(-0.5, 0.5, (pixels, pixels, 2))
    points = np.stack(
        [x[:, None] + scattered[..., 0], x[None, :] + scattered[..., 1], heights], axis=-1
    ).reshape(-1, 3)
    metres = {"Height": (heights * 1e-9, "m"), "ZSensor": (heights * 1e-9, "m")}
    np.savetxt(folder / "line_alone.txt", line)
    np.savetxt(folder / "line.txt", np.stack([x / 100, line], 1))
    np.savetxt(folder / "matrix.txt", heights)
    np.savetxt(folder / "points.xyz", points * (0.01, 0.01, 1.0))
    np.save(folder / "array.npy", heights)
    np.save(folder / "line.npy", line)
    with h5py.File(folder / "two.h5", "w") as file:
        file["first"], file["second"] = heights, heights
    write_channels(folder / "no_unit.gwy", {"Height": (heights, "")}, (2.5e-6, 2.5e-6))
    write_channels(folder / "two_channels.gwy", metres, (2.5e-6, 2.5e-6))
    write_gwy(
        folder / "aperture.gwy",
        asp.Scan(np.where(aperture, heights, np.nan), (2500.0, 2500.0), "a"),
    )


@pytest.mark.parametrize(
    "name",
    [
        "line_alone.txt",
        "line.txt",
        "matrix.txt",
        "points.xyz",
        "array.npy",
        "line.npy",
        "two.h5",
        "no_unit.gwy",
        "two_channels.gwy",
        "aperture.gwy",
    ],
)
def test_every_option_that_a_refusal_prints_works(
    scans, name, started, tmp_path, monkeypatch, capsys
):
    """Followed as printed, a refusal at a time, the film is described; no refusal comes twice."""
    monkeypatch.chdir(tmp_path)
    made_files(tmp_path, load_measurements(scans / "place_1.gwy")[0].data.heights_nm)
    scene, options = Path(name).with_suffix(".yaml"), []
    while True:
        main([name, "--tip-nm", "0", *options])
        said = capsys.readouterr().err
        if scene.is_file():
            break
        assert len(said.splitlines()) == 1
        more = follow(said)
        assert {word for word in more if word.startswith("--")} - set(options), said
        options += more
    assert options


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["scans/place_1.gwy", "--size", "0"], "--size 0: a side is above 0"),
        (["scans", "--unit", "inch"], "--unit inch: accepted are m, mm"),
        (["scans/place_1.gwy", "--size", "ten"], "--size ten: accepted is a number or two"),
        (
            ["scans/place_1.gwy", "--size", "10"],
            "scans/place_1.gwy: states a size itself; leave out",
        ),
        (
            ["scans/place_1.gwy", "--unit", "um"],
            "scans/place_1.gwy: states a unit itself; leave out",
        ),
        (["scans", "--points", "64x64"], "--points: accepted for one file"),
        (
            ["scans/place_1.gwy", "--points", "64"],
            "--points 64: accepted are two numbers such as 64x64",
        ),
        (
            ["scans/place_1.gwy", "--points", "64x64"],
            "scans/place_1.gwy: is no list of points x, y, z",
        ),
        (["scans/place_1.gwy", "--crop", "half"], "--crop half: accepted is nothing"),
        (
            ["scans/place_1.gwy", "--crop", "0:9999,0:64"],
            "scans/place_1.gwy: cut to 0:9999, 0:64 of",
        ),
        (
            ["many"],
            "many: 201 files; at most 200 are described together: move those of this surface",
        ),
        (
            ["scans/place_1.gwy", "--channel", "Phase"],
            "scans/place_1.gwy: no height channel 'Phase'",
        ),
        (["rnu"], "rnu: neither a file nor a command; did you mean run?"),
        (["empty"], "empty: nothing to read"),
        (["scans", "--material", "stiffness=3"], "stiffness: no such input"),
        (
            ["scans", "--material", "e_star=hard"],
            "e_star=hard: accepted is a number",
        ),
        (
            ["scans", "--device", "gap=2"],
            "gap=2: gap is no key of the device; did you mean gap_um?",
        ),
    ],
)
def test_bad_input_of_the_door_is_one_line(
    scans, arguments, words, started, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    Path("empty").mkdir()
    Path("many").mkdir()
    for number in range(201):
        Path(f"many/{number}.gwy").touch()
    Path("scans").symlink_to(scans)
    assert main(arguments) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"ERROR {words}")
    assert not started


def test_interrupting_the_reading_of_files_is_one_line(
    scans, started, tmp_path, monkeypatch, capsys
):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("asperity.film.load_measurements", interrupt)
    assert main([str(scans / "place_1.gwy")]) == 130
    assert capsys.readouterr().err.strip() == "interrupted; nothing was computed"
    assert not started
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not AFM.is_dir(), reason="real scans are not shipped")
def test_two_real_films_are_doubted_and_not_run(started, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([str(AFM / "example_ps.tiff"), str(AFM / "di-6.di")]) == 1
    said = capsys.readouterr()
    assert (
        "DOUBT (several_surfaces, about spectrum): 01_example_ps and 02_di-6 look like" in said.out
    )
    assert said.err.startswith("ERROR example_ps.yaml: not run because of the doubts above")
    assert not started
    # whoever knows that they are of one film says so, and the files that eq. 9 does not describe
    # are pressed
    film = asp.Film([AFM / "example_ps.tiff", AFM / "di-6.di"], on_doubt="warn")
    assert film.press().cycle.converged


def test_python_gives_the_numbers_of_the_scene_digit_for_digit(
    scans, started, workflow_in, monkeypatch
):
    monkeypatch.chdir(workflow_in.folder)
    main([str(scans), "--scene", "mine.yaml"])
    content = yaml.safe_load(Path("mine.yaml").read_text(encoding="utf-8"))
    content["contact"]["pixels"] = 128
    content["pad"] = {"cells": 8, "points": 0}
    Path("mine.yaml").write_text(yaml.safe_dump(content))
    done = workflow_in.run("mine.yaml", "contact", "answer")
    assert done.returncode == 0, done.stderr

    # as jobs have it
    threads = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "NUMBA")}
    command = [sys.executable, "-c", SAME_NUMBERS, str(scans)]
    same = subprocess.run(
        command,
        env={**os.environ, "PYTHONPATH": str(ROOT), **threads},
        capture_output=True,
        text=True,
    )
    assert same.returncode == 0, same.stderr


SAME_NUMBERS = """
import sys
from dataclasses import asdict

import numpy as np

import asperity as asp
from workflow.files.results import load_h5, load_json

film = asp.Film([f"{sys.argv[1]}/place_{k}.gwy" for k in (1, 2)])
stored = load_json("results/mine/topography/parameters.json")
for key in ("estimates", "surface", "inputs", "doubts", "gate"):
    assert film.description[key] == stored[key], key
contact = film.press(load_nN=7000.0, pixels=128)
curves, _, _ = load_h5("results/mine/contact/nominal.h5")
for name in ("closing", "opening"):
    for key, values in asdict(getattr(contact.cycle, name)).items():
        assert np.array_equal(values, curves[f"load_7000/{name}"][key]), (name, key)
switch = contact.switch(pad=asp.PadSettings(cells=8))
stored = load_json("results/mine/answer/pad_switch.json")
assert {key: stored[key] for key in switch.content} == switch.content
"""
