"""One quantity, one number on the first screen; elsewhere each number stands under the method that gave it."""

import csv
import re
from urllib.parse import unquote

import pytest

from mesoscale.law.parameters import LAW
from tests.workflow.made_up_results import write_all
from workflow.report.answer import answer
from workflow.report.available import Results
from workflow.report.numbers import OUTPUTS
from workflow.report.stages import pad, uncertainty
from workflow.report.verdict import release_cards

METHODS = (
    "by the response",
    "by the paper's method, here",
    "the paper",
    "runs at central inputs",
    "scatter",  # of the runs before it
    "surface's share",
)


@pytest.fixture(scope="module", params=["paper", "own"])
def results(request, tmp_path_factory):
    root = tmp_path_factory.mktemp("results") / request.param
    return Results(root, write_all(root), request.param)


def leading(text):
    """The number that a text begins with."""
    found = re.match(r"[−\d.]+", text)
    assert found, text
    return float(found[0].replace("−", "-"))


def test_the_first_screen_has_one_number_for_one_quantity(results):
    content = answer(results, [])
    cards = {card["title"]: card for card in content["cards"]}
    rows = {row[0].split(",")[0]: row for row in content["table"].rows}
    d_c = rows["d_c (nm)"]
    assert leading(cards["Contact begins at"]["value"]) == leading(d_c[1])
    shift = leading(d_c[2]) - leading(d_c[1])
    assert leading(cards["Hysteresis"]["value"]) == pytest.approx(shift, abs=0.11)  # of numbers with three digits
    assert f"come from the {results.response} at 200 samples" in content["method"]
    assert "hold what the inputs leave open, not the scatter from one surface to the next" in content["method"]


def test_release_says_its_electrode_and_what_its_interval_holds(results):
    for card in release_cards(results):
        assert re.search(r"electrode (that bends|flat on the pad)", card["detail"]), card
    assert any("the interval holds" in card["detail"] for card in release_cards(results))


def test_every_column_of_the_table_of_outputs_names_its_method(results):
    table = uncertainty.describe(results).blocks[0]
    for head in table.header[1:]:
        assert any(method in head for method in METHODS), head
    assert ("the paper" in " ".join(table.header)) == results.beside_paper


def test_the_histogram_shows_the_number_of_the_table_s_column(results):
    """δC_r once stood as −1.93 in the table and as +2.05 in the figure below it."""
    section = uncertainty.describe(results)
    header, lines = section.blocks[0].header, section.blocks[0].rows
    figure = section.blocks[1]
    text = unquote(re.search(r'download="table2fig.csv" href="data:text/csv;charset=utf-8,([^"]*)"', figure.svg)[1])
    rows = [row for row in csv.reader(text.splitlines()) if not row[0].startswith("#")][1:]
    marks = [float(row[2]) for row in rows if row[1] == "line 1"]  # the first mark of each panel: the response's
    column = header.index("by the response (mean ± dev)")
    assert [leading(line[column]) for line in lines] == pytest.approx(marks, rel=6e-3)
    assert "circles: their mean and deviation" in figure.caption
    assert ("squares: those of the paper's method here" in figure.caption) == results.beside_paper


def test_every_release_voltage_names_its_model(results):
    """By the electrode, or by the causes that its interval is over."""
    tables = [block for block in pad.describe(results).blocks if hasattr(block, "rows")]
    named = [f"{table.caption}: {row[0]}" for table in tables for row in table.rows if row[0].startswith("release")]
    assert named
    assert len(set(named)) == len(named)
    assert all(re.search(r"electrode (flat|that bends)|over the finite number of cells", words) for words in named)


def test_the_law_s_parameters_are_all_on_the_first_screen(results):
    assert [row[0].split(" ")[0] for row in answer(results, [])["table"].rows] == [OUTPUTS[p.name][0] for p in LAW]
