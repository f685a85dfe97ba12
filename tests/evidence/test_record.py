import pytest

from evidence import record


@pytest.fixture
def table(tmp_path, monkeypatch):
    monkeypatch.setattr(record, "DATA", tmp_path)
    monkeypatch.setattr(record, "provenance", lambda command: {"command": command})
    return "room.study"


def test_a_table_keeps_its_columns_as_it_grows(table):
    assert record.load(table) == []
    record.record(table, [{"a": 1.23456, "b": "x"}], "once")
    record.record(table, iter([{"b": "y"}]), "again")
    first, second = record.load(table)
    assert first == {"a": "1.235", "b": "x", "command": "once"}
    assert second == {"a": "", "b": "y", "command": "again"}
    with pytest.raises(ValueError, match="c"):
        record.record(table, [{"c": 1}], "wrong")


def test_a_study_cut_short_has_its_rows(table):
    def rows():
        yield {"a": 1}
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        record.record(table, rows(), "cut")
    assert record.load(table) == [{"a": "1", "command": "cut"}]
