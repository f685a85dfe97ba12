"""What the page says of a measured surface: doubts stand beside what they touch, names are short."""

import pytest

from workflow.report.measured_surface import place_doubts
from workflow.report.page import Doubt, Section, Table, kind
from workflow.report.surface_picture import short_names

DOUBTS = [
    {"code": "gap", "about": "spectrum", "text": "nothing is measured there", "remedy": "add scans"},
    {"code": "one_place", "about": "rms", "text": "one measurement", "remedy": ""},
]


def test_a_doubt_stands_behind_the_numbers_that_it_touches():
    section = Section("topography", "Surface", "")
    section.blocks.append(Table("spectrum", ("q",), []))
    place_doubts({"doubts": DOUBTS}, section, "spectrum")
    section.blocks.append(Table("heights", ("RMS",), []))
    place_doubts({"doubts": DOUBTS}, section, "rms", "heights")
    assert [kind(block) for block in section.blocks] == ["table", "doubt", "table", "doubt"]
    assert section.blocks[1] == Doubt("Doubt about spectrum (gap): nothing is measured there. To do: add scans.")
    assert section.blocks[3] == Doubt("Doubt about rms (one_place): one measurement.")


@pytest.mark.parametrize(
    ("names", "short"),
    [
        (["01_film_afm_1", "01_film_tem"], ["afm_1", "tem"]),
        (["01_film_afm"], ["01_film_afm"]),
        (["01_film", "01_film_2"], ["film", "film_2"]),
        (["a", "b"], ["a", "b"]),
        ([], []),
    ],
)
def test_names_lose_what_all_of_them_begin_with(names, short):
    assert list(short_names(names).values()) == short
