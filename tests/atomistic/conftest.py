from pathlib import Path

import pytest

from atomistic.potentials import load_potential

PMMCS = Path(__file__).parents[2] / "config" / "potentials" / "pmmcs.yaml"


@pytest.fixture(scope="session")
def potential():
    return load_potential(PMMCS)
