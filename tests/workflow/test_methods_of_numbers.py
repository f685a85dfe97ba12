"""One quantity, one number on the first screen; elsewhere each number stands under the model that
gave it.
"""

import re

import pytest

from tests.workflow.made_up_results import DOUBT
from workflow.report.available import Results
from workflow.report.render import low
from workflow.report.stages import pad, sensitivity, uncertainty
from workflow.report.verdict import verdict


@pytest.fixture(scope="module", params=["paper", "own"])
def results(request, made_up):
    return Results(*made_up, request.param)


@pytest.fixture(scope="module")
def page(results, page_of):
    return page_of(results.scene)


def test_page_and_verdict_say_the_same(results, page):
    words = low(verdict(results).outcome)
    assert f'<h1 id="first-title">{words}</h1>' in page


def test_no_other_release_stands_on_the_page(results, page):
    """Seven releases and four probabilities stood on the page of scene paper.

    Volts of the budget and of numerical errors are differences.
    """
    page = re.sub(r'<section id="part-budget".*?</section>', "", page, flags=re.DOTALL)
    page = re.sub(r'aria-label="Numerical errors;.*?</table>', "", page, flags=re.DOTALL)
    unfolded = re.sub(
        r"<details.*?</details>",
        "",
        page[page.index("<main>") : page.index("</main>")],
        flags=re.DOTALL,
    )
    unfolded = re.sub(r"<svg.*?</svg>", "", unfolded, flags=re.DOTALL)
    words = re.sub(r"<[^>]*>", "", unfolded)
    words = re.sub(r"It closes at .*?\. Check this", "", words)  # pull-in
    words = re.sub(r"Its capacitance has fallen to half before, at [\d.]+ V", "", words)
    volts = set(re.findall(r"[\d.]+ V\b", words))
    assert volts <= {
        f"{value:.3g} V"
        for value in (*verdict(results).release_V, *(verdict(results).other_law_V or ()))
    }
    for other in (pad, uncertainty, sensitivity):
        assert not any(
            "release (V)" in row
            for block in other.describe(results).blocks
            for row in _heads(block)
        )


def _heads(block):
    return [row[0] for row in block.rows] if hasattr(block, "rows") else []


def test_a_quantity_below_its_bar_is_grey_wherever_it_stands(results, page):
    for stage in (uncertainty, sensitivity):
        table = next(block for block in stage.describe(results).blocks if hasattr(block, "rows"))
        assert [row for row in table.faint] == ["C_r (10⁻⁴ GPa)"]
    assert page.count('<tr class="faint">') == 2
    assert f"Cr: {low(DOUBT)}" in re.sub(r"<[^>]*>", "", page)


def test_every_column_of_the_table_of_outputs_names_its_method(results):
    table = next(block for block in uncertainty.describe(results).blocks if hasattr(block, "rows"))
    methods = ("response", "the paper's method", "the paper", "runs at central inputs", "scatter")
    assert all(any(method in head for method in methods) for head in table.header[1:])
    assert ("the paper" in " ".join(table.header)) == results.beside_paper
