"""Results of the library sent through a pickle, as to another process or into a cache."""

import dataclasses
import pickle

import numpy as np
import pytest
from pydantic import BaseModel

import asperity as asp
from asperity import film as films

SIDE_NM = 125.0
INPUTS = asp.ContactInputs(0.215, 91.0, 1.95, 8.375, q0=0.1, hurst=0.7, rms=2.0)
SETTINGS = asp.ContactSettings(
    mechanics="asperity", pixels=32, length_nm=SIDE_NM, max_force_nN=200.0
)
HEIGHTS = asp.random_surface(INPUTS, SETTINGS, 1)


def simulated():
    """Laws of three samples, without their computation."""
    law = asp.Law(*np.ones((4, 3)), hamaker=np.ones(3))
    return asp.MonteCarlo({"rms": np.ones(3)}, law, law, failed=("why",))


def switch():
    """A switch as `FilmContact.switch` returns it, without its pad."""
    states = {"release_V": 7.0, "pull_in_V": 60.0}
    gate = {"passed": True, "reasons": []}
    return asp.Switch({"central": states, "cells_computed": 8, "gate": gate})


def film():
    """A film of heights of one's own."""
    return asp.Film(asp.Scan(HEIGHTS, (SIDE_NM, SIDE_NM), "own"), line_alignment="none")


def film_contact():
    """A contact as `Film.press` returns it, with less to compute."""
    cycle = asp.run_cycle(INPUTS, SETTINGS, 1)
    pad = films.partial(films.film_table, asp.input_table(), {})
    return asp.FilmContact(INPUTS, SETTINGS, cycle, HEIGHTS, HEIGHTS, _pad=pad, on_grid=SETTINGS)


RESULTS = {
    "Cycle": lambda: asp.run_cycle(INPUTS, SETTINGS, 1),
    "PressedMap": lambda: asp.press(HEIGHTS, SIDE_NM, [50.0, 100.0], 91.0),
    "Roughness": lambda: asp.roughness(HEIGHTS, SIDE_NM),
    "MonteCarlo": simulated,
    "Film": film,
    "FilmContact": film_contact,
    "Switch": switch,
    "InputTable": asp.input_table,
    "Scan": lambda: asp.Scan(HEIGHTS, (SIDE_NM, SIDE_NM), "own"),
    "ContactSettings": lambda: SETTINGS,
    "InputRow": lambda: asp.InputRow(values=(1.0, 2.0)),
}


def facts(thing):
    """What an object holds, as plain Python."""
    if isinstance(thing, np.ndarray):
        return thing.dtype.str, thing.shape, thing.tobytes()
    if isinstance(thing, BaseModel):
        return thing.model_dump()
    if isinstance(thing, films.partial):
        return [thing.func, *map(facts, thing.args)]
    if isinstance(thing, dict):
        return {name: facts(value) for name, value in thing.items()}
    if isinstance(thing, (list, tuple)):
        return [facts(value) for value in thing]
    if dataclasses.is_dataclass(thing) or hasattr(thing, "__dict__"):
        return type(thing), facts(vars(thing))
    return repr(thing)


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_is_the_same_after_a_pickle(name):
    result = RESULTS[name]()
    assert type(result).__name__ == name
    again = pickle.loads(pickle.dumps(result))
    assert facts(again) == facts(result)
    assert repr(again) == repr(result)


def test_every_public_result_is_tried():
    """All public classes but mistakes, and those that are inside of others here."""
    classes = {name for name in asp.__all__ if isinstance(getattr(asp, name), type)}
    others = {"InputError", "MissingExtra", "Branch", "Law", "ContactInputs"}
    settings = {"DeviceSettings", "PadSettings", "TopographySettings"}
    assert classes - others - settings == RESULTS.keys()
