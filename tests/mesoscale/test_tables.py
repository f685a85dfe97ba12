import pytest

from mesoscale.tables import grow_table, load_table


def test_a_table_keeps_its_columns_as_it_grows(tmp_path):
    path = tmp_path / "t.csv"
    assert load_table(path) == []
    grow_table(path, [{"a": 1.23456, "b": "x"}], digits=3)
    grow_table(path, iter([{"b": "y"}]))
    assert load_table(path) == [{"a": "1.23", "b": "x"}, {"a": "", "b": "y"}]
    with pytest.raises(ValueError, match="c"):
        grow_table(path, [{"c": 1}])


def test_a_campaign_cut_short_has_its_rows(tmp_path):
    def rows():
        yield {"a": 1}
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        grow_table(tmp_path / "t.csv", rows(), columns=("b", "a"))
    assert load_table(tmp_path / "t.csv") == [{"b": "", "a": "1"}]
