"""Hard cases of a scene's engine, at the least cost; and the numerical choices that a study varies."""

from pathlib import Path

from ase.build import bulk

from atomistic.elastic import studies
from atomistic.elastic.energy_scans import ScanPoint
from atomistic.elastic.networks import crystal
from atomistic.elastic.studies import conductor, ensemble_points, stability_checks
from atomistic.materials import load_material
from atomistic.settings import DftSettings, ElasticSettings

NITRIDE_FILE = Path(__file__).parents[3] / "config" / "materials" / "silicon_nitride.yaml"
NITRIDE = load_material(NITRIDE_FILE)
SMALL = DftSettings(basis="gth-szv-molopt-sr", cutoff_Ha=40)


def test_a_metal_is_refused_or_has_no_gap():
    passed, said = conductor(bulk("Al", "fcc", 4.05, cubic=True), SMALL, NITRIDE.part("network_glass"))
    assert passed, said


def test_hard_cases_have_names_of_their_own():
    cases = [case for case, *_ in stability_checks(NITRIDE, SMALL)]
    assert cases == ["strain of ±10 %", "collapsed cell", "missing atom", "metal"]


def test_errors_are_those_against_the_finest_value_of_each_choice(monkeypatch):
    """Energies of a spring stand for the engine: B is then 100 GPa whatever the choice, but for the cut-off."""

    def scan(atoms, calculator, strains):
        volumes = [float(atoms.get_volume() * (1 + strain) ** 3) for strain in strains]
        stiffness = 1.0 - 10.0 / calculator.parameters.cutoff_Ha
        return [
            ScanPoint(s, v, stiffness * (v - volumes[2]) ** 2, True, 0.0) for s, v in zip(strains, volumes, strict=True)
        ]

    monkeypatch.setattr(studies, "scan_volumes", scan)
    silicon = load_material(NITRIDE_FILE.with_name("silicon.yaml"))
    cells = [crystal(silicon, "silicon", (1, 1, cells)) for cells in (1, 2)]
    points = list(studies.volume_points(*cells, ElasticSettings(dft=SMALL)))
    assert {point["knob"] for point in points} == {"cutoff_Ha", "basis", "largest strain", "atoms"}
    assert {point["knob"]: point["error"] for point in points} == dict.fromkeys(
        ("cutoff_Ha", "basis", "largest strain", "atoms"), 0.0
    )  # the last value of each is its reference
    errors = [point["error"] for point in points if point["knob"] == "cutoff_Ha"]
    assert errors == sorted(errors)
    assert errors[0] < -0.1


def test_error_of_the_mean_falls_with_the_number_of_structures():
    errors = [point["error"] for point in ensemble_points([200.0, 210.0, 190.0], 30.0)]
    assert errors[0] > errors[1] > 0
    assert list(ensemble_points([200.0], 10.0)) == []
