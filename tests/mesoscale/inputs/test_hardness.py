"""Laws of hardness against contact area, and the inputs that each of them has."""

import numpy as np
import pytest

from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.observables import NAMES, Cycles
from mesoscale.calibration.posterior import Model
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs, contact_of
from mesoscale.inputs.hardness import HardnessLaw
from mesoscale.inputs.table import PAPER_ROWS, collect, input_table
from mesoscale.settings import ContactSettings, InputRow, InputsSettings

FILM = HardnessLaw(h_macro=0.7, h_film=10.5, t_film=5.0, k_film=0.24, m_film=1.2)
AREAS = np.array([4.0, 9.0, 225.0, 1e4])  # nm^2


def rows(**values: float | tuple[float, float]) -> dict[str, InputRow]:
    """Rows of a film on a base, fixed or uniform."""
    given = {"h_film": 10.5, "t_film": 5.0, "k_film": 0.24, "m_film": 1.2} | values
    return {
        name: InputRow(values=value)
        if isinstance(value, tuple)
        else InputRow(distribution="fixed", values=(value,))
        for name, value in given.items()
    }


def test_hardness_goes_from_the_film_to_its_base():
    assert FILM.pressure(1e-12) == pytest.approx(10.5, rel=1e-6)
    assert FILM.pressure(1e20) == pytest.approx(0.7, rel=1e-6)
    assert (np.diff(FILM.pressure(AREAS)) < 0).all()
    half = (5.0 * (1 / 0.24) ** (1 / 1.2)) ** 2  # k (L/t)^m = 1
    assert FILM.pressure(half) == pytest.approx((0.7 + 10.5) / 2)


def test_without_film_it_is_eq_4_and_without_size_effect_constant():
    paper = HardnessLaw(1.95, 8.375)
    np.testing.assert_allclose(paper.pressure(AREAS), 1.95 + 8.375 * AREAS**-0.25)
    np.testing.assert_array_equal(HardnessLaw(1.95).pressure(AREAS), 1.95)
    assert (HardnessLaw(1.95).constant, paper.constant, FILM.constant) == (True, False, False)


@pytest.mark.parametrize("law", [FILM, HardnessLaw(1.95, 8.375), HardnessLaw(2.0)])
def test_half_the_material_s_hardness_is_half_of_every_contact_s(law):
    np.testing.assert_allclose(law.scaled(0.5).pressure(AREAS), 0.5 * law.pressure(AREAS))


def test_a_scene_has_the_inputs_of_its_law_and_computes_no_other():
    names = set(InputsSettings().rows())
    film = InputsSettings(hardness="film", **rows())
    assert set(film.rows()) == names - {"h_prime"} | {"h_film", "t_film", "k_film", "m_film"}
    assert set(InputsSettings(hardness="constant").rows()) == names - {"h_prime"}
    assert "hardness" not in film.origins()
    assert (
        "hardness"
        in InputsSettings(
            hardness="film", **rows() | {"h_film": InputRow(origin="hardness")}
        ).origins()
    )


def test_values_of_a_table_reach_the_contact():
    table = input_table(hardness="film", **rows())
    inputs, _ = contact_of(table.medians(), ContactSettings())
    assert inputs.hardness == FILM._replace(h_macro=table.medians()["h_macro"])
    constant, _ = contact_of(input_table(hardness="constant").medians(), ContactSettings())
    assert constant.hardness.constant


def test_measured_hardness_is_compared_with_the_law_of_the_scene():
    prior = input_table(hardness="film", **rows())
    columns = {"hardness": np.ones(4), "hardness_error": np.ones(4), "area": AREAS}
    data = Measurements("hardness", columns, tuple("abcd"), False, 0.0, "hardness.csv")
    (part,) = (
        Model(prior, Cycles(np.empty((0, 0)), np.empty((0, len(NAMES)))), {}, 7000.0)
        .posterior([data])
        .data
    )
    x = np.array([[getattr(FILM, name, prior.medians()[name]) for name in prior.names]] * 2)
    np.testing.assert_allclose(part.model(x), [FILM.pressure(AREAS)] * 2)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            {"hardness": "film"},
            r"hardness: film needs h_film, hardness of the film \(GPa\); give its row",
        ),
        (rows(), "h_film belongs to hardness: film, but hardness is paper; set h_film to null"),
        (
            {"hardness": "constant", "h_prime": InputRow(values=(2, 15))},
            "h_prime belongs to hardness: paper",
        ),
        ({"h_prime": None}, "hardness: paper needs h_prime"),
    ],
)
def test_a_row_that_is_missing_or_belongs_to_another_law(given, message):
    with pytest.raises(InputError, match=message):
        InputsSettings(**given)


def test_a_film_without_enough_closing_runs_is_refused():
    settings = InputsSettings(hardness="film", **{**PAPER_ROWS, "h_prime": None, **rows()})
    settings = settings.model_copy(update={"h_film": InputRow(origin="hardness")})
    failed = {
        "hardness": {
            "gate": {"passed": False, "reasons": ["2 of 12 runs gave a defended hardness"]}
        }
    }
    with pytest.raises(
        InputError,
        match=r"fit\.json: its gate failed \(2 of 12 runs.*\), so h_film cannot be taken",
    ):
        collect(settings, failed, {"hardness": "hardness/fit.json"})


def test_a_film_softer_than_its_base_is_refused():
    table = input_table(hardness="film", **rows(h_film=0.5))
    with pytest.raises(
        InputError, match=r"h_film = 0.5 GPa on h_macro = 1.95 GPa: accepted are films"
    ):
        contact_of(table.medians(), ContactSettings())


@pytest.mark.parametrize(
    ("film", "words"),
    [
        ({"k_film": 0.3}, "k_film = 0.3 without t_film: a film needs its thickness"),
        ({"h_film": 9.0, "m_film": 1.0}, "h_film = 9, m_film = 1 without t_film"),
        ({"h_film": 9.0, "t_film": 5.0}, "t_film = 5 nm without k_film and m_film"),
    ],
)
def test_a_part_of_a_film_is_refused(film, words):
    with pytest.raises(InputError, match=words):
        ContactInputs(0.215, 91.0, 1.95, 0.0, q0=0.06, hurst=0.75, rms=3.0, **film)
