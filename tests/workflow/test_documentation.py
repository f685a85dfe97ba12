"""What the documentation shows works: its scenes load, and its reader of surrogates does what it says."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from mesoscale.inputs.table import collect
from mesoscale.law.parameters import FITTED
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.propagation import NodeOutputs, propagate, surrogate_json
from workflow.results import write_json
from workflow.scene import load_scene

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "uncertainty.md"
SCENES = [
    pytest.param(block, id=f"{page.stem}-{number}")
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
    for number, block in enumerate(
        re.findall(r"^```yaml\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    )
]


@pytest.mark.parametrize("block", SCENES)
def test_a_scene_of_a_page_is_accepted(block, tmp_path):
    path = tmp_path / "of_a_page.yaml"
    path.write_text(block.replace("...", "a source"), encoding="utf-8")
    assert load_scene(str(path)).name == "of_a_page"


def test_ten_lines_read_the_exported_responses(tmp_path, monkeypatch):
    table = collect(load_scene("paper").inputs, {}, {})
    ranges = table.ranges()
    nothing = NodeOutputs([0], np.full((1, 15, 8), np.nan))
    x = table.sample(200, 1)
    z = np.random.default_rng(1).multivariate_normal(np.zeros(8), 0.04 * (np.eye(8) + 0.5), 200)
    direct = x, np.exp(x @ (1 / ranges[:, 1]))[:, None] * np.exp(z)
    result = propagate(nothing, table, UncertaintySettings(), direct)
    path = tmp_path / "results/paper/uq/surrogate.json"
    write_json(path, surrogate_json(result, nothing, table, {}, {}))
    assert json.loads(path.read_text())["method"] == "regression"

    code, draw = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(code, names)
    exec(draw, names)
    evaluate = names["evaluate"]
    assert callable(evaluate)
    for sample, outputs in zip(result.samples[:5], result.outputs[:5], strict=True):
        values = dict(zip(table.names, sample.tolist(), strict=True))
        # E* is normal and may leave the range of the response, where both extrapolate
        read = [evaluate(name, values) for name in FITTED]
        assert read == pytest.approx(outputs.tolist(), rel=1e-9)
    cells = names["cells"]
    assert callable(cells)
    values = dict(zip(table.names, result.samples[0].tolist(), strict=True))
    scatter = json.loads(path.read_text())["scatter"]
    drawn = []
    for name, transform in zip(FITTED, scatter["transforms"], strict=True):
        sample, mean = cells(values, 4000)[name], evaluate(name, values)
        drawn.append(np.log(sample / mean) if transform == "log" else sample - mean)
    expected = np.array(scatter["covariance"])
    deviation = np.sqrt(np.diag(expected))
    # four standard errors of the covariance of 4000 draws
    error = 4 * np.sqrt((expected**2 + np.outer(deviation, deviation) ** 2) / 4000)
    np.testing.assert_array_less(np.abs(np.cov(drawn) - expected), error)
