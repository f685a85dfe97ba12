"""The result files a report may show: what exists is read, what does not exist leaves no
section.
"""

import json
from collections.abc import Iterable, Mapping
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numpy as np

from asperity.guards.foreign_yaml import load_mapping
from mesoscale.inputs.table import from_rows
from workflow.files.results import load_csv, load_h5, load_json

COMPUTED = "computed"
CsvRow = dict[str, str]


class Results:
    """Result files of one scene by their path inside `results/<scene>/`.

    Only files named at the start are seen, so that a report depends on its declared inputs and on
    nothing that happens to lie beside them. `at_hand` is the content of JSON and YAML files that
    are not written yet.
    """

    def __init__(
        self,
        root: str | Path,
        paths: Iterable[str | Path],
        scene: str,
        at_hand: Mapping[str, Any] | None = None,
    ) -> None:
        self.root = Path(root)
        self.scene = scene
        self.at_hand = at_hand or {}
        self.paths = {Path(path).relative_to(self.root).as_posix() for path in map(Path, paths)}

    @property
    def beside_paper(self) -> bool:
        """Whether the page compares with the paper: only the scene that repeats the paper does."""
        return self.scene == "paper"

    def has(self, *names: str) -> bool:
        """Are all these files there?"""
        return all(name in self.paths or name in self.at_hand for name in names)

    def matching(self, prefix: str, suffix: str) -> list[str]:
        """Names that begin and end so, sorted."""
        return sorted(
            name for name in self.paths if name.startswith(prefix) and name.endswith(suffix)
        )

    @cache  # noqa: B019 (one object per report)
    def csv(self, name: str) -> list[CsvRow]:
        """Rows of a CSV file."""
        return load_csv(self.root / name)

    def rows(self, name: str) -> list[CsvRow]:
        """Rows of a CSV file; none where it is not there."""
        if not self.has(name):
            return []
        return self.csv(name)

    @cache  # noqa: B019
    def json(self, name: str) -> dict[str, Any]:
        """Content of a JSON file."""
        if name in self.at_hand:
            return self.at_hand[name]
        return load_json(self.root / name)

    def content(self, name: str) -> dict[str, Any]:
        """Content of a JSON file; empty where it is not there."""
        if not self.has(name):
            return {}
        return self.json(name)

    @cached_property
    def record(self) -> dict[str, Any]:
        """What the run depends on: its scene, versions, commit."""
        return self.at_hand.get("scene.yaml") or load_mapping(
            self.root / "scene.yaml", "record of a run"
        )

    @cache  # noqa: B019
    def h5(
        self, name: str
    ) -> tuple[dict[str, dict[str, np.ndarray]], dict[str, Any], dict[str, dict[str, Any]]]:
        """Groups, root attributes and group attributes of an HDF5 file."""
        return load_h5(self.root / name)

    @property
    def contact(self) -> dict[str, Any]:
        """The contact settings that the curves were made with; without curves those that are at
        hand.
        """
        if self.has("contact/nominal.h5"):
            return json.loads(self.h5("contact/nominal.h5")[1]["contact"])
        if not self.at_hand:
            return {}
        return self.record["scene"]["contact"]

    @property
    def coupled(self) -> bool:
        """Whether asperities deform each other's ground."""
        return self.contact.get("mechanics") in ("coupled", "adhesive")

    @property
    def fitted_MPa(self) -> float:
        """Largest pressure of the curves that the law was fitted to."""
        return float(self.json("uncertainty/surrogate.json")["law"]["most_GPa"]) * 1e3

    def uses(self, stage: str) -> bool:
        """Whether an input of this scene comes from the stage."""
        return any(row["origin"] == stage for row in self.rows("inputs.csv"))

    def span_of(self, name: str) -> tuple[float, float] | None:
        """Ends of an input's range; None where the contact of this scene has no such input."""
        rows = [row for row in self.rows("inputs.csv") if row["parameter"] == name]
        if not rows:
            return None
        return from_rows(rows).rows[0].distribution.span()

    def origin_of(self, stage: str) -> str:
        """Badge of a stage: computed or synthetic, and whether this scene uses it."""
        if stage == "topography" and self.json("topography/parameters.json").get("synthetic"):
            return "synthetic"
        if stage in ("hardness", "elastic", "topography") and not self.uses(stage):
            return f"{COMPUTED}, not used: inputs are literature"
        return COMPUTED


def results_in(folder: Path) -> Results:
    """All result files of a folder, for a command that no run schedules; links, pipes and devices
    are left out.
    """
    paths = [
        path
        for path in sorted(folder.rglob("*"))
        if path.suffix in {".csv", ".json", ".h5"}
        and path.relative_to(folder).parts[0] not in {"logs", "work"}
        and path.is_file()
        and not path.is_symlink()
    ]
    return Results(folder, paths, folder.name)
