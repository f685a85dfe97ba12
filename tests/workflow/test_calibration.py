"""Rules of the calibration, run."""

import csv


def test_priors_are_those_of_the_scene(workflow_in):
    done = workflow_in.run("made_up", "results/made_up/calibration/priors.csv")
    assert done.returncode == 0, done.stderr
    with (workflow_in.folder / "results/made_up/calibration/priors.csv").open(newline="") as stream:
        rows = {row["parameter"]: row for row in csv.DictReader(stream)}
    assert rows["rms"]["distribution"] == "uniform"
    assert (float(rows["rms"]["a"]), float(rows["rms"]["b"])) == (2, 15)
