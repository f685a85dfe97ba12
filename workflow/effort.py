"""Effort follows the answer: counts of a scene that leave its release the least error for a time.

    error² = fixed² + Σ v_k / n_k,   seconds = fixed_s + Σ c_k n_k

The error is the standard deviation of the release over all that is uncertain. No count reduces the part of the inputs.
The least error for a time has n_k ~ sqrt(v_k / c_k) (Neyman, J. R. Stat. Soc. 97 (1934) 558), where no lower limit of
a count is reached. Costs c_k are those of the scene's plan on this machine.

`python -m workflow.effort SCENE` shows the frontier of minutes against error, and writes a scene with the counts.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asperity.foreign_text import as_word, shown, wrapped
from workflow.report.available import Results
from workflow.report.contributions import contributions
from workflow.results import load_json
from workflow.scene import ROOT, Scene, SceneError, load_scene
from workflow.terminal.progress import duration

KNOWN = ROOT / "config" / "contributions.json"
"""Contributions of shipped scenes, by `python -m evidence pad.contributions`: for a scene that has not run."""
RULES = {
    "pad.cells": ("close_cells",),
    "pad.draws": ("close_draws",),
    "hardness.seeds": ("make_glass", "make_counter_glass", "run_closing"),
    "elastic.structures": ("make_amorphous", "relax_amorphous", "scan_volumes", "measure_tensor"),
}
"""The jobs that are more, or longer, where a count is larger."""
LEAST = {"pad.cells": 16, "pad.draws": 16, "hardness.seeds": 1, "elastic.structures": 4}
"""Fewer cells or draws leave the pad's closed form undetermined; fewer glasses fail the gate of E*."""
MOST = 100_000


@dataclass(frozen=True)
class Knob:
    """A count; `seconds` of one core and `variance_V2` are those of one of it."""

    count: int
    least: int
    seconds: float
    variance_V2: float


@dataclass(frozen=True)
class Effort:
    """What counts of a scene cost and leave open.

    Attributes
    ----------
    fixed_V : deviation of the release by cause, which no count reduces.
    fixed_s : seconds of one core of all other jobs.
    """

    knobs: dict[str, Knob]
    fixed_V: dict[str, float]
    fixed_s: float

    @property
    def floor_V(self) -> float:
        """The error that is left at any counts."""
        return float(np.hypot.reduce(list(self.fixed_V.values())))

    def error_V(self, counts: Mapping[str, int]) -> float:
        """Error of the release."""
        return float(np.sqrt(self.floor_V**2 + self.of_counts_V(counts) ** 2))

    def of_counts_V(self, counts: Mapping[str, int]) -> float:
        """The part of it that more of something would reduce."""
        return float(np.sqrt(sum(knob.variance_V2 / counts[key] for key, knob in self.knobs.items())))

    def seconds(self, counts: Mapping[str, int]) -> float:
        """Seconds of one core."""
        return self.fixed_s + sum(knob.seconds * counts[key] for key, knob in self.knobs.items())

    @property
    def least(self) -> dict[str, int]:
        """The smallest counts that a scene can do with."""
        return self._at(0.0)

    def within(self, seconds: float) -> dict[str, int]:
        """Counts of the least error in a time of one core; the smallest where the time is too short for them."""
        low, high = 0.0, 1e9
        for _ in range(100):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.seconds(self._at(middle)) <= seconds else (low, middle)
        return self._at(low)

    def reaching(self, error_V: float) -> dict[str, int] | None:
        """Counts of the least time with an error; None where none has it."""
        scale = np.geomspace(1e-3, 1e9, 4000)
        return next((counts for one in scale if self.error_V(counts := self._at(float(one))) <= error_V), None)

    def _at(self, scale: float) -> dict[str, int]:
        """Counts on the line of the least error, within their limits."""
        wanted = {
            key: min(scale * np.sqrt(knob.variance_V2 / max(knob.seconds, 1e-9)), MOST)
            for key, knob in self.knobs.items()
        }
        return {key: max(knob.least, int(wanted[key])) for key, knob in self.knobs.items()}


def known_contributions(scene: Scene) -> tuple[dict[str, Any], str]:
    """Contributions of a scene, and whose they are: its own of a former run, or of the shipped scene nearest to it."""
    root = Path("results") / scene.name
    if (root / "device/pad_switch.json").is_file():
        files = ("device/pad_switch.json", "hardness/fit.json", "hardness/points.csv", "elastic/e_star.json")
        if contributed := contributions(Results(root, [root / f for f in files if (root / f).is_file()], scene.name)):
            return contributed, f"its last run in {root}"
    known = load_json(KNOWN)["scenes"]
    names = [scene.name, scene.extends or "", "paper" if scene.contact.mechanics == "asperity" else "reduced"]
    name = next(name for name in names if name in known)
    return known[name], f"shipped scene {name}"


def effort_of(scene: Scene, contributed: Mapping[str, Any], seconds: Mapping[str, float]) -> Effort:
    """The effort of a scene.

    Parameters
    ----------
    contributed : as `contributions` gives it.
    seconds : of one core, by rule.
    """
    counts = {
        "pad.cells": scene.pad.cells,
        "pad.draws": scene.pad.draws,
        "hardness.seeds": len(scene.hardness.seeds),
        "elastic.structures": scene.elastic.structures,
    }
    knobs, other = {}, dict(seconds)
    for key, rules in RULES.items():
        if took := sum(other.pop(rule, 0.0) for rule in rules):
            knobs[key] = Knob(counts[key], LEAST[key], took / counts[key], contributed["variance_V2"].get(key, 0.0))
    return Effort(knobs, contributed["fixed_V"], sum(other.values()))


def settings_of(scene: Scene, counts: Mapping[str, int]) -> dict[str, dict[str, Any]]:
    """The keys of a scene with these counts."""
    stated: dict[str, dict[str, Any]] = {}
    for key, count in counts.items():
        section, name = key.split(".")
        stated.setdefault(section, {})[name] = list(range(1, count + 1)) if name == "seeds" else count
    if elastic := stated.get("elastic"):
        parts = ("lda_structures", "tensor_structures")
        elastic |= {name: min(getattr(scene.elastic, name), elastic["structures"]) for name in parts}
    return stated


def planned(scene: str, cores: str) -> tuple[dict[str, float], float, int]:
    """Seconds of one core by rule of a whole run of a scene, those on the cores side by side, and the cores.

    Raises
    ------
    SceneError : Snakemake refuses the scene.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "plan.json"
        command = [sys.executable, "-c", "import snakemake.cli; snakemake.cli.main()", "--snakefile"]
        command += [str(ROOT / "Snakefile"), "--workflow-profile", "none", "--nolock", "--dry-run", "--forceall"]
        command += ["--quiet", "rules", "--cores", cores, "--config", f"scene={as_word(scene)}", f"plan={file}"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if not file.is_file():
            lines = [line.removeprefix("ERROR ") for line in done.stderr.splitlines() if line.startswith("ERROR ")]
            raise SceneError("\n".join(lines) or done.stderr)
        plan = json.loads(file.read_text())
    return plan["seconds"], plan["wall_s"], plan["cores"]


def main() -> None:
    """The command line, behind `asperity run` and `asperity plan`."""
    parser = argparse.ArgumentParser(
        prog="python -m workflow.effort", description="counts of a scene for a time or an error"
    )
    parser.add_argument("scene")
    parser.add_argument("--budget", type=float, help="seconds that the run may take")
    parser.add_argument("--error", type=float, help="error of the release (V)")
    parser.add_argument("--cores", default="all")
    parser.add_argument("--file", help="scene to write; none: only show")
    given = parser.parse_args()
    try:
        scene = load_scene(given.scene)
        seconds, wall_s, cores = planned(given.scene, given.cores)
        print("\n".join(map(wrapped, _choose(given, scene, seconds, wall_s / sum(seconds.values()), cores))))
    except SceneError as error:
        sys.exit("\n".join(f"ERROR {shown(line)}" for line in str(error).splitlines()))


def _choose(
    given: argparse.Namespace, scene: Scene, seconds: Mapping[str, float], share: float, cores: int
) -> Iterator[str]:
    """Choose the counts, write the scene where one is wanted, and say all of it; `share`: wall time over core time."""
    contributed, whose = known_contributions(scene)
    effort = effort_of(scene, contributed, seconds)
    if "pad.draws" not in effort.knobs:
        raise SceneError(f"{given.scene}: pad.draws = 0: without draws there is no interval, and no error to follow")
    if given.budget is not None:
        counts = effort.within(given.budget / share)
        if (least_s := effort.seconds(counts) * share) > 1.001 * given.budget:
            raise SceneError(
                f"{given.scene}: --budget {duration(given.budget)}: the least it takes is {duration(least_s)}"
            )
    else:
        counts = effort.reaching(given.error)
        if counts is None:
            name, part = contributed["largest"]
            raise SceneError(
                f"{given.scene}: --error {given.error:g}V: no budget reaches it: {effort.floor_V:.2g} V are left by "
                f"what no count reduces, {part:.0%} of it by {name}; know that better, or allow more"
            )
    yield f"{scene.name}: error of the release against time on {cores} cores, by {whose}"
    yield f"{'time':>12}  {'error (V)':>9}  {'of counts':>9}  " + "  ".join(effort.knobs)
    now, least_s = effort.seconds(counts), effort.seconds(effort.least)
    for core_s in sorted({least_s, *(least_s * 2**k for k in (1, 2, 3)), now, now + 3600 / share}):
        row = counts if core_s == now else effort.within(core_s)
        mark = " <- chosen" if core_s == now else " <- an hour more" if core_s == now + 3600 / share else ""
        numbers = "  ".join(f"{row[key]:>{len(key)}}" for key in effort.knobs)
        took = duration(effort.seconds(row) * share)
        yield f"{took:>12}  {effort.error_V(row):>9.3f}  {effort.of_counts_V(row):>9.3f}  {numbers}{mark}"
    parts = {key: knob.seconds * counts[key] for key, knob in effort.knobs.items()} | {"all else": effort.fixed_s}
    yield "the time goes to " + ", ".join(f"{key} {part / now:.0%}" for key, part in parts.items())
    yield "no count reduces " + ", ".join(f"{value:.2g} V by {cause}" for cause, value in effort.fixed_V.items())
    if given.file:
        file, stated = Path(given.file), {"extends": given.scene, **settings_of(scene, counts)}
        head = f"{HEAD} {effort.error_V(counts):.3g} V in {duration(now * share)} on {cores} cores"
        if file.is_file() and not file.read_text(encoding="utf-8").startswith(HEAD):
            raise SceneError(f"{file}: not written by --budget or --error; move it away")
        lines = [head, *(f"{key}: {json.dumps(value)}" for key, value in stated.items())]
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
        yield f"{file} is the scene with these counts"


HEAD = "# counts chosen by asperity for an error of"

if __name__ == "__main__":
    main()
