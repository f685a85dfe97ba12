from pathlib import Path

import pytest

from atomistic.materials import load_materials, oxide_glasses
from atomistic.potentials import load_potential

CONFIG = Path(__file__).parents[2] / "config"
PMMCS = CONFIG / "potentials" / "pmmcs.yaml"


@pytest.fixture(scope="session")
def potential():
    return load_potential(PMMCS)


@pytest.fixture(scope="session")
def oxides():
    """Materials with an oxide glass by formula."""
    return oxide_glasses(load_materials(CONFIG / "materials").values())
