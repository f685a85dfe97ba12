"""Rules of the calibration, run."""

import csv


def test_priors_are_those_of_the_scene(workflow_in):
    scene = workflow_in.folder / "mine.yaml"
    (workflow_in.folder / "forces.csv").write_text("pull_off_nN,pull_off_error_nN\n200,20\n")
    table = "{kind: pull_off, file: forces.csv}"
    scene.write_text(f"{{measurements: {{tables: [{table}]}}, inputs: {{rms: {{origin: calibration, a: 2, b: 15}}}}}}")
    priors = workflow_in.folder / "results/mine/calibration/priors.csv"
    done = workflow_in.run(str(scene), "results/mine/calibration/priors.csv")
    assert done.returncode == 0, done.stderr
    with priors.open(newline="") as stream:
        rows = {row["parameter"]: row for row in csv.DictReader(stream)}
    assert (rows["rms"]["distribution"], rows["rms"]["a"], rows["rms"]["b"]) == ("uniform", "2.0", "15.0")
