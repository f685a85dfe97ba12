"""The examples of the documentation run as they stand and save their pictures."""

import os
import subprocess
import sys
from pathlib import Path

import matplotlib
import pytest
from matplotlib.testing.compare import compare_images
from PIL import Image

DOCS = Path(__file__).parents[2] / "docs"
EXAMPLES = sorted((DOCS / "examples").glob("*.py"))
FIGURES = DOCS / "figures"
MATPLOTLIB = f"version{'.'.join(matplotlib.__version__.split('.')[:2])}."


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_draws(example, tmp_path):
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    run = subprocess.run(
        [sys.executable, str(example)],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stderr
    assert (tmp_path / f"{example.stem}.png").stat().st_size > 5000
    shown = FIGURES / f"{example.stem}.png"
    # the picture of README is what the example draws today; other versions of Matplotlib lay it out
    # in other ways
    if shown.exists() and MATPLOTLIB in Image.open(shown).info["Software"]:
        assert compare_images(str(shown), str(tmp_path / shown.name), tol=5) is None
