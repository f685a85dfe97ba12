"""What the engine cannot compute is refused; a plausible number would be wrong."""

from pathlib import Path

from ase.build import bulk
from ase.calculators.calculator import CalculationFailed

from atomistic.elastic.dft import PyscfGamma
from atomistic.elastic.networks import no_insulator
from atomistic.elastic.relaxation import last_gap_eV
from atomistic.materials import load_material

NITRIDE = load_material(Path(__file__).parents[3] / "config" / "materials" / "silicon_nitride.yaml")


def test_a_metal_is_refused_or_has_no_gap():
    metal = bulk("Al", "fcc", 4.05, cubic=True)
    metal.calc = PyscfGamma(basis="gth-szv-molopt-sr", cutoff_Ha=40.0)
    try:
        metal.get_potential_energy()
    except CalculationFailed:
        return
    assert no_insulator(last_gap_eV(metal.calc), NITRIDE.part("network_glass"))
