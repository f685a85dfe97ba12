"""Stiff and extreme cases: those of a scene around the middle of Table 1, and more that no scene
has.
"""

from dataclasses import replace

import numpy as np
import pytest

from evidence.contact.draws import MIDDLE, RANGES, draw_inputs
from mesoscale.contact import run_cycle
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings
from mesoscale.studies import contact_stability
from mesoscale.studies.contact_stability import Case, extreme_cases, hard_cases, judge, violations
from mesoscale.studies.driver import stability_rows
from mesoscale.topography.synthesis import synthesize
from tests.mesoscale import paper

N = 48
SETTINGS = {
    mechanics: ContactSettings(mechanics=mechanics, pixels=N, length_nm=96.0)
    for mechanics in ("asperity", "coupled")
}
OWN = {mechanics: extreme_cases(MIDDLE, settings) for mechanics, settings in SETTINGS.items()}


def further_cases(mechanics: str) -> list[Case]:
    # then the separation of the mean planes says when contact is full
    coupled = mechanics == "coupled"
    rough = synthesize(N, 96.0, 0.025, 0.75, 8.5, 1)
    spike, pair = np.zeros((N, N)), np.zeros((N, N))
    spike[N // 2, N // 2] = -5.0
    pair[N // 2, N // 2 - 2 : N // 2 + 3] = -5.0 + 0.5 * np.array([0.0, 1.0, 2.0, 1.0, 0.0])
    light = {"max_force_nN": 0.5}
    cases = [
        Case(
            "profile, H 0.01",
            "slope -1.02",
            replace(MIDDLE, hurst=0.01),
            {"reading": {"convention": "profile"}},
        ),
        Case(
            "nm x 1e-6",
            "heights of picometres and less",
            MIDDLE,
            heights=1e-6 * rough,
            too_much=coupled,
        ),
        Case(
            "nm x 1e6",
            "heights of millimetres on a grid of nanometres",
            MIDDLE,
            heights=1e6 * rough,
        ),
        Case(
            "nm x 100",
            "heights of micrometres on a grid of nanometres",
            MIDDLE,
            heights=100 * rough,
        ),
        Case("single site", "one site above a plane", MIDDLE, light, heights=spike),
        Case(
            "merging pair", "two equal summits with a saddle between", MIDDLE, light, heights=pair
        ),
    ]
    if not coupled:
        return [
            *cases,
            Case("p = 2/3", "reading of eq. 3", MIDDLE, {"reading": {"prefactor": "paper"}}),
            Case("narrow pair", "reading of flow", MIDDLE, {"reading": {"flow_pair": "paper"}}),
        ]
    full = {"model": "elastic", "max_force_nN": 1e12}
    cases.append(
        Case(
            "full elastic contact",
            "closing ends where all sites touch",
            MIDDLE,
            full,
            too_much=True,
        )
    )
    for exponent in range(-3, 4):
        inputs = replace(MIDDLE, e_star=10.0**exponent, h_macro=1.0, h_prime=0.0)
        # softest: the load is beyond full contact
        cases.append(
            Case(
                f"E*/H 1e{exponent}",
                "from never yielding to yielding at once",
                inputs,
                too_much=exponent == -3,
            )
        )
    return cases


ALL = [
    (mechanics, case)
    for mechanics in SETTINGS
    for case in OWN[mechanics] + further_cases(mechanics)
]


@pytest.mark.parametrize(
    ("mechanics", "case"), ALL, ids=[f"{mechanics}: {case.name}" for mechanics, case in ALL]
)
def test_extreme_cases_keep_all_invariants(mechanics, case):
    settings = SETTINGS[mechanics]
    changes = {**settings.model_dump(), **case.changes}
    changes["reading"] = {**settings.reading.model_dump(), **dict(case.changes.get("reading", {}))}
    chosen = ContactSettings(**changes)
    fields = {key: getattr(chosen, key) for key in case.changes}
    broken, _ = judge(replace(case, changes=fields), settings)
    assert broken == []


def test_a_scene_is_tried_at_its_own_inputs_and_settings():
    inputs, settings = (
        replace(MIDDLE, e_star=300.0),
        ContactSettings(mechanics="asperity", pixels=64, length_nm=62.5, retardation_nm=100.0),
    )
    cases = {case.name: case for case in extreme_cases(inputs, settings)}
    assert cases["A_H = 0"].inputs == replace(inputs, hamaker=0.0)
    assert cases["E* / 1000"].inputs.e_star == 0.3
    assert judge(cases["stiffest"], settings)[0] == []


def test_a_case_says_what_broke_and_one_that_raises_has_failed(monkeypatch):
    def judged(case, _):
        if case.name == "hard":
            raise RuntimeError("lost\nits way")
        return ["cycle 1: volume changed"] if case.name == "flat" else [], "no loss"

    told = []
    monkeypatch.setattr(contact_stability, "judge", judged)
    rows = stability_rows(
        hard_cases(MIDDLE, SETTINGS["asperity"]), lambda *given: told.append(given)
    )
    details = {row["case"]: row["detail"] for row in rows if not row["passed"]}
    assert details == {
        "flat": "cycle 1: volume changed; no loss",
        "hard": "RuntimeError: lost its way",
    }
    assert told[-1][0] == 1.0


def test_draws_are_from_table_1():
    rows = paper.INPUTS.rows()
    normal = rows.pop("e_star")
    assert {name: RANGES[name] for name in rows} == {name: row.values for name, row in rows.items()}
    middle, deviation = normal.values
    # 2.895 deviations: the central 99.6 %
    assert RANGES["e_star"] == pytest.approx(
        (middle - 2.895 * deviation, middle + 2.895 * deviation), rel=1e-4
    )


def test_a_gain_of_energy_over_few_points_is_judged_on_a_finer_path():
    """In this draw two asperities merge; 40 steps see the jump at another place on opening than on
    closing.
    """
    inputs, settings = draw_inputs(1160), ContactSettings(mechanics="asperity", pixels=128)
    heights = random_surface(inputs, settings, 3)
    cycle = run_cycle(inputs, settings, 3, heights=heights, contact_at="lowest", keep_surface=True)
    (words,) = violations(cycle, inputs, settings)
    assert words.startswith("energy gained")
    assert violations(cycle, inputs, settings, heights) == []
