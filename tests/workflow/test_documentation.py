"""The reader of surrogates in the documentation does what it says."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from mesoscale.inputs.table import collect
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.collocation import nodes, to_values
from mesoscale.uncertainty.propagation import RESPONSES, NodeOutputs, propagate, surrogate_json
from workflow.results import write_json
from workflow.scene import load_scene

PAGE = Path(__file__).parents[2] / "docs" / "uncertainty.md"


def test_ten_lines_read_the_exported_responses(tmp_path, monkeypatch):
    table = collect(load_scene("paper").inputs, {}, {}, 0.999)
    ranges = table.ranges(0.999)
    x = to_values(nodes(7, 1), ranges)
    given = NodeOutputs([0], np.repeat(np.exp(x @ (1 / ranges[:, 1]))[None, :, None], 8, axis=2))
    settings = UncertaintySettings(response="polynomial", samples=20)
    result = propagate(given, table, settings)
    path = tmp_path / "results/paper/uq/surrogate.json"
    write_json(path, surrogate_json(result, given, table, settings, {}, {}, {}))
    assert json.loads(path.read_text())["method"].startswith("polynomial")

    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(code, names)
    evaluate = names["evaluate"]
    assert callable(evaluate)
    for sample, outputs in zip(result.samples[:5], result.outputs[:5], strict=True):
        values = dict(zip(table.names, sample.tolist(), strict=True))
        # E* is normal and may leave the range of the response, where both extrapolate
        read = [evaluate(name, values) for name in RESPONSES]
        assert read == pytest.approx(outputs.tolist(), rel=1e-9)
