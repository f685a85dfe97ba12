"""What do inputs and counts of the shipped scenes contribute to the error of the release?

Taken from finished scenes, and written to config/contributions.json for scenes that have not run yet. A scene without
results of its closing runs gets the upper bound for them: all of the variance of H′ is taken for scatter between runs.
"""

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from workflow.effort import KNOWN
from workflow.report.available import Results
from workflow.report.contributions import contributions
from workflow.results import load_json

RUNS_A_SEED = 6
"""Closing runs of scene `reduced` with one glass: three sizes, full and halved energies."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Which finished scene."""
    parser.add_argument("scene", help="shipped scene that these results stand for")
    parser.add_argument("results", type=Path, help="folder of results")


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """One row for each contribution."""
    files = [path for path in given.results.rglob("*") if path.suffix in (".json", ".csv")]
    found = contributions(Results(given.results, files, given.scene))
    if found is None:
        raise SystemExit(f"{given.results}: no answer in device/pad_switch.json")
    answer = load_json(given.results / "device/pad_switch.json")["answer"]
    share = next((row["share_of_variance"] for row in answer["sensitivity"] if row["name"] == "h_prime"), 0.0)
    found["variance_V2"].setdefault("hardness.seeds", share * answer["release_V"]["std"] ** 2 / RUNS_A_SEED)
    known = json.loads(KNOWN.read_text(encoding="utf-8")) if KNOWN.is_file() else {}
    known["source"] = "python -m evidence pad.contributions; deviations (V), and variances (V²) of one of each count"
    known["scenes"] = known.get("scenes", {}) | {given.scene: found}
    KNOWN.write_text(json.dumps(known, indent=1) + "\n", encoding="utf-8")
    for kind in ("fixed_V", "variance_V2"):
        yield from (
            {"scene": given.scene, "of": name, "kind": kind, "value": value} for name, value in found[kind].items()
        )
