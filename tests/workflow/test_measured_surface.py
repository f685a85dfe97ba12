"""What the page says of a measured surface: doubts stand beside what they touch, names are
short.
"""

import pytest

from workflow.report.measured_surface import doubts, short_names
from workflow.report.page import DoubtNote

DOUBTS = [
    {
        "code": "gap",
        "about": "spectrum",
        "text": "nothing is measured there",
        "remedy": "add scans",
    },
    {"code": "one_place", "about": "rms", "text": "one measurement", "remedy": ""},
]


def test_a_doubt_is_said_about_the_numbers_that_it_touches():
    spectrum, heights = (
        list(doubts({"doubts": DOUBTS}, *about)) for about in (("spectrum",), ("rms", "heights"))
    )
    assert spectrum == [
        DoubtNote("Doubt about spectrum (gap): nothing is measured there. To do: add scans.")
    ]
    assert heights == [DoubtNote("Doubt about rms (one_place): one measurement.")]


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
