"""Does hardness fall as the contact grows?

The closing runs of a scene: `sizes` takes asperities of one shape to the end of their window,
`reduced` stops them once their plateau is known, `oxide_on_oxide` pressed them by controlled force
against titania, which the stage did until commit 884b5d7.  Runs of one shape are alike where the
contact is 0.5 to 0.6 wavelengths wide, whatever their size: the columns `same_shape`.

The rows of 2026-11-23 were not made by this command.  They were copied, rounded, from the page that
the runs were first written up on; the runs' own files are lost.  Their `same_shape_length_nm` is
the middle of the range, 0.55 wavelengths, not a measured length, so the exponents of these rows are
approximate and have no interval.  With the measured lengths that page gave -0.30 [-0.41, -0.19] at
full energies (nine runs, wavelengths up to 8.5 nm) and -0.19 [-0.29, -0.08] at halved ones (ten
runs).  The two largest runs at full energies are of glasses made on another processor.
"""

import os
import subprocess
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from evidence.record import ROOT, load_table

COLUMNS = (
    "energy_scale", "wavelength_nm", "seed", "status", "contact_length_nm", "hardness_GPa",
    "hardness_lo",
    "hardness_hi", "same_shape_length_nm", "same_shape_GPa",
)  # fmt: skip


def arguments(parser: ArgumentParser) -> None:
    """The scene, which may take 16 hours of one core."""
    parser.add_argument("scene", nargs="?", default="sizes", help="name, or file")
    parser.add_argument("--cores", type=int, default=os.cpu_count())


def rows(given: Namespace) -> Iterator[dict]:
    """Run the scene and gather its points."""
    name = given.scene.rpartition("/")[2].removesuffix(".yaml")
    command = ["snakemake", "--cores", str(given.cores), "--config", f"scene={given.scene}"]
    target = f"results/{name}/hardness/fit.json"
    subprocess.run([sys.executable, "-m", *command, "--", target], cwd=ROOT, check=True)
    for point in load_table(ROOT / "results" / name / "hardness" / "points.csv"):
        yield {"scene": name, **{column: point[column] for column in COLUMNS}}


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """n of H ~ L^-n at one shape, hardness of the scenes, halved over full energies."""
    found = {}
    for name, scale in (("full", "1"), ("halved", "0.5")):
        of_scale = [row for row in rows if float(row["energy_scale"]) == float(scale)]
        length, stress = (
            np.array(
                [float(row[f"same_shape_{key}"]) for row in of_scale if row["scene"] == "sizes"]
            )
            for key in ("length_nm", "GPa")
        )
        found[f"n_{name}"] = f"{-np.polyfit(np.log(length), np.log(stress), 1)[0]:.2f}"
        for scene in ("reduced", "oxide_on_oxide"):
            hardness = [float(row["hardness_GPa"]) for row in of_scale if row["scene"] == scene]
            found[f"{scene}_{name}"] = f"{min(hardness):.1f} to {max(hardness):.1f} GPa"
    return found
