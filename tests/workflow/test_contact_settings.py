"""What jobs take from the description of the surface: its cell, with the same pressure on it."""

import json
from types import SimpleNamespace

from mesoscale.settings import ContactSettings, SceneContact
from workflow.run.contact_settings import contact_settings
from workflow.scene import Scene

GIVEN = SceneContact(max_force_nN=5000.0).model_dump(mode="json")


def job(folder, described):
    path = folder / "parameters.json"
    path.write_text(json.dumps(described))
    return SimpleNamespace(input={"topography": path})


def test_a_chosen_cell_has_the_pressure_of_the_scene(tmp_path):
    found = contact_settings(GIVEN, job(tmp_path, {"cell_nm": 20_000.0, "surface": {}}))
    assert (found.length_nm, found.max_force_nN) == (20_000.0, 5000.0 * 400)
    surface = {"spectrum": {"q": [1e-4, 1e-3], "psd": [1e9, 1e6]}, "heights": []}
    both = contact_settings(GIVEN, job(tmp_path, {"cell_nm": 20_000.0, "surface": surface}))
    assert (both.length_nm, both.surface.spectrum.q) == (20_000.0, (1e-4, 1e-3))


def test_a_cell_that_the_scene_states_stays(tmp_path):
    assert contact_settings(
        GIVEN, job(tmp_path, {"cell_nm": 1000.0, "surface": {}})
    ) == ContactSettings(**GIVEN)


def test_a_side_follows_the_film_where_a_scene_with_scans_states_none():
    scans = {"topography": {"scans": ["a.gwy"]}}
    assert Scene(**scans).cell_follows_film
    assert not Scene(**scans, contact={"length_nm": 1000.0}).cell_follows_film
    assert not Scene().cell_follows_film
