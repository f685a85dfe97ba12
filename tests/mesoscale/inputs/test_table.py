"""The table of inputs: the paper's Table 1, stages with gates, and mistakes in one line."""

import csv
from pathlib import Path

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.inputs.contact import FilmInputs, contact_of
from mesoscale.inputs.table import (
    check_literature,
    check_resolved,
    collect,
    film_table,
    from_rows,
    input_table,
    to_rows,
)
from mesoscale.settings import ContactSettings, InputRow, InputsSettings, PadSettings
from mesoscale.settings.definitions import BY_NAME
from tests.mesoscale import paper

PAPER = paper.INPUTS
TABLE_1 = Path(__file__).parents[3] / "config" / "paper" / "table1.csv"
FILES = {
    "hardness": "hardness/fit.json",
    "elastic": "elastic/e_star.json",
    "topography": "topography/parameters.json",
}


def stages(passed=True):
    gate = {"passed": passed, "reasons": [] if passed else ["fewer than 3 sizes"]}
    ranges = {"q0": (0.015, 0.03), "hurst": (0.6, 0.9), "rms": (3, 9)}
    return {
        "hardness": {
            "gate": gate,
            "inputs": {
                "h_prime": {
                    "distribution": "uniform",
                    "a": 5.8,
                    "b": 15.0,
                    "correlation": {"h_macro": -0.4},
                }
            },
        },
        "elastic": {
            "gate": {"passed": True, "reasons": []},
            "inputs": {"e_star": {"distribution": "normal", "a": 95, "b": 5}},
        },
        "topography": {
            "gate": {"passed": True, "reasons": []},
            "inputs": {
                name: {"distribution": "uniform", "a": a, "b": b} for name, (a, b) in ranges.items()
            },
        },
    }


def test_scene_paper_is_table_1():
    with TABLE_1.open(newline="") as stream:
        expected = {row["parameter"]: row for row in csv.DictReader(stream)}
    table = collect(PAPER, {}, {})
    assert table.names == list(expected)
    for row in table.rows:
        wanted = expected[row.name]
        assert row.distribution.kind == wanted["distribution"]
        assert (row.distribution.a, row.distribution.b) == (float(wanted["a"]), float(wanted["b"]))
        assert row.unit == wanted["unit"] == BY_NAME[row.name].unit
        assert row.origin == "literature"


def test_scene_paper_wants_no_stage():
    assert PAPER.origins() == {"literature"}


def test_stage_rows_carry_their_file_and_correlation():
    table = collect(InputsSettings(), stages(), FILES)
    by_name = {row.name: row for row in table.rows}
    assert by_name["h_prime"].origin == "hardness"
    assert by_name["h_prime"].source == "hardness/fit.json"
    i, j = table.names.index("h_prime"), table.names.index("h_macro")
    assert table.correlation[i, j] == -0.4


FILM = {
    "rms": {"distribution": "uniform", "a": 5, "b": 6.5},
    "hurst": {"distribution": "uniform", "a": 0.7, "b": 0.8},
    "rms_scatter": {"distribution": "uniform", "a": 0.2, "b": 0.4},
}


def test_a_pad_has_the_typical_place_of_its_film_and_how_much_places_differ():
    cells = collect(InputsSettings(), stages(), FILES)
    pad = film_table(cells, FILM, None)
    assert pad.names == [*cells.names, "rms_scatter"]
    middle = pad.medians()
    assert [middle[name] for name in ("rms", "hurst", "rms_scatter")] == pytest.approx(
        [5.75, 0.75, 0.3]
    )
    others = ("hamaker", "e_star", "h_macro", "h_prime", "q0")
    assert [middle[name] for name in others] == [cells.medians()[name] for name in others]
    assert (pad.correlation[:-1, :-1] == cells.correlation).all()
    assert contact_of(middle, ContactSettings())[0] == FilmInputs(**middle)


def test_a_range_of_the_literature_is_split_only_where_the_scene_says_how():
    table = collect(PAPER, {}, {})
    assert film_table(table, FILM, None).rows == table.rows
    stated = film_table(table, {}, (0.1, 0.3))
    assert stated.rows[:-1] == table.rows
    assert stated.rows[-1].distribution.span() == (0.1, 0.3)
    assert stated.rows[-1].source == "pad.rms_scatter"


@pytest.mark.parametrize(
    ("given", "message"),
    [((0.4, 0.2), "must not exceed"), ((-0.1, 0.2), "0 or more"), ((0.1, 3), "2 or less")],
)
def test_a_scatter_of_places_that_is_no_range_is_refused_in_one_line(given, message):
    with pytest.raises(InputError, match=message):
        PadSettings(rms_scatter=given)


def test_table_survives_writing_and_reading():
    table = collect(InputsSettings(), stages(), FILES)
    rows = [
        {
            key: "" if value is None else str(value)
            for key, value in ({"a": "", "b": "", "low": "", "high": ""} | row).items()
        }
        for row in to_rows(table)
    ]
    again = from_rows(rows)
    assert again.names == table.names
    assert np.array_equal(again.sample(20, 1), table.sample(20, 1))


def test_failed_gate_stops_with_its_reason():
    with pytest.raises(
        InputError, match=r"hardness/fit.json.*fewer than 3 sizes.*h_prime.*literature"
    ):
        collect(InputsSettings(), stages(passed=False), FILES)


def test_missing_entry_of_a_stage_is_named():
    content = stages()
    del content["topography"]["inputs"]["rms"]
    with pytest.raises(InputError, match=r"inputs\.rms"):
        collect(InputsSettings(), content, FILES)


def test_range_across_a_physical_bound_is_refused():
    settings = PAPER.model_copy(update={"rms": InputRow(distribution="normal", values=(3, 2))})
    with pytest.raises(InputError, match=r"inputs.rms: spans -.*accepted is 0 or 1e-05"):
        collect(settings, {}, {})


def test_samples_from_a_file(tmp_path):
    file = tmp_path / "rms.csv"
    file.write_text("rms\n3\n5\n4\n")
    settings = PAPER.model_copy(update={"rms": InputRow(distribution="samples", values=str(file))})
    table = collect(settings, {}, {})
    assert table.ranges()[-1].tolist() == [3, 5]
    rows = [{key: str(value) for key, value in row.items()} for row in to_rows(table)]
    assert np.array_equal(from_rows(rows).sample(10, 1), table.sample(10, 1))
    file.write_text("height\n3\n")
    with pytest.raises(InputError, match="column rms"):
        collect(settings, {}, {})
    file.unlink()
    with pytest.raises(InputError, match="cannot be read"):
        collect(settings, {}, {})


def test_samples_of_one_file_are_joint(tmp_path):
    file, rng = tmp_path / "film.csv", np.random.default_rng(3)
    hurst = rng.uniform(0.5, 0.9, 400)
    rms = 3 + 2 * (1 - hurst) + 0.1 * rng.standard_normal(400)
    np.savetxt(
        file,
        np.column_stack([hurst, rms, hurst]),
        delimiter=",",
        header="hurst,rms,place",
        comments="",
    )
    row = InputRow(distribution="samples", values=str(file))
    table = collect(PAPER.model_copy(update={"hurst": row, "rms": row}), {}, {})
    drawn = dict(zip(table.names, table.sample(20_000, 1).T, strict=True))
    assert np.corrcoef(drawn["hurst"], drawn["rms"])[0, 1] == pytest.approx(
        np.corrcoef(hurst, rms)[0, 1], abs=0.02
    )
    assert np.std(drawn["rms"] - 3 - 2 * (1 - drawn["hurst"])) == pytest.approx(0.1, rel=0.1)


def samples_of(*names, varies="common", **files):
    rows = {
        name: InputRow(distribution="samples", values=str(files[name]), varies=varies)
        for name in names
    }
    return PAPER.model_copy(update=rows)


def test_joint_samples_of_a_file_are_joint_however_its_path_is_written(tmp_path):
    """As are those of a link to it."""
    file, link = tmp_path / "g.csv", tmp_path / "link.csv"
    rng = np.random.default_rng(0)
    np.savetxt(
        file,
        rng.uniform(0.6, 0.9, 200)[:, None] * [1.0, 10.0],
        delimiter=",",
        header="hurst,rms",
        comments="",
    )
    link.symlink_to(file)
    for other in (f"{tmp_path}/./g.csv", link):
        table = collect(samples_of("hurst", "rms", hurst=file, rms=other), {}, {})
        k, m = table.names.index("hurst"), table.names.index("rms")
        assert table.correlation[k, m] == pytest.approx(1.0)


def test_joint_samples_of_what_is_common_and_what_varies_are_refused(tmp_path):
    file = tmp_path / "g.csv"
    file.write_text("hurst,rms\n0.7,4\n0.8,5\n0.75,7\n")
    settings = samples_of("hurst", "rms", hurst=file, rms=file)
    settings = settings.model_copy(
        update={"rms": settings.rms.model_copy(update={"varies": "each"})}
    )
    for check in (lambda: collect(settings, {}, {}), lambda: check_literature(settings)):
        with pytest.raises(
            InputError, match="joint samples of hurst, rms, of which some are common to all devices"
        ):
            check()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("rms,rms\n4,5\n6,7\n", "2 columns are named rms; rename or remove all but one"),
        ("rms\n4,5\n5,1\n6,3\n", "row 1 has 2 values, the header 1 names; write decimal points"),
        ("rms,hurst\n4\n5\n", "holds samples of hurst beside"),
        ("place,x\n4,1\n", "needs a column rms with one number a row"),
        ("rms\n4\n\n", "1 samples; at least 2"),
    ],
)
def test_tables_of_samples_that_say_two_things_are_refused(tmp_path, text, words):
    file = tmp_path / "g.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        collect(samples_of("rms", rms=file), {}, {})
    assert "\n" not in str(caught.value)


def test_a_table_is_read_once_for_all_its_columns(tmp_path, monkeypatch):
    """And again when it changed; empty columns at the end of each row are none."""
    file, opened = tmp_path / "g.csv", []
    file.write_text("hurst,rms,\n0.7,4,\n0.8,5,\n0.75,7,\n")
    read = Path.open
    monkeypatch.setattr(
        Path, "open", lambda self, *args, **more: opened.append(self) or read(self, *args, **more)
    )
    settings = samples_of("hurst", "rms", hurst=file, rms=file)
    collect(settings, {}, {})
    check_literature(settings)
    assert opened.count(file) == 1
    file.write_text("hurst,rms\n0.7,4\n0.8,5\n0.75,9.5\n")
    (rms,) = (row for row in collect(settings, {}, {}).rows if row.name == "rms")
    assert rms.distribution.values.max() == 9.5


def test_samples_without_their_partners_are_refused(tmp_path):
    file = tmp_path / "film.csv"
    file.write_text("hurst,rms\n0.5,3\n0.7,4\n")
    settings = PAPER.model_copy(update={"rms": InputRow(distribution="samples", values=str(file))})
    for check in (lambda: collect(settings, {}, {}), lambda: check_literature(settings)):
        with pytest.raises(
            InputError,
            match=r"inputs.rms.values = .*: holds samples of hurst beside; give inputs.hurst",
        ):
            check()


def test_a_measured_cutoff_beyond_the_grid_is_refused_with_what_to_do():
    table = input_table(q1=InputRow(values=(0.2, 1.0)))
    check_resolved(table, 1.0)
    with pytest.raises(
        InputError,
        match=r"q1 reaches 1 1/nm, beyond .* \(0\.8 1/nm\); raise contact\.pixels, or set",
    ):
        check_resolved(table, 0.8)


def test_eighth_input():
    settings = PAPER.model_copy(update={"gap_cutoff": InputRow(values=(0.165, 0.3))})
    assert collect(settings, {}, {}).names[-1] == "gap_cutoff"


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ({"values": (3, 2)}, "must not exceed"),
        ({"distribution": "normal", "values": (3,)}, "none of distribution normal"),
        ({"distribution": "samples", "values": (3,)}, "none of distribution samples"),
        ({"distribution": "normal", "values": "samples.csv"}, "none of distribution normal"),
        ({"values": (3, "high")}, "accepted are uniform"),
        ({"values": 3}, "accepted are uniform"),
        ({"values": (3, True)}, "accepted are uniform"),
        ({"origin": "elastic", "values": (3, 4)}, "takes no values"),
        ({"distribution": "normal", "values": (3, -1)}, "deviation -1"),
        ({"distribution": "truncated_normal", "values": (3, 1, 4, 2)}, "low must lie below"),
        ({}, "needs values"),
    ],
)
def test_mistakes_in_a_row(row, message):
    with pytest.raises(InputError, match=message):
        InputRow(**row)


def test_mistakes_across_rows():
    with pytest.raises(InputError, match="unknown input hardness"):
        InputsSettings(correlations={"rms": {"hardness": 0.3}})
    with pytest.raises(
        InputError, match="e_star with h_macro is stated twice; leave one of them out"
    ):
        InputsSettings(correlations={"e_star": {"h_macro": 0.5}, "h_macro": {"e_star": -0.5}})
    with pytest.raises(
        InputError, match="rms with q0 = 1; accepted is more than -1 and less than 1"
    ):
        InputsSettings(correlations={"rms": {"q0": 1.0}})
    with pytest.raises(InputError, match="q0: origin elastic"):
        InputsSettings(q0=InputRow(origin="elastic"))


def test_settings_called_from_python_give_one_line_for_all_mistakes():
    with pytest.raises(InputError) as refusal:
        ContactSettings(pixels="many", lenght_nm=3, max_force_nN=-1.5)
    message = str(refusal.value)
    assert "\n" not in message
    assert all(
        word in message
        for word in (
            "pixels = 'many'",
            "lenght_nm = 3: unknown key; did you mean length_nm?",
            "max_force_nN = -1.5",
        )
    )


def test_help_on_settings_shows_keys_with_default_and_unit():
    text = ContactSettings.__doc__ or ""
    assert "length_nm : default 1000.0, nm" in text
    assert "side of the square, periodic cell" in text
