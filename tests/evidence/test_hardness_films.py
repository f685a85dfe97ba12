"""The samples that scene `reduced` takes are those of the runs of scene `films`."""

import numpy as np

from evidence.hardness.films import SAMPLES, samples


def test_the_shipped_samples_are_those_of_the_runs():
    kept, computed = (
        np.loadtxt(lines, delimiter=",", skiprows=3) for lines in (SAMPLES, samples().splitlines())
    )
    np.testing.assert_allclose(kept, computed, rtol=1e-3)  # four digits
