"""The switch that the page follows itself, against the library: in Node.js to 1e-6, every slider in a browser."""

import base64
import json
import math
import re
import shutil
import subprocess
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

from mesoscale.device.beam_switch import solve_beam
from mesoscale.device.plate import beam_stiffness_N_per_m, plate_from_settings, solve_on_pad
from mesoscale.errors import InputError
from mesoscale.pad.memory import Flats, PadLaw
from mesoscale.settings import DeviceSettings
from tests.workflow.browser import WHOLE_NUMBERS, probed
from workflow.report.available import Results
from workflow.report.live.device import switch_data

LIVE = Path(__file__).parents[2] / "workflow" / "report" / "live"
CASES = (
    {},
    {"gap_um": 2.0},
    {"spring_N_per_m": 90.0},
    {"area_um2": 40000.0},
    {"bow_nm": 300.0},
    {"bow_nm": -300.0},
    {"adhesion": 1.57},  # where some pads stick and some do not
    {"adhesion": 2.2},
    {"adhesion": 0.0},
    {"gap_um": 5.0, "spring_N_per_m": 80.0, "area_um2": 90000.0, "bow_nm": 120.0, "adhesion": 1.7},
)


@pytest.fixture(scope="module")
def results(made_up):
    return Results(*made_up, "made_up")


@pytest.fixture(scope="module")
def data(results):
    return switch_data(results)


def _numbers(text):
    return np.frombuffer(base64.b64decode(text), "<f8")


def _law(curves, values, adhesion):
    """The library's pad from the numbers on the page."""
    s, depth = _numbers(curves["separation_nm"]), _numbers(curves["depth_nm"])
    branches, place = [], 0
    for start in (s[0], *depth):
        count = int((s >= start - 1e-9).sum())
        branch = np.full((2, s.size), np.nan)
        branch[:, s.size - count :] = values[place : place + 2 * count].reshape(2, count) * [[1.0], [adhesion]]
        branches.append(branch)
        place += 2 * count
    assert place == values.size
    return PadLaw(
        s,
        branches[0],
        depth,
        np.array(branches[1:]),
        Flats(adhesion * curves["flats"]["hamaker"], curves["flats"]["offset_nm"]),
    )


def by_library(data, chosen):
    """What the library says of the switch at these values of the sliders."""
    device = DeviceSettings(**{key: data["device"][key] for key in DeviceSettings.model_fields if key != "spread"})
    width = chosen["area_um2"] / device.length_um
    # the slider multiplies all that is elastic, tension among it
    stiffer = chosen["spring_N_per_m"] / beam_stiffness_N_per_m(device) * device.width_um / width
    settings = device.model_copy(
        update={
            "gap_um": chosen["gap_um"],
            "bow_nm": chosen["bow_nm"],
            "width_um": width,
            "youngs_modulus_GPa": device.youngs_modulus_GPa * stiffer,
            "residual_stress_MPa": device.residual_stress_MPa * stiffer,
        }
    )
    # a bow stiffens the beam, which the slider of the stiffness has already
    plate = plate_from_settings(settings.model_copy(update={"bow_nm": device.bow_nm}))
    hold = settings.hold_voltage_V
    law = _law(data["curves"], _numbers(data["curves"]["mean"]), chosen["adhesion"])
    return {
        "flat": _or_none(lambda: asdict(solve_on_pad(plate, law, hold))),
        "beam": _or_none(lambda: asdict(solve_beam(settings, law))),
    }


def _or_none(solve):
    try:
        return solve()
    except InputError:
        return None


def _chosen(data, case):
    return {slider["name"]: slider["value"] for slider in data["sliders"]} | case


def _agree(page, library):
    """Every number that the page computes is that of the library; what the library refuses, the page refuses."""
    assert (page is None) == (library is None)
    if page is None:
        return
    for name, value in page.items():
        assert value == pytest.approx(library[name], rel=1e-6, abs=1e-9), name


DRIVER = """
const [data, cases] = JSON.parse(require("fs").readFileSync(process.argv[2]));
const orNull = (solve) => {
  try { return solve(); } catch (error) { if (error instanceof OutOfRange) return null; throw error; }
};
console.log(JSON.stringify(cases.map((chosen) => {
  const { plate, beam } = switchOf(data.device, chosen);
  const mean = PadLaw.read(data.curves, chosen.adhesion);
  const hold = data.device.hold_voltage_V;
  return { flat: orNull(() => solveOnPad(plate, mean, hold)), beam: orNull(() => solveBeam(beam, mean)) };
})));
"""


def test_page_computes_what_the_library_computes(data, tmp_path):
    node = shutil.which("node")
    if node is None:
        pytest.skip("no Node.js is installed (Debian package nodejs)")
    cases = [_chosen(data, case) for case in CASES]
    (tmp_path / "cases.json").write_text(json.dumps([data, cases]))
    script = "".join((LIVE / f"{name}.js").read_text() for name in ("pad", "beam"))
    (tmp_path / "drive.js").write_text(script + DRIVER)
    done = subprocess.run(
        [node, tmp_path / "drive.js", tmp_path / "cases.json"], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    known = [by_library(data, chosen) for chosen in cases]
    for page, library in zip(found, known, strict=True):
        _agree(page["flat"], library["flat"])
        _agree(page["beam"], library["beam"])
    released = {round(case["flat"]["release_V"], 3) for case in known if case["flat"]}
    assert len(released) > 4, "the sliders do nothing"


MOVE = (
    WHOLE_NUMBERS
    + """
document.querySelectorAll("details").forEach((part) => { part.open = true; });
window.addEventListener("load", async () => {
  const rest = () => new Promise((done) => setTimeout(done, 600));
  const table = () => Object.fromEntries([...document.querySelectorAll("#switch-results tbody tr")].map((row) =>
    [row.cells[0].textContent, [...row.cells].slice(1).map((cell) => cell.textContent)]));
  const found = [];
  await rest();
  for (const slider of document.querySelectorAll("#switch-sliders input")) {
    slider.value = 0.6 * slider.max + 0.4 * slider.min;
    slider.dispatchEvent(new Event("input", { bubbles: true }));
    await rest();
    const status = document.getElementById("switch-status").textContent;
    found.push({ name: slider.name, value: Number(slider.value), table: table(), status });
    document.getElementById("switch-sliders").reset();
    await rest();
  }
  const text = document.createElement("pre");
  text.id = "probe";
  text.textContent = JSON.stringify({ found, rest: table(), errors: window.failures });
  parent.document.body.append(text);
});
"""
)


def test_every_slider_of_the_switch_in_a_browser(page_of, data, tmp_path):
    found, _ = probed(page_of("made_up"), tmp_path, 1280, MOVE, budget_ms=30000)
    assert found["errors"] == []
    assert [move["name"] for move in found["found"]] == [slider["name"] for slider in data["sliders"]]
    at_rest = {"name": "gap_um", "value": _chosen(data, {})["gap_um"], "table": found["rest"], "status": ""}
    for move in (at_rest, *found["found"]):
        library = by_library(data, _chosen(data, {move["name"]: move["value"]}))
        told = {head: [_told(cell) for cell in cells] for head, cells in move["table"].items()}
        if library["beam"] is None:
            assert "No number" in move["status"]
            assert math.isnan(told["release"][0])
            continue
        assert told["pull-in"][0] == pytest.approx(library["beam"]["pull_in_V"], rel=1e-6)
        assert told["release"][0] == pytest.approx(library["beam"]["release_V"], rel=1e-6)
        assert told["landed while held"][0] == pytest.approx(100 * library["beam"]["landed_share"], rel=1e-6)


def _told(cell):
    """Number in a cell; 0 V where the switch sticks, NaN where there is none."""
    if cell == "sticks":
        return 0.0
    found = re.match(r"[-−\d.e]+", cell)
    return float(found[0].replace("−", "-")) if found else math.nan


def test_sliders_need_the_switch_at_central_inputs(results, tmp_path):
    shutil.copytree(results.root, tmp_path / "made_up")
    file = tmp_path / "made_up/device/pad_switch.json"
    content = json.loads(file.read_text(encoding="utf-8"))
    files = [path for path in (tmp_path / "made_up").rglob("*") if path.is_file()]
    for central, known in ((content["central"], True), (None, False)):
        file.write_text(json.dumps({**content, "central": central}), encoding="utf-8")
        assert (switch_data(Results(tmp_path / "made_up", files, "made_up")) is not None) is known
