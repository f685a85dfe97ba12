"""Maps and curves of a scene that has run, for other programs: `asperity export SCENE FOLDER`."""

import argparse
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from asperity.guards.foreign_text import shown, wrapped
from mesoscale.errors import InputError
from mesoscale.extras import MissingExtra
from workflow.export.curves import tables_of, write_comsol, write_moose, write_oofem
from workflow.export.maps import map_of, write_surfaces, write_vtk
from workflow.report.available import Results, results_in
from workflow.scene import SceneError, load_scene
from workflow.schemas import UnfitTable

CIRCUITS = ("answer/rough_pad.sub", "answer/rough_pad.va", "circuit/models/*")


def export(given: str, folder: Path) -> Iterator[str]:
    """Write what a scene has; a line for each part, and for each that it has not.

    Raises
    ------
    InputError : nothing to write is computed, or the folder holds files.
    """
    scene = load_scene(given)
    root = Path("results") / scene.name
    results = results_in(root)
    tables = list(tables_of(results))
    if not tables:
        raise InputError(
            f"{root}: neither a contact nor a pad is computed; first: asperity run {given} contact"
        )
    if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
        raise InputError(f"{folder}: holds files; give a folder that is new or empty")
    folder.mkdir(parents=True, exist_ok=True)
    write_comsol(folder / "comsol", tables)
    write_moose(folder / "moose", tables)
    write_oofem(folder / "oofem_functions.in", tables)
    yield f"comsol, moose, oofem_functions.in: {len(tables)} tables in SI units"
    yield from _write_maps(results, folder / "maps", given)
    yield from _copy_circuits(root, folder / "circuit")


def _write_maps(results: Results, folder: Path, given: str) -> Iterator[str]:
    if not results.has("contact/nominal.h5", "contact/spots.h5"):
        yield f"no maps: the contact is not computed; first: asperity run {given} contact"
        return
    folder.mkdir()
    contact = map_of(results)
    for write in (write_surfaces, write_vtk):
        try:
            yield f"maps: {', '.join(write(folder, contact))}"
        except MissingExtra as error:
            yield f"fewer maps: {error}"


def _copy_circuits(root: Path, folder: Path) -> Iterator[str]:
    files = [file for pattern in CIRCUITS for file in sorted(root.glob(pattern)) if file.is_file()]
    shown_files = [file for file in files if not file.name.startswith(".")]
    if not shown_files:
        return
    folder.mkdir()
    for file in shown_files:
        shutil.copyfile(file, folder / file.name)
    yield f"circuit: {len(shown_files)} models for SPICE and Verilog-A"


def main(arguments: list[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(prog="asperity export", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("folder", type=Path)
    chosen = parser.parse_args(arguments)
    try:
        for line in export(chosen.scene, chosen.folder):
            print(wrapped(shown(line)), flush=True)
    except (InputError, SceneError, UnfitTable, OSError) as error:
        print(f"ERROR {shown(str(error))}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
