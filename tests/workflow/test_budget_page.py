"""The budget on the page takes what other targets computed where they ran."""

import pytest

from workflow.files.results import write_csv, write_json
from workflow.report.available import Results
from workflow.report.stages.budget import describe

EFFECT = {
    "about": "at most",
    "how": "literature",
    "held": False,
    "settle": "measure it",
    "source": "a paper",
}


@pytest.fixture
def budget_of(tmp_path):
    def made(**tables):
        rows = {"humid air": 6.0, "creep of the beam": None}
        tables["answer/budget"] = [
            {"effect": name, "volts": volts, **EFFECT} for name, volts in rows.items()
        ]
        for name, content in tables.items():
            write_csv(tmp_path / f"{name}.csv", content)
        write_json(tmp_path / "answer/pad_switch.json", {"answer": None}, {})
        write_json(tmp_path / "lifetime/lifetime.json", {"years": 10.0}, {})
        paths = [
            tmp_path / "answer/pad_switch.json",
            tmp_path / "lifetime/lifetime.json",
            *(tmp_path / f"{name}.csv" for name in tables),
        ]
        section = describe(Results(tmp_path, paths, "mine"))
        rows = (row for block in section.blocks if not isinstance(block, str) for row in block.rows)
        return {row[0]: row[1:3] for row in rows if len(row) == 4}  # without that of the sources

    return made


def test_humid_air_is_that_which_was_computed(budget_of):
    other = {"reach_nm": 1.0, "error_V": 0.1, "energy_mJ_m2": 1.0, "pull_off_kPa": 1.0}
    humid = [
        {"humidity": rh, "opening": way, "release_V": volts, **other}
        for rh, way, volts in (
            (0.0, "balance", 6.0),
            (0.5, "balance", 5.2),
            (0.5, "volume", 4.7),
            (0.8, "volume", None),
        )
    ]
    plain, computed = budget_of(), budget_of(**{"humidity/humidity": humid})
    assert plain["humid air"] == ("6.0", "bound by literature: at most")
    assert computed["humid air"] == ("1.3", "computed here: 0% to 50%, menisci either way")
    assert computed["creep of the beam"][0] == "–"


def test_creep_and_bonds_are_what_a_life_computed(budget_of):
    rows = [
        {
            "effect": "beam",
            "guess": guess,
            "time_s": time,
            "strength": 0.1,
            "pull_in_V": 60.0,
            "release_V": volts,
        }
        for guess, end in (("least", 9.5), ("central", 8.0), ("most", 0.0))
        for time, volts in ((0.0, 10.0), (3.2e8, end))
    ]
    computed = budget_of(**{"lifetime/ageing": rows})
    about = "computed here: 10.0 years of hold, 0.50 to 10 V by assumed ranges; it may stick"
    assert computed["creep of the beam"] == ("2.0", about)
