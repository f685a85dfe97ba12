"""The page in a browser: no serious finding of the accessibility checker axe, no request, painted
within a second.
"""

from importlib.resources import files

import pytest

from tests.workflow.browser import probed

CHECK = """
window.addEventListener("load", () => setTimeout(async () => {
  document.querySelectorAll("details").forEach((part) => { part.open = true; });
  const { violations } = await axe.run(document, { iframes: false, resultTypes: ["violations"] });
  const text = document.createElement("pre");
  text.id = "probe";
  text.textContent = JSON.stringify({
    violations: violations.map(({ id, impact, nodes }) =>
      [impact, id, nodes[0].target.join(" "), nodes[0].failureSummary]),
    paint_ms: performance.getEntriesByName("first-contentful-paint")[0].startTime,
    requests: performance.getEntriesByType("resource").map(({ name }) => name),
    errors: window.failures,
  });
  parent.document.body.append(text);
}, 100));
"""


@pytest.mark.parametrize(("width", "dark"), [(1280, False), (390, True)])
def test_axe_finds_nothing_serious(page_of, tmp_path, width, dark):
    checker = files("axe_core_python").joinpath("axe.min.js").read_text(encoding="utf-8")
    found, _ = probed(
        page_of("made_up"), tmp_path, width, checker + CHECK, budget_ms=30000, dark=dark
    )
    assert [
        finding for finding in found["violations"] if finding[0] in ("serious", "critical")
    ] == []
    assert found["errors"] == []
    assert [name for name in found["requests"] if not name.startswith("data:")] == []
    assert found["paint_ms"] < 1000
