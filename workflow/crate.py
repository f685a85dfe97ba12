"""A run as one file for others: `asperity crate SCENE` packs it, `… FILE.zip` checks it.

The file is a zip archive after Provenance Run Crate 0.5 (Leo et al., PLoS ONE 19 (2024) e0309210):
scene, files that it names, results with checksums, software, and a step for each stage.
"""

import argparse
import datetime
import hashlib
import json
import re
import sys
import zipfile
from collections import defaultdict
from pathlib import Path, PurePosixPath
from typing import Any

from asperity.guards.bundle import ROOT
from asperity.guards.foreign_text import shown, wrapped
from mesoscale.errors import InputError
from mesoscale.extras import MissingExtra, needs
from workflow.files.checksums import file_checksum, is_damaged, recorded
from workflow.report.available import Results, results_in
from workflow.run.cost import TIMES
from workflow.scene import Scene, SceneError, files_of, load_scene, locate
from workflow.scene.loading import lineage

COMPUTED = "computed"  # of the crate: a run of it writes results/, and both can be compared
METADATA = "ro-crate-metadata.json"
PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": "Process Run Crate",
    "https://w3id.org/ro/wfrun/workflow/0.5": "Workflow Run Crate",
    "https://w3id.org/ro/wfrun/provenance/0.5": "Provenance Run Crate",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": "Workflow RO-Crate",
}
TERMS = "https://w3id.org/ro/terms/workflow-run/context"
WALL_SECONDS = "https://w3id.org/ro/terms/workflow-run#wallSeconds"
NO_LICENCE = (
    "Nobody has stated a licence of these inputs and results; ask whoever gave them to you."
)
WORKFLOW_TYPES = ["File", "SoftwareSourceCode", "ComputationalWorkflow", "HowTo"]
LARGEST = 2**33  # bytes of all files of a crate; more are a bomb, or no crate of ours


def pack(given: str, file: Path) -> int:
    """Write the crate of a scene that has run; returns how many results it holds.

    Raises
    ------
    InputError : nothing was computed, a result is damaged, or an input lies elsewhere.
    MissingExtra
    """
    with needs("crate"):
        from rocrate.rocrate import ROCrate
    scene = load_scene(given)
    root = Path("results") / scene.name
    results = list(recorded(root))
    if not results:
        raise InputError(f"{root}: nothing is computed; first: asperity run {given}")
    damaged = next((path for path in results if is_damaged(path)), None)
    if damaged:
        raise InputError(f"{damaged}: differs from its checksum; first: asperity run {given}")
    crate = ROCrate(version="1.1")
    crate.metadata.extra_contexts.append(TERMS)
    crate.name = f"Asperity run of scene {scene.name}"
    crate.description = f"Inputs and results of scene {scene.name}, with the steps between them."
    crate.license = NO_LICENCE
    crate.root_dataset["conformsTo"] = [
        _add(crate, address, "CreativeWork", name=name, version=address.rpartition("/")[2])
        for address, name in PROFILES.items()
    ]
    inputs = [_file(crate, path, place) for path, place in _inputs(scene, given)]
    made = {path: _file(crate, path, f"{COMPUTED}/{path.relative_to(root)}") for path in results}
    _describe_run(crate, results_in(root), scene.name, inputs, made)
    temporary = file.with_suffix(".part")
    crate.write_zip(temporary)
    temporary.replace(file)
    return len(results)


def _inputs(scene: Scene, given: str) -> list[tuple[Path, str]]:
    """The scene and the files that it names, with their places; none that the package ships."""
    named = {"topography.scans": files_of(given, scene.topography.scans)}
    rows = {f"inputs.{name}": row for name, row in scene.inputs.rows().items()}
    for name in scene.device.varied:
        rows[f"device.spread.{name}"] = getattr(scene.device.spread, name)
    for key, row in rows.items():
        if isinstance(row.values, str):
            named[f"{key}.values"] = [row.values]
    for number, table in enumerate(scene.measurements.tables):
        named[f"measurements.tables.{number}.file"] = [table.file]
    places = [(path, path.name) for path in lineage(given) if not _is_shipped(path)]
    for key, names in named.items():
        for name, source in zip(names, locate(given, key, names), strict=True):
            if _is_shipped(Path(source)):
                continue
            place = PurePosixPath(name)
            if place.is_absolute() or ".." in place.parts:
                raise InputError(
                    f"{given}: {key} = {name}: lies elsewhere; copy it beside the scene, and name"
                    " it from there"
                )
            places.append((Path(source), str(place)))
    return places


def _is_shipped(path: Path) -> bool:
    """Whether a file comes with the package, so that every receiver has it."""
    return path.resolve().is_relative_to(ROOT / "config")


def _describe_run(
    crate: Any, results: Results, name: str, inputs: list[Any], made: dict[Path, Any]
) -> None:
    """The workflow with a step, a tool and an action for each stage that has results."""
    versions = results.record["versions"] if (results.root / "scene.yaml").is_file() else {}
    programs = [
        _add(crate, f"#{program}", "SoftwareApplication", name=program, softwareVersion=version)
        for program, version in versions.items()
    ]
    engine = _add(crate, "#engine", "SoftwareApplication", name="Snakemake")
    checksum = file_checksum(ROOT / "workflow/Snakefile")
    workflow = crate.add_workflow(
        ROOT / "workflow/Snakefile",
        "workflow/Snakefile",
        main=True,
        lang="snakemake",
        properties={"@type": WORKFLOW_TYPES, "name": "Asperity", "sha256": checksum},
    )
    stages = defaultdict(list)
    for path in made:
        stages[_stage_of(path.relative_to(results.root))].append(path)
    seconds = _seconds_of(name)
    steps = []
    tools = []
    controls = []
    for position, (stage, paths) in enumerate(sorted(stages.items()), start=1):
        tool = _add(crate, f"#tool-{stage}", "SoftwareApplication", name=f"stage {stage}")
        step = _add(crate, f"#step-{stage}", "HowToStep", position=str(position), workExample=tool)
        usage = [
            _add(
                crate,
                f"#seconds-{rule}",
                "PropertyValue",
                name=f"wall seconds of rule {rule}",
                propertyID=WALL_SECONDS,
                value=str(seconds[rule]),
            )
            for rule in _rules_of(stage)
            if rule in seconds
        ]
        action = crate.add_action(
            tool,
            f"#job-{stage}",
            object=inputs,
            result=[made[path] for path in paths],
            properties={"name": f"stage {stage}", "endTime": _last_change(paths)},
        )
        if usage:
            action["resourceUsage"] = usage
        controls.append(
            _add(crate, f"#control-{stage}", "ControlAction", instrument=step, object=action)
        )
        steps.append(step)
        tools.append(tool)
    workflow["step"] = steps
    workflow["hasPart"] = tools
    workflow["softwareRequirements"] = programs
    run = crate.add_action(
        workflow,
        "#run",
        object=inputs,
        result=list(made.values()),
        properties={"name": f"run of {name}", "endTime": _last_change(list(made))},
    )
    crate.root_dataset["mentions"] = [run]
    _add(crate, "#organize", "OrganizeAction", instrument=engine, object=controls, result=run)


def _add(crate: Any, identifier: str, kind: str, **properties: Any) -> Any:
    """An entity that is no file."""
    from rocrate.model.contextentity import ContextEntity

    entity = crate.add(ContextEntity(crate, identifier, properties={"@type": kind}))
    for name, value in properties.items():
        entity[name] = value
    return entity


def _file(crate: Any, path: Path, place: str) -> Any:
    properties = {"name": place, "sha256": file_checksum(path)}
    return crate.add_file(path, place, properties=properties, record_size=True)


def _stage_of(place: Path) -> str:
    """The stage of a result: its folder; files beside the folders are of few."""
    if place.name == "inputs.csv" and len(place.parts) == 1:
        return "inputs"
    if len(place.parts) == 1 or place.parts[0] == "figures":
        return "report"
    return place.parts[0]


def _rules_of(stage: str) -> list[str]:
    """Rules of a stage, whose seconds a run records."""
    file = ROOT / f"workflow/rules/{stage}.smk"
    if not file.is_file():
        return []
    return re.findall(r"^(?:rule|checkpoint) (\w+):", file.read_text(encoding="utf-8"), re.M)


def _seconds_of(scene: str) -> dict[str, float]:
    """Wall seconds of all jobs of each rule that a scene has run here; none if not recorded."""
    if not TIMES.is_file():
        return {}
    recorded_times = json.loads(TIMES.read_text(encoding="utf-8"))
    return {rule: seconds for rule, (seconds, _) in recorded_times.get(scene, {}).items()}


def _last_change(paths: list[Path]) -> str:
    latest = max(path.stat().st_mtime for path in paths)
    return datetime.datetime.fromtimestamp(latest, datetime.UTC).isoformat(timespec="seconds")


def check(file: Path) -> int:
    """Compare all files of a crate with its checksums; returns how many there are.

    Raises
    ------
    InputError : no crate of ours, or a file was changed, added or taken away.
    """
    try:
        with zipfile.ZipFile(file) as archive:
            return _compare(archive, file)
    except zipfile.BadZipFile as error:
        raise InputError(f"{file}: no sound zip archive ({error}); ask for it again") from None


def _compare(archive: zipfile.ZipFile, file: Path) -> int:
    if sum(entry.file_size for entry in archive.infolist()) > LARGEST:
        raise InputError(f"{file}: unpacks to more than {LARGEST} bytes; not read")
    stated = _stated_checksums(archive, file)
    present = {name for name in archive.namelist() if not name.endswith("/")} - {METADATA}
    for name in sorted(present | stated.keys()):
        if name not in present:
            raise InputError(f"{file}: {name}: is missing; ask for the crate again")
        if name not in stated:
            raise InputError(f"{file}: {name}: was added; ask for the crate again")
        if _checksum(archive, name) != stated[name]:
            raise InputError(f"{file}: {name}: was changed; ask for the crate again")
    return len(stated)


def _checksum(archive: zipfile.ZipFile, name: str) -> str:
    digest = hashlib.sha256()
    with archive.open(name) as stream:
        while part := stream.read(2**20):
            digest.update(part)
    return digest.hexdigest()


def _stated_checksums(archive: zipfile.ZipFile, file: Path) -> dict[str, str]:
    try:
        entities = json.loads(archive.read(METADATA))["@graph"]
        return {entity["@id"]: entity["sha256"] for entity in entities if "sha256" in entity}
    except (KeyError, TypeError, ValueError, RecursionError) as error:
        raise InputError(
            f"{file}: no crate of a run ({type(error).__name__}); asperity crate SCENE writes one"
        ) from None


def main(arguments: list[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(
        prog="asperity crate", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("scene")
    chosen = parser.parse_args(arguments)
    try:
        if chosen.scene.endswith(".zip"):
            count = check(Path(chosen.scene))
            line = f"{chosen.scene}: all {count} files are as they were written"
        else:
            file = Path(f"{load_scene(chosen.scene).name}.crate.zip")
            count = pack(chosen.scene, file)
            line = f"{file}: the scene, its files and {count} results"
    except (InputError, MissingExtra, SceneError, OSError) as error:
        print(f"ERROR {shown(str(error))}", file=sys.stderr)
        return 1
    print(wrapped(shown(line)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
