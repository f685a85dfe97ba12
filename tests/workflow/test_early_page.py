"""The page before a run ends shows the switch at central inputs, and says that it is not the last
word.
"""

import numpy as np

from mesoscale.answer.switches import PadModel, Solved
from mesoscale.inputs.table import to_rows
from mesoscale.settings import ContactSettings
from mesoscale.studies.answer_stability import published_beam
from mesoscale.switch import States
from tests.mesoscale.answer.test_release import MIDDLE, SEPARATION, TABLE, pad_of_two
from workflow.files.results import write_csv
from workflow.report.early import STATUS, early_page
from workflow.run.pads import ScenePoints


def test_the_switch_at_central_inputs_has_a_page(tmp_path):
    contact = ContactSettings(mechanics="coupled", attraction="offset")
    points = ScenePoints(TABLE, contact, published_beam(), 2)
    pad = pad_of_two(MIDDLE.pressed(np.full(SEPARATION.size, 0.05), SEPARATION), 0.1)
    states = States(pull_in_V=70.0, release_V=6.0, capacitance_fF=8e3)
    central = PadModel(Solved(points.by_number[0], pad, states, (5.9, 6.1)), points.design, ())
    root = tmp_path / "results/mine"
    write_csv(root / "inputs.csv", to_rows(TABLE))
    scene = {
        "contact": contact.model_dump(mode="json"),
        "device": published_beam().model_dump(mode="json"),
    }
    page = early_page(root, [str(root / "inputs.csv")], central, 1e6, scene)
    assert f"At central inputs the switch lets go at 6.00 V; no interval, because {STATUS}." in page
    assert "could not be drawn" not in page
    assert "by the other one, with three times the work of adhesion" in page
    assert "beam of 510 × 123 µm, bending" in page
    assert "What if the device were another" in page
    assert "From a cell to a pad" not in page  # its curves have no file yet
