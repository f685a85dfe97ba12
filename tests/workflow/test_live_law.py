"""The explorer's sliders against the library: every input moved in a browser, every number compared."""

import json

import numpy as np
from scipy.optimize import brentq

from mesoscale.law.compact import Law, pressure
from mesoscale.law.parameters import PARAMETERS
from mesoscale.uncertainty.surrogate import from_json
from tests.workflow.browser import WHOLE_NUMBERS, probed
from workflow.report.numbers import OUTPUTS

MOVE = (
    WHOLE_NUMBERS
    + """
document.querySelectorAll("details").forEach((part) => { part.open = true; });
window.addEventListener("load", () => {
  const table = () => [...document.querySelectorAll("#parameters tbody tr")].map((row) =>
    [...row.cells].slice(1).map((cell) => parseFloat(cell.textContent.replace("−", "-"))));
  const sliders = [...document.querySelectorAll("#sliders input")];
  const found = [];
  for (const slider of sliders) {
    for (const share of [0, 0.3, 1]) {
      slider.value = share * slider.max + (1 - share) * slider.min;
      slider.dispatchEvent(new Event("input", { bubbles: true }));
      found.push({ moved: slider.name, at: sliders.map(({ value }) => Number(value)), table: table() });
    }
    slider.value = slider.defaultValue;
  }
  const text = document.createElement("pre");
  text.id = "probe";
  text.textContent = JSON.stringify({ found, errors: window.failures });
  parent.document.body.append(text);
});
"""
)


def by_library(content, at):
    """Rows of the explorer's table at these inputs, closing and opening: the law, and its separation at 6 MPa."""
    responses = from_json(content)
    hamaker = at[[row["name"] for row in content["inputs"]].index("hamaker")]
    columns = []
    for branch in ("closing", "opening"):
        values = {name: float(responses[f"{branch}_{name}"](np.array([at]))[0]) for name in PARAMETERS}
        law = Law(**values, hamaker=hamaker, rho_a_nm=2.0, shield_nm=2.0)
        near = values["d_c_nm"] - 20 * values["rho_r_nm"]
        separation = brentq(lambda s, law=law: sum(pressure(s, law)) - 6e-3, near, values["d_c_nm"], xtol=1e-12)
        columns.append([values[name] * OUTPUTS[name][2] for name in PARAMETERS] + [separation])
    return np.transpose(columns)


def test_every_slider_of_the_explorer_in_a_browser(made_up, page_of, tmp_path):
    content = json.loads((made_up[0] / "uq/surrogate.json").read_text())
    found, _ = probed(page_of("made_up"), tmp_path, 1280, MOVE, budget_ms=10000)
    assert found["errors"] == []
    assert {move["moved"] for move in found["found"]} == {row["name"] for row in content["inputs"]}
    for move in found["found"]:
        np.testing.assert_allclose(move["table"], by_library(content, move["at"]), rtol=1e-6, err_msg=move["moved"])
    for name in {move["moved"] for move in found["found"]}:
        tables = [str(move["table"]) for move in found["found"] if move["moved"] == name]
        assert len(set(tables)) == len(tables), f"slider {name} does nothing"
