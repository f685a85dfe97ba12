"""Two folders of results side by side on one page."""

import re
import shutil

import pytest

from workflow.report.comparison import difference_of, main
from workflow.results import load_csv, write_csv


def test_page_of_two_scenes(made_up, tmp_path, capsys):
    for name in ("one", "two"):
        shutil.copytree(made_up[0], tmp_path / name)
    path = tmp_path / "two/uq/samples.csv"
    rows = load_csv(path)
    write_csv(path, [{**row, "closing_d_c_nm": repr(float(row["closing_d_c_nm"]) + 5)} for row in rows])
    assert main([str(tmp_path / "one"), str(tmp_path / "two"), str(tmp_path / "page.html")]) == 0
    assert "the comparison is page.html" in capsys.readouterr().out
    page = (tmp_path / "page.html").read_text()
    rows = dict(re.findall(r'<tr><th scope="row">(.*?)</th>.*<td>([^<]*)</td></tr>', page))
    assert rows["d<sub>c</sub>, closing (nm)"].startswith("5.00 [")
    assert rows["d<sub>c</sub>, opening (nm)"].startswith("0 [")
    assert rows["release voltage, 0 where it sticks (V)"] == "0"  # both scenes have the central value alone
    assert not any("flat" in name for name in rows)
    ids = re.findall(r' id="([^"]+)"', page)
    assert len(ids) == len(set(ids))


def test_interval_of_a_difference():
    """Of two normal quantities: deviations add in squares; a lopsided one keeps its sides."""
    assert difference_of((7.0, 10.0, 13.0), (16.0, 20.0, 24.0)) == pytest.approx((5.0, 10.0, 15.0))
    assert difference_of((10.0, 10.0, 10.0), (19.0, 20.0, 24.0)) == pytest.approx((9.0, 10.0, 14.0))
    assert difference_of((9.0, 10.0, 14.0), (20.0, 20.0, 20.0)) == pytest.approx((6.0, 10.0, 11.0))


def test_a_folder_without_results_is_refused_in_one_line(tmp_path, capsys):
    assert main([str(tmp_path), str(tmp_path), str(tmp_path / "page.html")]) == 1
    said = capsys.readouterr().err
    assert said.startswith("ERROR")
    assert said.count("\n") == 1
