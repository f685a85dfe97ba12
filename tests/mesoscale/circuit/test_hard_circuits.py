"""Stiff and extreme switches for simulators, and what tables leave of a pad."""

import numpy as np
import pytest

from mesoscale.answer.points import Point
from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.circuit.tables import curves_of_tables, tables_of
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import ContactSettings
from mesoscale.studies.answer_stability import published_beam
from mesoscale.studies.circuit_stability import hard_cases
from mesoscale.switch.beam import lumped_beam
from tests.mesoscale.circuit.test_tables import pad

VALUES = {
    "hamaker": 0.215,
    "e_star": 91.0,
    "h_macro": 1.95,
    "h_prime": 8.375,
    "q0": 0.025,
    "hurst": 0.75,
    "rms": 8.5,
}
POINT = Point(VALUES, 0.2, published_beam())


def as_pressed(law):
    """The pad without separations below its deepest opening: pressed ones are opened from where
    they end.
    """
    way = law.separation_nm >= law.depth_nm[0] - 1e-9
    return PadCurves(
        law.separation_nm[way], law.closing[:, way], law.depth_nm, law.opening[:, :, way], law.flats
    )


CASES = hard_cases(POINT, ContactSettings(mechanics="asperity", pixels=64), as_pressed(pad()))


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_hard_switches_have_circuits_or_are_refused(case):
    passed, detail = case.judge()
    assert passed, detail


def test_no_hard_circuit_is_left_out():
    assert len(CASES) == 34
    assert len({case.name for case in CASES}) == len(CASES)


@pytest.mark.parametrize("lumps", CIRCUIT.lump_counts)
def test_a_buckled_beam_of_any_number_of_lumps_comes_to_rest(lumps):
    """Short elements near mid-span leave steps of 2e-4 nm by rounding, with which no beam of 48
    came to rest.
    """
    beam = lumped_beam(published_beam(residual_stress_MPa=-60.0), lumps)
    few = lumped_beam(published_beam(residual_stress_MPa=-60.0), 8)
    assert beam.tension_N == pytest.approx(few.tension_N, rel=1e-3)


@pytest.mark.parametrize("cubic", [False, True])
def test_tables_with_more_allowed_errors_are_farther_from_the_curves(cubic):
    law = pad(waves=0.2)
    known = np.isfinite(law.opening)

    def missed(looser):
        made = curves_of_tables(tables_of(law, cubic, looser), law, cubic)
        return np.abs((made.opening - law.opening)[known]).max()

    assert missed(1.0) < missed(10.0) < missed(100.0)
