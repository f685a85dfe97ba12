"""How far does another processor move what scene `ci` says, beside its stated errors?

Processors choose kernels of linear algebra that round otherwise. OpenBLAS takes one by name
(`OPENBLAS_CORETYPE`), if the processor has its instructions: Prescott has no AVX, SandyBridge no
fused multiply-add. The whole scene runs once under each, in a folder and with a cache of its own.
"""

import csv
import json
import os
import subprocess
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

Quantities = dict[tuple[str, str], tuple[float, float]]
"""Value and stated error (NaN: none is stated) by name and unit."""


def arguments(parser: ArgumentParser) -> None:
    """Kernels, and where their results are."""
    parser.add_argument("--kernels", nargs="+", default=["Haswell", "SandyBridge", "Prescott"])
    parser.add_argument(
        "--folder", type=Path, required=True, help="of one folder a kernel; what is there is kept"
    )


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each quantity."""
    said = [quantities(_results(given.folder / kernel, kernel)) for kernel in given.kernels]
    for (name, unit), (_, error) in said[0].items():
        values = np.array([of[name, unit][0] for of in said])
        moved = float(np.ptp(values))
        yield {
            "quantity": name,
            "unit": unit,
            "value": float(values[0]),
            "stated_error": error,
            "moved": moved,
            "moved_over_value": moved / abs(float(values[0])),
            "moved_over_error": moved / error,
            "kernels": " ".join(given.kernels),
        }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """The largest move, beside the value and beside the error."""
    of_value = max(float(row["moved_over_value"]) for row in rows)
    of_error = max(float(row["moved_over_error"]) for row in rows)
    return {"of_value": f"{of_value:.1g}", "of_error": f"{of_error:.1g}"}


def _results(folder: Path, kernel: str) -> Path:
    """Results of the scene under a kernel; made where there are none."""
    results = folder / "results" / "ci"
    if not (results / "report.html").exists():
        folder.mkdir(parents=True, exist_ok=True)
        places = {"OPENBLAS_CORETYPE": kernel, "XDG_CACHE_HOME": str(folder / "cache")}
        command = [str(Path(sys.executable).with_name("asperity")), "run", "--cores", "1", "ci"]
        subprocess.run(command, cwd=folder.resolve(), env=os.environ | places, check=True)
    return results


def quantities(results: Path) -> Quantities:
    """What the stages of a chain say."""
    found: Quantities = {}
    for row in _table(results / "hardness/points.csv"):
        half = 0.5 * (float(row["hardness_hi"]) - float(row["hardness_lo"]))
        found[f"hardness, {row['run']}", "GPa"] = (float(row["hardness_GPa"]), half)
    for row in _table(results / "inputs.csv"):
        found |= _of_input(row)
    for row in _table(results / "law/nominal.csv"):
        if row["curve"] == "plastic":
            found |= _of_law(row)
    for row in _table(results / "uncertainty/outputs.csv"):
        for name in ("mean", "dev"):
            error = float(row[f"{name}_seed_sd"])
            found[f"{row['output']}, {name}", row["unit"]] = (float(row[name]), error)
    answer = json.loads((results / "answer/pad_switch.json").read_text(encoding="utf-8"))["answer"]
    for share, volts in answer["release_V"]["quantiles"].items():
        error = answer["quantile_error_V"][share]
        found[f"release, quantile {share}", "V"] = (volts, error)
    pull_in = answer["pull_in_V"]
    of_median = pull_in["std"] / np.sqrt(answer["points"])
    found["pull-in, median", "V"] = (pull_in["quantiles"]["0.5"], float(of_median))
    deviation = answer["release_V"]["std"]
    of_deviation = deviation / np.sqrt(2 * (answer["points"] - 1))
    found["release, deviation", "V"] = (deviation, float(of_deviation))
    return found


def _of_input(row: Mapping[str, str]) -> Quantities:
    """Middle and half width of an input that a stage gave."""
    if row["origin"] == "literature" or row["distribution"] not in ("normal", "uniform"):
        return {}
    a, b = float(row["a"]), float(row["b"])
    middle_and_half = (a, b) if row["distribution"] == "normal" else (0.5 * (a + b), 0.5 * (b - a))
    return {(f"input {row['parameter']}", row["unit"]): middle_and_half}


def _of_law(row: Mapping[str, str]) -> Quantities:
    """Parameters of the law at central inputs, with the errors of their fit."""
    errors = np.sqrt(np.diag(np.array(json.loads(row["covariance"]))))
    names = (("C_a", "GPa_nm"), ("C_r", "GPa"), ("rho_r", "nm"))
    found: Quantities = {}
    for (name, unit), error in zip(names, errors.tolist(), strict=True):
        of_branch = f"{name}, {row['branch']}"
        found[of_branch, unit] = (float(row[f"{name}_{unit}"]), error or float("nan"))
    return found


def _table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(line for line in stream if not line.startswith("#")))
