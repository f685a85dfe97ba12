"""Damaged scans are refused in one line, or give a surface."""

import random

import numpy as np
import pytest

from mesoscale.settings import TopographySettings
from tests.mesoscale.topography.damaged_files import DAMAGES, judge, made_files

SETTINGS = TopographySettings()


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """One file of each format that can be made here."""
    return {path.suffix: path for path in made_files(tmp_path_factory.mktemp("made"))}


@pytest.mark.parametrize("suffix", [".gwy", ".csv", ".asc"])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_damaged_file_is_refused_or_gives_a_surface(files, tmp_path, suffix):
    content = files[suffix].read_bytes()
    faults = []
    for kind, damage in DAMAGES.items():
        path = tmp_path / f"damaged{suffix}"
        path.write_bytes(damage(random.Random(kind), content))
        outcome, words = judge(path, SETTINGS)
        faults += [(kind, words)] if outcome == "fault" else []
    assert faults == []


def test_the_judge_sees_an_exception_and_numbers_that_are_not_finite(files, monkeypatch):
    def broken(path, settings):
        raise KeyError("Miscellaneous")

    monkeypatch.setattr("tests.mesoscale.topography.damaged_files.load_measurements", broken)
    assert judge(files[".gwy"], SETTINGS)[0] == "fault"
    monkeypatch.undo()
    monkeypatch.setattr(
        "tests.mesoscale.topography.damaged_files.record",
        lambda *given: ({"c2": np.array([np.nan])}, {}),
    )
    assert judge(files[".gwy"], SETTINGS) == ("fault", "numbers that are not finite")
