"""What are the moduli of amorphous Si3N4 with ions that follow, and what do broken bonds and larger cells change?

The stage scans E(V) with clamped ions; scene `reduced` states the range of Poisson's ratio that was found here. Its
glasses are perfect networks of 28 atoms; `broken_bonds` lets three of 28 atoms lack or exceed their valence, as many as
large melt-quenched models have; `double_glass` has 56 atoms, of which five may.  PBE at 80 Ha, ions and cell at rest.
E* of a scene stands in each of its rows, with Poisson's ratio computed and as the paper takes it. The code for elastic
constants left the stage after `COMMIT`, where the command runs: one to three hours of two cores a scene. There,
`python -m evidence elastic.constants` has beta-Si3N4 beside Brillouin scattering (Vogelgesang et al. 2000): B is 11 %,
G 4 % and E 5 % too small, and ν is 0.27 instead of 0.29.
The first rows were copied from a page, to the digits that it gave; the third glass of 56 atoms was quenched in the box
of its melt.

A universal potential (7net) was tried in place of DFT: B of the glasses agreed, G of the crystals was too soft, of
silicon by a fifth.  E(V) with relaxed ions was tried in place of elastic constants: at strains of 3 % bonds rearrange.
"""

import io
import os
import subprocess
import sys
import tarfile
import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from evidence.record import ROOT
from workflow.files.results import load_csv, load_json

COMMIT = "884b5d7"  # the last release whose elastic stage computes elastic constants
FILMS_GPA = (266.6, 216.0)  # E: the stiffest, doi 10.1109/JMEMS.2004.836815 (30 K), and the softest, Vlassak (1992)


def arguments(parser: ArgumentParser) -> None:
    """Scenes, and what they may use."""
    scenes = ["reduced", "evidence/scenes/broken_bonds.yaml", "evidence/scenes/double_glass.yaml"]
    parser.add_argument("--scenes", nargs="+", default=scenes)
    parser.add_argument("--cores", type=int, default=2)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """Run the elastic stage of each scene as it was at `COMMIT`, and take its isotropic moduli."""
    archive = subprocess.run(["git", "archive", COMMIT], cwd=ROOT, capture_output=True, check=True).stdout
    with tempfile.TemporaryDirectory() as folder:
        with tarfile.open(fileobj=io.BytesIO(archive)) as files:
            files.extractall(folder, filter="data")
        for scene in given.scenes:
            name = scene.rpartition("/")[2].removesuffix(".yaml")
            own = Path(folder) / f"computed_{name}.yaml"
            own.write_text(f"extends: {scene}\nname: computed_{name}\nelastic: {{poisson: computed}}\n")
            command = [sys.executable, "-m", "snakemake", "elastic", "--cores", str(given.cores), "--config"]
            environment = {**os.environ, "PYTHONPATH": folder}
            subprocess.run([*command, f"scene={own}"], cwd=folder, env=environment, check=True)
            results = Path(folder) / "results" / own.stem / "elastic"
            e_star = load_json(results / "e_star.json")
            kept = {
                "e_star_GPa": e_star["mean_GPa"],
                "e_star_std_GPa": e_star["std_GPa"],
                "literature_GPa": e_star["by_literature_poisson"]["mean_GPa"],
                "literature_std_GPa": e_star["by_literature_poisson"]["std_GPa"],
            }
            for row in load_csv(results / "isotropic_moduli.csv"):
                yield {"scene": name, **row, **kept}


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Means and scatter of the glasses of 28 atoms, the difference of those of 56, and E*."""
    used = [row for row in rows if row["ions"] == "relaxed" and not row["flags"]]
    small, large = (
        {key: np.array([float(row[key]) for row in used if row["scene"] == scene]) for key in ("E_GPa", "nu")}
        for scene in ("reduced", "double_glass")
    )
    stiff = [float(row["E_GPa"]) for row in rows if (row["scene"], row["ions"]) == ("reduced", "clamped")]
    first = next(row for row in rows if row["scene"] == "reduced" and row["e_star_GPa"])
    E, error = small["E_GPa"], [part["E_GPa"].std(ddof=1) / np.sqrt(len(part["E_GPa"])) for part in (small, large)]
    return {
        "glasses": str(len(E)),
        "E": f"{E.mean():.0f} ± {E.std(ddof=1):.0f} GPa",
        "nu": f"{small['nu'].mean():.2f} ± {small['nu'].std(ddof=1):.2f}",
        "clamped": f"{100 * (np.mean(stiff) / E.mean() - 1):.0f} %",
        "above_films": " to ".join(f"{100 * (E.mean() / film - 1):.0f}" for film in FILMS_GPA) + " %",
        "larger": f"{large['E_GPa'].mean() - E.mean():+.0f} ± {np.hypot(*error):.0f} GPa",
        "e_star": f"{float(first['e_star_GPa']):.1f} ± {float(first['e_star_std_GPa']):.1f} GPa",
        "literature": f"{float(first['literature_GPa']):.1f} ± {float(first['literature_std_GPa']):.1f} GPa",
    }
