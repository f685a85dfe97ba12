"""From inputs through the engine to sensitivities: correlated hardness, and D0 as the eighth
input.
"""

import numpy as np
import pytest

from mesoscale.inputs.table import collect
from mesoscale.settings import ContactSettings, InputRow, UncertaintySettings
from mesoscale.uncertainty import sensitivity
from mesoscale.uncertainty.designs import collocation_runs, random_runs
from mesoscale.uncertainty.propagation import NodeOutputs, propagate
from mesoscale.uncertainty.runs import compute_rows
from mesoscale.uncertainty.sensitivity import sensitivity_rows
from mesoscale.uncertainty.validation import direct_runs_of_rows
from tests.mesoscale import paper

PAPER = paper.INPUTS
CONTACT = ContactSettings(mechanics="asperity", pixels=64)


def law_of(runs, names):
    rows = [{key: str(value) for key, value in row.items()} for row in compute_rows(runs, CONTACT)]
    return direct_runs_of_rows(rows, names, len(rows))


def test_the_correlation_of_the_hardness_fit_reaches_the_engines_inputs():
    fit = {
        "gate": {"passed": True, "reasons": []},
        "inputs": {
            "h_prime": {
                "distribution": "uniform",
                "a": 2.0,
                "b": 15.0,
                "correlation": {"h_macro": -0.7},
            }
        },
    }
    settings = PAPER.model_copy(update={"h_prime": InputRow(origin="hardness")})
    table = collect(settings, {"hardness": fit}, {"hardness": "hardness/fit.json"})
    runs = random_runs(table, 0, 2000)
    pairs = np.array([(run.values["h_macro"], run.values["h_prime"]) for run in runs])
    ranks = pairs.argsort(axis=0).argsort(axis=0)
    # standard error of a correlation of 2000 pairs: 0.02
    assert np.asarray(np.corrcoef(ranks.T))[0, 1] == pytest.approx(-0.7, abs=0.05)


def test_d0_as_eighth_input_moves_the_attraction_alone(monkeypatch):
    for name, count in {"SOBOL_SAMPLES": 128, "SOBOL_RESAMPLES": 3}.items():
        monkeypatch.setattr(sensitivity, name, count)
    table = collect(PAPER.model_copy(update={"gap_cutoff": InputRow(values=(0.165, 0.3))}), {}, {})
    settings = UncertaintySettings(direct_runs=150)
    _, y = law_of(collocation_runs(table, 0, 34), table.names)
    nodes = NodeOutputs([0, 1], y.reshape(2, 17, 8))
    direct = law_of(random_runs(table, 0, 150), table.names)
    result = propagate(nodes, table, settings, direct)
    rows = sensitivity_rows(nodes, table, settings, result.seed_share, {}, {}, direct)
    found = {(row["output"], row["input"]): row for row in rows}
    assert len(found) == 8 * 8
    # C_a falls about fourfold from 0.165 to 0.3 nm
    attraction = found["C_a_GPa_nm", "gap_cutoff"]
    assert attraction["mu_star"] > found["C_a_GPa_nm", "hamaker"]["mu_star"]
    assert attraction["sobol_total"] > 0.1
    assert found["d_c_nm", "gap_cutoff"]["mu_star"] == 0.0
