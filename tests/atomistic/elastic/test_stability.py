"""Hard cases of a scene's engine, at the least cost; and the numerical choices that a study varies."""

from pathlib import Path

from ase.build import bulk

from atomistic.elastic.accuracy import ensemble_points, volume_points
from atomistic.elastic.networks import crystal
from atomistic.elastic.stability import conductor, stability_checks
from atomistic.materials import load_material
from atomistic.settings import DftSettings, ElasticSettings

NITRIDE_FILE = Path(__file__).parents[3] / "config" / "materials" / "silicon_nitride.yaml"
NITRIDE = load_material(NITRIDE_FILE)
SMALL = DftSettings(basis="gth-szv-molopt-sr", cutoff_Ha=40)


def test_a_metal_is_refused_or_has_no_gap():
    passed, said = conductor(bulk("Al", "fcc", 4.05, cubic=True), SMALL, NITRIDE.part("network_glass"))
    assert passed, said


def test_hard_cases_have_names_of_their_own():
    cell = crystal(NITRIDE, "beta", (1, 1, 1))
    cases = [case for case, *_ in stability_checks(cell, NITRIDE.part("network_glass"), SMALL)]
    assert cases == ["strain of ±10 %", "collapsed cell", "missing atom", "metal"]


def test_errors_are_those_against_the_finest_value_of_each_choice(monkeypatch):
    from atomistic.elastic import accuracy

    monkeypatch.setattr(accuracy, "LARGE_BASIS", "gth-dzvp-molopt-sr")
    monkeypatch.setattr(accuracy, "CUTOFFS", (1.0, 1.4))
    monkeypatch.setattr(accuracy, "TOLERANCES_HA", (1e-4, 1e-6))
    coarse = SMALL.model_copy(update={"cutoff_Ha": 20.0})
    silicon = load_material(NITRIDE_FILE.with_name("silicon.yaml"))
    small = crystal(silicon, "silicon", (1, 1, 1))
    points = list(volume_points(small, crystal(silicon, "silicon", (2, 1, 1)), ElasticSettings(dft=coarse)))
    knobs = {point["knob"] for point in points}
    assert knobs == {"cutoff_Ha", "tolerance_Ha", "basis", "atoms", "strain_range", "strains"}
    finest = {point["knob"]: point["error"] for point in points if point["knob"] != "strain_range"}
    assert set(finest.values()) == {0.0}  # the last value of each is its reference


def test_error_of_the_mean_falls_with_the_number_of_structures():
    errors = [point["error"] for point in ensemble_points([200.0, 210.0, 190.0], 30.0)]
    assert errors[0] > errors[1] > 0
    assert list(ensemble_points([200.0], 10.0)) == []
