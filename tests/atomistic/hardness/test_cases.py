from pathlib import Path

import pytest
from atomistic.hardness.studies.cases import load_study

from atomistic.errors import InputError
from atomistic.hardness.runs import planned_runs
from atomistic.settings import HardnessSettings

STUDY = Path(__file__).parents[3] / "config" / "studies" / "hardness.yaml"
SCENE = HardnessSettings()


def written(tmp_path, case):
    path = tmp_path / "study.yaml"
    path.write_text(f"base: {{name: small, tiles: 2, amplitude_nm: 0.4}}\ncases:\n  - {case}\n", encoding="utf-8")
    return path


def test_every_case_plans_one_run():
    for case, own in load_study(STUDY, SCENE).values():
        assert len(planned_runs(own)) == 1, case.name


def test_a_case_changes_what_it_names_and_keeps_the_rest(tmp_path):
    path = written(tmp_path, "{name: slow, about: x, changes: {closing: {speed_m_s: 10}, energy_scales: [0.5]}}")
    scene = HardnessSettings.model_validate({"seeds": [7, 8], "closing": {"base_nm": 3}})
    [(_, own)] = load_study(path, scene).values()
    assert (own.closing.speed_m_s, own.closing.base_nm, own.energy_scales, own.seeds) == (10, 3, (0.5,), (7,))
    assert own.glass == scene.glass


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ("{name: slow, about: x, changes: {closing: {sped_m_s: 10}}}", "closing.sped_m_s: Extra inputs"),
        ("{name: slow, about: x, changes: {closing: {speed_m_s: -1}}}", "closing.speed_m_s: Input should be greater"),
        ("{name: slow}", "cases.0.about: Field required"),
    ],
)
def test_mistakes_are_named(tmp_path, case, words):
    with pytest.raises(InputError, match=words) as found:
        load_study(written(tmp_path, case), SCENE)
    assert "\n" not in str(found.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"none\.yaml: cannot be read"):
        load_study(tmp_path / "none.yaml", SCENE)
