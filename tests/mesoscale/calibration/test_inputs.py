"""Inputs of origin calibration: posteriors with their correlations go on, priors come from
elsewhere.
"""

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.inputs.table import PAPER_ROWS, collect
from mesoscale.settings import InputRow, InputsSettings


def settings(**rows):
    return InputsSettings(**{**PAPER_ROWS, **rows})


CALIBRATED = {
    "h_macro": InputRow(origin="calibration", values=(0.7, 3.2)),
    "h_prime": InputRow(origin="calibration", values=(1.95, 14.8)),
}
RESULT = {
    "gate": {"passed": True, "reasons": []},
    "inputs": {
        "h_macro": {
            "distribution": "samples",
            "a": 1,
            "values": np.linspace(1.4, 1.6, 11),
            "correlation": {"rms": 0.9},
        },
        "h_prime": {
            "distribution": "samples",
            "a": 8,
            "values": np.linspace(7, 9, 11),
            "correlation": {"h_macro": -0.8},
        },
    },
}


def test_posterior_and_its_correlations_are_the_inputs():
    table = collect(
        settings(**CALIBRATED), {"calibration": RESULT}, {"calibration": "posterior.json"}
    )
    samples = dict(zip(table.names, table.sample(4000, 1).T, strict=True))
    assert samples["h_macro"].min() >= 1.4
    assert samples["h_macro"].max() <= 1.6
    assert np.corrcoef(samples["h_macro"], samples["h_prime"])[0, 1] == pytest.approx(
        -0.8, abs=0.05
    )
    # rms keeps its prior, so nothing is correlated with it
    assert np.corrcoef(samples["h_macro"], samples["rms"])[0, 1] == pytest.approx(0, abs=0.06)


def test_priors_are_those_of_the_scene():
    chosen = settings(**CALIBRATED)
    assert chosen.origins() == {"literature", "calibration"}
    table = collect(chosen.priors(), {}, {})
    assert table.sample(4000, 1)[:, table.names.index("h_macro")].max() > 3


def test_a_prior_may_come_from_a_stage():
    chosen = settings(e_star=InputRow(origin="calibration"))
    assert chosen.origins() == {"literature", "calibration", "elastic"}
    assert chosen.priors().rows()["e_star"].origin == "elastic"


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ({"origin": "calibration", "values": (1, 2, 3)}, "none of distribution uniform"),
        ({"origin": "literature"}, "origin literature needs values"),
        ({"origin": "elastic", "values": (1, 2)}, "that stage gives them"),
    ],
)
def test_rows_that_contradict_themselves_are_refused(row, words):
    with pytest.raises(InputError, match=words):
        InputRow(**row)


def test_without_convergence_there_is_no_input():
    failed = {
        "gate": {"passed": False, "reasons": ["the chain has not converged: R-hat 1.2"]},
        "inputs": {},
    }
    with pytest.raises(InputError, match="has not converged"):
        collect(settings(**CALIBRATED), {"calibration": failed}, {"calibration": "posterior.json"})
