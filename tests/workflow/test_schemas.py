"""Every CSV result has a schema; what does not fit it is neither written nor read."""

import re
from pathlib import Path

import pytest

from evidence.failure.rare_failures import known_pad
from mesoscale.answer import switches as answer_switches
from mesoscale.answer.points import central_point, cutoff_range, plan_points
from mesoscale.answer.switches import PadModel, solve_point, solve_points
from mesoscale.circuit import switches
from mesoscale.circuit.switches import spread_switches
from mesoscale.inputs.table import film_table
from mesoscale.settings import ContactSettings, InputRow
from mesoscale.studies.answer_stability import published_beam
from tests.mesoscale.answer.test_release import pad_of_two, table
from workflow.files.results import load_csv, write_csv
from workflow.schemas import STAGES, UnfitTable, schema_of
from workflow.schemas.__main__ import PAGE, page

RULES = Path(__file__).parents[2] / "workflow" / "rules"
ROW = {"hold_V": 80.0, "attraction": 0.5, "failing": 0.6, "failing_q95": 0.7, "failing_sure": 0.8}
TABLE = "results/mine/failure/failure.csv"


def test_every_table_of_the_rules_has_a_schema():
    rules = "".join(path.read_text() for path in RULES.glob("*.smk"))
    paths = set(re.findall(r'\{RESULTS\}/([^"\n]*\.csv)"', rules)) - {
        "{{kind}}/{{stage}}.csv",
        "{kind}/{stage}.csv",
    }
    assert len(paths) > 35
    names = [re.sub(r"\{\{?[^}]*\}\}?", "x_1", path.replace("{name}", "chunk")) for path in paths]
    assert not [name for name in names if schema_of(Path(name)) is None]


def test_every_schema_belongs_to_a_rule():
    rules = "".join(path.read_text() for path in RULES.glob("*.smk"))
    patterns = [path for tables in STAGES.values() for table in tables for path in table.paths]
    assert not [
        pattern for pattern in patterns if pattern.partition("*")[0].rpartition("/")[0] not in rules
    ]


def test_the_page_of_result_files_is_up_to_date():
    assert PAGE.read_text(encoding="utf-8") == page(), "run: python -m workflow.schemas"


@pytest.mark.parametrize(
    ("row", "words"),
    [
        (ROW | {"heigth": 0.6}, "column heigth is unknown"),
        (
            {key: value for key, value in ROW.items() if key != "attraction"},
            "column attraction is missing",
        ),
        (ROW | {"failing": None}, "row 1 has no value in column failing"),
        (ROW | {"failing": "most"}, "row 1, column failing: 'most' is no number"),
    ],
)
def test_a_table_that_does_not_fit_is_not_written(tmp_path, row, words):
    with pytest.raises(ValueError, match=rf"failure\.csv: {words}"):
        write_csv(tmp_path / TABLE, [row])
    assert not (tmp_path / TABLE).exists()


def test_a_result_without_a_schema_is_not_written(tmp_path):
    with pytest.raises(ValueError, match=r"results/mine/new\.csv: no table of workflow/schemas"):
        write_csv(tmp_path / "results/mine/new.csv", [ROW])
    write_csv(tmp_path / "elsewhere/new.csv", [ROW])


def test_the_schema_orders_the_columns(tmp_path):
    path = tmp_path / "results/mine/elastic/quenched/a.csv"
    row = {
        "status": "accepted",
        "coordination_Si": 4.0,
        "coordination_N": 3.0,
        "defects": 0,
        "structure": "a",
    }
    row |= {
        "attempt": 0,
        "density_g_cm3": 3.0,
        "shortest_SiN_A": 1.7,
        "bond_spread_A": 0.1,
        "symmetry_operations": 1,
    }
    write_csv(path, [row])
    names = path.read_text().splitlines()[0].split(",")
    assert names[:5] == [
        "structure",
        "attempt",
        "density_g_cm3",
        "coordination_Si",
        "coordination_N",
    ]
    assert names[-1] == "status"


def test_a_table_without_rows_has_its_columns(tmp_path):
    write_csv(tmp_path / TABLE, [])
    assert load_csv(tmp_path / TABLE) == []
    assert (tmp_path / TABLE).read_text() == "hold_V,attraction,failing,failing_q95,failing_sure\n"


def test_a_column_that_may_be_empty_needs_no_value(tmp_path):
    path = tmp_path / "results/mine/calibration/predictive.csv"
    spread = {
        f"{state}_{name}": 1.0 for state in ("prior", "posterior") for name in ("q05", "q50", "q95")
    }
    write_csv(path, [{"quantity": "release", "unit": "V", **spread}])
    assert load_csv(path)[0]["force_nN"] == ""


def test_what_was_written_is_read(tmp_path):
    write_csv(tmp_path / TABLE, [ROW, ROW | {"attraction": float("nan")}])
    assert load_csv(tmp_path / TABLE)[1] == {key: repr(value) for key, value in ROW.items()} | {
        "attraction": "nan"
    }


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda text: text.replace("failing", "top"), "column failing is missing"),
        (lambda text: text[:-5], "row 1 ends before column failing_sure"),
        (
            lambda text: text.replace("0.5", "0.\x005"),
            r"row 1, column attraction: '0\.\\x005' is no number",
        ),
        (
            lambda text: text.replace("0.6", "0.6,0.6"),
            "row 1 goes beyond the last column, failing_sure",
        ),
        (lambda text: "", "column hold_V is missing"),
    ],
)
def test_a_damaged_table_is_refused_in_one_line(tmp_path, change, words):
    path = tmp_path / TABLE
    write_csv(path, [ROW])
    path.write_text(change(path.read_text()))
    with pytest.raises(
        UnfitTable, match=rf"{words}; damaged or of another version: delete it and run again"
    ):
        load_csv(path)


AS_INPUTS = {
    "humidity": InputRow(values=(0.1, 0.5)),
    "gap_cutoff": InputRow(values=(0.2, 0.3)),
    "q1": InputRow(values=(0.4, 0.5)),
}
FILM = {
    "hardness": "film",
    "h_prime": None,
    "h_film": InputRow(values=(8.0, 10.0)),
    "t_film": InputRow(values=(4.0, 5.0)),
    "k_film": InputRow(values=(0.1, 0.5)),
    "m_film": InputRow(values=(1.0, 2.0)),
}


@pytest.mark.parametrize(
    ("rows", "scatter"), [({}, None), ({}, (0.1, 0.3)), (AS_INPUTS, None), (FILM, (0.1, 0.3))]
)
def test_switches_for_circuits_fit_their_table_whatever_their_inputs(
    monkeypatch, tmp_path, rows, scatter
):
    """Own scans have places of unequal roughness: their switches were refused after all the
    work.
    """

    def press_pad(point, contact, cells, first_seed, **_):
        law = known_pad(point).curves
        return pad_of_two(law, 0.0)

    for module in (switches, answer_switches):
        monkeypatch.setattr(module, "press_pad", press_pad)
    contact, device = ContactSettings(mechanics="asperity"), published_beam()
    of_pad = film_table(table(**rows), {}, scatter)
    cutoffs = cutoff_range(of_pad, contact)
    design = plan_points(of_pad, contact, device, 8)
    central = solve_point(central_point(of_pad, contact, device), contact, 2, 0)
    model = PadModel(
        central, design, tuple(solve_points(list(enumerate(design.points, 1)), contact, 2))
    )
    made = spread_switches(model, of_pad, contact, cutoffs, 8)
    path = tmp_path / "results/mine/circuit/circuit.csv"
    write_csv(path, [switch.row for switch in made])
    assert set(of_pad.names) <= set(load_csv(path)[0])
