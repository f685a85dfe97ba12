"""The example scene for a user's own scans, on two real ones that are not shipped."""

from pathlib import Path

import pytest

from workflow.results import load_csv, load_h5, load_json

ROOT = Path(__file__).resolve().parents[2]
AFM = ROOT.parent / "shared" / "afm"
SCANS = "scans/first.gwy, scans/second.ibw"


@pytest.mark.skipif(not AFM.is_dir(), reason="real scans are not shipped")
def test_real_scans_to_force_curves_with_one_command(workflow_in):
    example = (ROOT / "config/scenes/own_scans.yaml").read_text()
    assert SCANS in example
    # beside the first line, which names the schema for editors
    assert len(example.splitlines()[1:]) == 7
    scene = workflow_in.folder / "mine.yaml"
    scene.write_text(example.replace(SCANS, f"{AFM / 'example_ps.tiff'}, {AFM / 'di-6.di'}"))
    done = workflow_in.run(str(scene), "press_scans", "curves")
    assert done.returncode == 0, done.stderr
    results = workflow_in.folder / "results/mine"
    found = load_json(results / "topography/parameters.json")
    assert [row["length_nm"] for row in found["scans"]] == pytest.approx([1000.0, 10000.0])
    assert found["description"]["name"] == "measured_heights"  # grainy films, which eq. 9 does not describe
    assert found["gate"]["passed"]
    assert "DOUBT (no_power_law" in done.stdout
    rows = {(row["scan"], row["surface"]): row for row in load_csv(results / "law/scans.csv")}
    assert len(rows) == 6
    assert all(0 < float(row["d_c_nm"]) < 100 and row["converged"] == "True" for row in rows.values())
    groups, _, facts = load_h5(results / "curves/nominal.h5")
    span = found["inputs"]["rms"]
    assert facts["load_7000"]["rms"] == pytest.approx((span["a"] + span["b"]) / 2, rel=1e-6)
    assert (groups["load_7000/closing"]["repulsive_nN"][-1]) == pytest.approx(7000, rel=0.01)
