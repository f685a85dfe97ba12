"""Exports of a scene, each read back by another program, with equal numbers."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from asperity.guards.bundle import ROOT
from mesoscale.contact.cycle import Branch
from mesoscale.contact.resistance import resistance_Ohm, stiffness_of
from tests.workflow.made_up_results import write_all
from workflow.export.__main__ import main
from workflow.export.curves import tables_of
from workflow.export.maps import ContactMap, write_vtk
from workflow.files.results import load_csv, load_h5, write_text
from workflow.report.available import results_in

AREA_M2 = 1e-12  # of the made-up cell


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A folder with made-up results of a scene, which run nothing."""
    folder = tmp_path_factory.mktemp("export")
    (folder / "tiny.yaml").write_text("extends: table1\nname: tiny\n")
    write_all(folder / "results/tiny")
    write_text(folder / "results/tiny/answer/rough_pad.sub", ".subckt rough_pad\n.ends\n")
    return folder


@pytest.fixture(scope="module")
def exported(ran):
    """What the command writes of them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ran)
        assert main(["tiny.yaml", "out"]) == 0
    return ran / "out"


@pytest.fixture(scope="module")
def results(ran):
    """The results that are exported."""
    return results_in(ran / "results/tiny")


def test_moose_files_hold_the_net_pressure_of_a_cell(exported, results):
    group = results.h5("contact/nominal.h5")[0]["load_7000/closing"]
    table = pd.read_csv(exported / "moose/load_7000_closing.csv")
    assert np.array_equal(table["gap_m"], group["separation_nm"] * 1e-9)
    net_nN = group["repulsive_nN"] + group["attractive_nN"]
    assert table["pressure_Pa"].to_numpy() == pytest.approx(net_nN * 1e-9 / AREA_M2, rel=1e-14)


def test_the_stiffness_is_that_of_an_exponential_curve(exported):
    """The made-up force falls by e in 3 nm, so its stiffness is the force over 3 nm."""
    table = pd.read_csv(exported / "moose/plastic_opening.csv")[1:-1]
    # centred differences of exp(-x / 3) at steps of 25/29 nm err by (25/29/3)^2 / 6
    assert table["stiffness_Pa_per_m"].to_numpy() == pytest.approx(
        table["pressure_Pa"] / 3e-9, rel=0.014
    )


def test_every_moose_function_reads_a_rising_column_of_its_file(exported):
    text = (exported / "moose/functions.i").read_text()
    blocks = re.findall(r"\[(\w+)\]  # over (\w+)\n(.*?)\n  \[\]", text, re.DOTALL)
    assert text.count("[") == text.count("]")
    assert text.startswith("[Functions]\n")
    assert text.endswith("[]\n")
    for name, argument, lines in blocks:
        keys = dict(re.findall(r"(\w+) = (\S+)", lines))
        table = pd.read_csv(exported / "moose" / keys["data_file"])
        assert keys["type"] == "PiecewiseLinear"
        assert table.columns[int(keys["x_index_in_file"])] == argument
        assert name.endswith(table.columns[int(keys["y_index_in_file"])])
        assert (np.diff(table[argument]) > 0).all()
    assert {file.stem for file in exported.glob("moose/*.csv")} == {
        dict(re.findall(r"(\w+) = (\S+)", lines))["data_file"].removesuffix(".csv")
        for _, _, lines in blocks
    }


def test_comsol_files_are_columns_behind_comments(exported):
    files = sorted(exported.glob("comsol/*.txt"))
    assert files
    for file in files:
        numbers = np.loadtxt(file, comments="%")
        same = pd.read_csv(exported / "moose" / f"{file.stem}.csv").to_numpy()
        assert np.array_equal(numbers, same)


def test_oofem_records_give_the_same_functions(exported):
    lines = (exported / "oofem_functions.in").read_text().splitlines()
    for comment, record in zip(lines[::2], lines[1::2], strict=True):
        number, name, unit = re.fullmatch(r"# (\d+): (\w+) over (\w+)", comment).groups()
        words = record.split()
        count = int(words[3])
        assert words[:3] == ["PiecewiseLinFunction", number, "nPoints"]
        assert words[4:6] == ["t", str(count)]
        assert words[6 + count : 8 + count] == ["f(t)", str(count)]
        abscissae = np.array(words[6 : 6 + count], float)
        values = np.array(words[8 + count :], float)
        unit_of = {"pressure": "Pa", "gap": "m", "stiffness": "Pa_per_m", "conductance": "per_m"}
        quantity = "|".join(f"{word}_{SI}" for word, SI in unit_of.items())
        stem, column = re.fullmatch(rf"(.+)_({quantity})", name).groups()
        table = pd.read_csv(exported / "moose" / f"{stem}.csv")
        assert np.array_equal(values, table[column])
        scale = {"gap_nm": 1e9, "pressure_Pa": 1.0}[unit]
        assert abscissae == pytest.approx(table.iloc[:, 0].to_numpy() * scale, rel=1e-14)
        assert np.diff(abscissae).min() > 1e-12, "oofem takes nearer abscissae for one"


def test_conductance_is_that_of_barber(exported, results):
    """Of two metals, by the function of docs/resistance.md, without a mean free path."""
    groups, _, facts = load_h5(results.root / "contact/nominal.h5")
    opening = Branch(**groups["load_1000/opening"])
    way = stiffness_of(opening)
    metals = (22.0, 55.0)
    e_star = float(facts["load_1000"]["e_star"])
    ohm = resistance_Ohm(way.slope, way.area_nm2, e_star, metals, (0.0, 0.0))
    table = pd.read_csv(exported / "moose/load_1000_conductance.csv")
    harmonic_mean = 2 / (metals[0] + metals[1]) * 1e9  # S/m, of conductivities
    per_area = table["conductance_per_m"] * harmonic_mean
    assert per_area.to_numpy() == pytest.approx(1 / ohm / AREA_M2, rel=1e-12)
    assert table["pressure_Pa"].to_numpy() == pytest.approx(way.force_nN * 1e-9 / AREA_M2)


def test_conductance_over_the_gap_is_the_same_curve(exported):
    """As oofem's S2SThermalContact takes it; the gap rises while the pressure falls."""
    over_pressure = pd.read_csv(exported / "moose/load_1000_conductance.csv")
    over_gap = pd.read_csv(exported / "moose/load_1000_conductance_of_gap.csv")
    assert len(over_gap) > 5
    same = over_pressure.sort_values("gap_m").drop_duplicates("gap_m")
    assert np.array_equal(over_gap, same[["gap_m", "conductance_per_m"]])


def test_a_finite_element_code_takes_the_conductance(exported, monkeypatch):
    """The bar of docs/export.md in scikit-fem, against resistances in series."""
    pytest.importorskip("skfem", reason="scikit-fem of the group dev is not installed")
    page = (ROOT / "docs/export.md").read_text(encoding="utf-8")
    (script,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    monkeypatch.chdir(exported)
    names: dict = {}
    exec(script, names)
    table = pd.read_csv("moose/load_7000_conductance.csv")
    conductance = table["conductance_per_m"] * 30.0
    series = 100.0 / (1e-3 / 30.0 + 1.0 / conductance)
    assert np.array(names["flux"]) == pytest.approx(series.to_numpy(), rel=1e-9)


def test_the_pad_is_exported_from_each_depth(exported, results):
    rows = load_csv(results.root / "pad/curves.csv")
    depths = {row["depth_nm"] for row in rows}
    assert len(list(exported.glob("moose/pad_*.csv"))) == len(depths)
    closing = [row for row in rows if not row["depth_nm"]]
    table = pd.read_csv(exported / "moose/pad_closing.csv")
    net_Pa = [float(row["net_kPa"]) * 1e3 for row in reversed(closing)]
    # net_kPa is a difference of its own; rounding is that of the two pressures in it
    largest = max(abs(float(row["repulsive_MPa"])) for row in closing) * 1e6
    assert table["pressure_Pa"].to_numpy() == pytest.approx(net_Pa, abs=1e-12 * largest)


@pytest.mark.parametrize("name", ["surface.x3p", "surface.gwy"])
def test_a_map_is_read_back_by_surfacetopography(exported, results, name):
    surfaces = pytest.importorskip("SurfaceTopography")
    if not (exported / "maps" / name).exists():
        pytest.skip("made without the extra export")
    surface = surfaces.read_topography(str(exported / "maps" / name)).to_unit("nm")
    heights = results.h5("contact/spots.h5")[0]["spots"]["towards_flat_nm"]
    assert surface.heights() == pytest.approx(heights, rel=1e-14, abs=1e-14)
    assert surface.physical_sizes == pytest.approx((125.0, 125.0))  # 16 of 128 pixels of 1 µm


def test_a_map_is_read_back_by_vtk(tmp_path):
    pytest.importorskip("pyevtk")
    vtk = pytest.importorskip("vtk", reason="optional extra peers is not installed")
    from vtk.util.numpy_support import vtk_to_numpy

    rng = np.random.default_rng(3)
    heights = rng.normal(size=(5, 5))
    reached = np.where(heights > 0, heights * 1e3, np.nan)
    (name,) = write_vtk(tmp_path, ContactMap(7.5, heights, reached))
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(str(tmp_path / name))
    reader.Update()
    image = reader.GetOutput()
    assert image.GetSpacing()[:2] == (7.5, 7.5)
    assert image.GetDimensions() == (6, 6, 2)  # points of 5 x 5 cells
    for field, values in (("towards_flat_nm", heights), ("reached_nN", reached)):
        array = vtk_to_numpy(image.GetCellData().GetArray(field))
        assert np.array_equal(array.reshape(5, 5, order="F"), values, equal_nan=True)


def test_circuits_are_copied(exported):
    assert (exported / "circuit/rough_pad.sub").read_text().startswith(".subckt")


def test_a_scene_without_results_is_refused_in_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("bare.yaml").write_text("extends: table1\nname: bare\n")
    assert main(["bare.yaml", "out"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "asperity run bare.yaml contact" in line
    assert not Path("out").exists()


def test_a_folder_with_files_is_refused_in_one_line(ran, monkeypatch, capsys, tmp_path):
    monkeypatch.chdir(ran)
    (tmp_path / "mine.txt").write_text("mine")
    assert main(["tiny.yaml", str(tmp_path)]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "new or empty" in line


def test_a_scene_without_contact_says_that_it_has_no_maps(ran, tmp_path, monkeypatch, capsys):
    only_pad = tmp_path / "results/tiny/pad"
    only_pad.mkdir(parents=True)
    (only_pad / "curves.csv").write_bytes((ran / "results/tiny/pad/curves.csv").read_bytes())
    (tmp_path / "tiny.yaml").write_text("extends: table1\nname: tiny\n")
    monkeypatch.chdir(tmp_path)
    assert main(["tiny.yaml", "out"]) == 0
    assert "no maps: the contact is not computed" in capsys.readouterr().out
    assert len(list(tables_of(results_in(tmp_path / "results/tiny")))) > 1
