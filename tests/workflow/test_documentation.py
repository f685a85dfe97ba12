"""What the documentation shows works: its scenes load, and its reader of surrogates does what it
says.
"""

import json
import re
import shlex
import subprocess
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import asperity as asp
from asperity.__main__ import COMMANDS as DOORS
from asperity.__main__ import _parser as parser
from asperity.__main__ import targets as stages
from asperity.words import device_of, material_of
from mesoscale.inputs.table import collect
from mesoscale.law.parameters import FITTED
from mesoscale.settings import UncertaintySettings
from mesoscale.topography.measurements.loading import load_measurements, write_gwy
from mesoscale.uncertainty.propagation import NodeOutputs, propagate, surrogate_json
from tests.workflow.browser import probed
from workflow.files.results import write_json
from workflow.scene import load_scene

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "uncertainty.md"
INPUTS = asp.ContactInputs(0.215, 91.0, 1.95, 8.375, q0=0.025, hurst=0.7, rms=5.0)
SCENES = [
    pytest.param(block, id=f"{page.stem}-{number}")
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
    for number, block in enumerate(
        re.findall(
            r"^```yaml\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
        )
    )
]


@pytest.mark.parametrize("block", SCENES)
def test_a_scene_of_a_page_is_accepted(block, tmp_path):
    path = tmp_path / "of_a_page.yaml"
    path.write_text(block.replace("...", "a source"), encoding="utf-8")
    assert load_scene(str(path)).name == "of_a_page"


PAGES = (
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "config/README.md")),
    *sorted(ROOT.glob("docs/*.md")),
)
COMMANDS = [
    pytest.param(page, line.partition(" #")[0].strip(), id=line.strip())
    for page in PAGES
    for line in re.findall(
        r"^(?:    )?((?:make|asperity|\.venv/bin/asperity) .*)",
        page.read_text("utf-8"),
        re.MULTILINE,
    )
]


@pytest.fixture(scope="module")
def plan(make_workflow, tmp_path_factory):
    """Jobs of a shipped scene, from nothing."""
    return cache(make_workflow(tmp_path_factory.mktemp("plans")).planned)


@pytest.mark.parametrize(("page", "command"), COMMANDS)
def test_a_command_of_a_page_is_understood(page, command, plan):
    """Make has its target, the command its options, materials and keys; a scene ships and can be
    planned, or the page writes it.
    """
    if command.startswith("make"):
        done = subprocess.run(
            ["make", "-n", *shlex.split(command)[1:]], cwd=ROOT, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        command = next((line for line in done.stdout.splitlines() if " asperity " in line), "")
        if not command:  # of developers
            return
    words = shlex.split(command)
    words = words[[word.endswith("asperity") for word in words].index(True) + 1 :]
    given = parser().parse_args(words if words[0] in DOORS else ["film", *words])
    scene, targets = getattr(given, "scene", None), getattr(given, "target", [])
    if given.command == "film":
        material_of(given.material)
        device_of(given.device)
    elif given.command == "demo" or (
        scene and (ROOT / "config/scenes" / f"{scene}.yaml").is_file()
    ):
        assert plan(scene or "demo", *targets)
    elif scene:
        written = (
            "asperity run scene.yaml",
            f"`{scene}`",
            f"--scene {scene}",
            f"asperity {Path(scene).stem}/",
        )
        assert any(words in page.read_text(encoding="utf-8") for words in written)
        assert set(targets) <= set(stages())


def test_extras_are_named_one_way():
    known = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"][
        "optional-dependencies"
    ]
    for page in (ROOT / "README.md", *(ROOT / "docs").glob("*.md")):
        text = page.read_text(encoding="utf-8")
        assert set(re.findall(r"asperity-contact\[(\w+)\]", text)) <= set(known)
        assert not re.search(r"\.whl\[|REPOSITORY", text), page


def test_a_search_lists_pages_for_users_first(tmp_path):
    """ "tip radius" found functions of the code before the page on scans; Sphinx gives results as
    such lists.
    """
    pages = "api/mesoscale", "evidence/tip", "topography"
    script = (
        (ROOT / "docs/search_order.js").read_text(encoding="utf-8")
        + f"""
        const rows = {json.dumps([[page, "", "", None, 15] for page in pages])};
        const text = document.createElement("pre");
        text.id = "probe";
        rows.sort((one, other) => Scorer.score(other) - Scorer.score(one));
        text.textContent = JSON.stringify({{order: rows.map((row) => row[0])}});
        parent.document.body.append(text);"""
    )
    found, _ = probed("<html><style></style><body></body></html>", tmp_path, 800, script)
    assert found["order"] == list(reversed(pages))


def test_the_python_of_the_readme_runs(tmp_path, monkeypatch):
    (tmp_path / "scans").mkdir()
    heights = asp.random_surface(INPUTS, asp.ContactSettings(pixels=128, length_nm=2000.0), 1)
    write_gwy(tmp_path / "scans" / "place.gwy", asp.Scan(heights, (2000.0, 2000.0), "place"))
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    every_name: list[dict[str, Any]] = []
    for code in blocks:
        names: dict[str, Any] = {}
        exec(code, names)
        every_name.append(names)
    assert every_name[-1]["switch"].release_V >= 0.0


def test_the_python_of_the_page_on_extending_writes_a_scan(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(
        r"```python\n(.*?)```", (ROOT / "docs/extending.md").read_text(encoding="utf-8"), re.DOTALL
    )
    exec(code, {})
    (measured,) = load_measurements("my_scan.gwy")
    assert measured.data.lengths_nm == pytest.approx((1000.0, 1000.0))


def test_ten_lines_read_the_exported_responses(tmp_path, monkeypatch):
    table = collect(load_scene("paper").inputs, {}, {})
    ranges = table.ranges()
    nothing = NodeOutputs([0], np.full((1, 15, 8), np.nan))
    x = table.sample(200, 1)
    z = np.random.default_rng(1).multivariate_normal(np.zeros(8), 0.04 * (np.eye(8) + 0.5), 200)
    direct = x, np.exp(x @ (1 / ranges[:, 1]))[:, None] * np.exp(z)
    result = propagate(nothing, table, UncertaintySettings(), direct)
    path = tmp_path / "results/paper/uncertainty/surrogate.json"
    write_json(path, surrogate_json(result, table, {}))

    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(code, names)
    evaluate = names["evaluate"]
    assert callable(evaluate)
    for sample, outputs in zip(result.samples[:5], result.outputs[:5], strict=True):
        values = dict(zip(table.names, sample.tolist(), strict=True))
        # E* is normal and may leave the range of the response, where both extrapolate
        read = [evaluate(name, values) for name in FITTED]
        assert read == pytest.approx(outputs.tolist(), rel=1e-9)


def test_the_steps_of_the_tutorial_can_be_planned(make_workflow, tmp_path):
    """One scene, changed from step to step as the page says."""
    text = (ROOT / "docs/tutorial.md").read_text(encoding="utf-8")
    own, scans, switch, hardness = map(
        yaml.safe_load, re.findall(r"^```yaml\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    )
    (tmp_path / "scans").mkdir()
    heights = asp.random_surface(INPUTS, asp.ContactSettings(pixels=128, length_nm=2000.0), 1)
    write_gwy(tmp_path / "scans/place.gwy", asp.Scan(heights, (2000.0, 2000.0), "place"))
    workflow = make_workflow(tmp_path)

    def planned(scene, *targets):
        (tmp_path / "my_switch.yaml").write_text(yaml.safe_dump(scene), encoding="utf-8")
        return set(workflow.planned("my_switch.yaml", *targets))

    assert planned(own) >= {"inputs", "press_pads", "answer", "compute_direct_runs", "report"}
    measured = (
        own
        | scans
        | switch
        | {"inputs": {name: own["inputs"][name] for name in ("e_star", "h_macro", "h_prime")}}
    )
    assert planned(measured) >= {"analyse_scans", "press_pads", "answer"}
    computed = (
        own
        | hardness
        | {"inputs": {name: row for name, row in own["inputs"].items() if name != "h_prime"}}
    )
    assert planned(computed, "hardness") >= {"make_glass", "run_closing", "hardness"}
