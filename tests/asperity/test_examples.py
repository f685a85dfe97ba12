"""The example whose picture README shows draws this picture. `make docs` runs all examples."""

import os
import subprocess
import sys
from pathlib import Path

import matplotlib
import pytest
from matplotlib.testing.compare import compare_images
from PIL import Image

DOCS = Path(__file__).parents[2] / "docs"
SHOWN = [
    figure
    for figure in sorted((DOCS / "figures").glob("*.png"))
    if (DOCS / "examples" / f"{figure.stem}.py").is_file()
]
MATPLOTLIB = f"version{'.'.join(matplotlib.__version__.split('.')[:2])}."


@pytest.mark.parametrize("figure", SHOWN, ids=lambda path: path.stem)
def test_a_picture_is_what_its_example_draws(figure, tmp_path):
    example = DOCS / "examples" / f"{figure.stem}.py"
    run = subprocess.run(
        [sys.executable, str(example)],
        cwd=tmp_path,
        env={**os.environ, "MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stderr
    drawn = tmp_path / figure.name
    assert drawn.stat().st_size > 5000
    # other versions of Matplotlib lay it out in other ways
    if MATPLOTLIB in Image.open(figure).info["Software"]:
        assert compare_images(str(figure), str(drawn), tol=5) is None


def test_the_picture_of_the_readme_is_among_them():
    assert "press_film" in [figure.stem for figure in SHOWN]
