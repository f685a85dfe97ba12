"""List the studies, or run one: `python -m evidence [room.name [options]]`."""

import argparse
import ast
import importlib
import os
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before any library starts its threads

from evidence.record import DATA, ROOT, ended, load, record, table_of

RENAMED = {
    "contact.humid": "humidity.opening",
    "pad.beam": "switch.beam",
    "pad.budget": "answer.budget",
    "pad.direct": "answer.direct",
    "pad.loop": "circuit.loop",
    "pad.other_devices": "answer.other_devices",
    "pad.rare_failures": "failure.rare_failures",
    "pad.touch": "switch.touch",
    "pad.two_loops": "failure.two_loops",
}
"""Studies that stood in another room before 0.3.0; the commands of their older rows name that."""


def studies() -> dict[str, str]:
    """Names of all studies with the question that each answers, without importing them."""
    known = {}
    here = Path(__file__).parent
    for path in sorted(here.glob("*/*.py")):
        module = ast.parse(path.read_text(encoding="utf-8"))
        if any(isinstance(node, ast.FunctionDef) and node.name == "rows" for node in module.body):
            known[f"{path.parent.name}.{path.stem}"] = (ast.get_docstring(module) or "").partition(
                "\n"
            )[0]
    return known


def main() -> None:
    """The command line."""
    known, past = studies(), ended()
    if sys.argv[1:] in ([], ["-h"], ["--help"]):
        print(
            "python -m evidence NAME [options]   runs a study and adds its rows to evidence/data/\n"
            "python -m evidence numbers          writes its numbers into the pages of docs/\n"
        )
        for name, question in known.items():
            print(f"{name:<28} {question}\n{'':<28} {_state(name)}")
        for name, study in past.items():
            print(
                f"{name:<28} {study['question']}\n{'':<28} {_state(name)}; its code is at"
                f" {study['commit']}"
            )
        return
    if sys.argv[1:] == ["numbers"]:
        from evidence.pages import write_numbers  # which imports all studies

        write_numbers()
        return
    name = RENAMED.get(sys.argv[1], sys.argv[1])
    options = sys.argv[2:]
    if name in past:
        _run_at(past[name]["commit"], [name, *options])
        return
    if name not in known:
        sys.exit(f"{name}: no such study; `python -m evidence` lists them")
    study = importlib.import_module(f"evidence.{name}")
    parser = argparse.ArgumentParser(prog=f"python -m evidence {name}", description=known[name])
    if hasattr(study, "arguments"):
        study.arguments(parser)
    given = parser.parse_args(options)
    command = f"python -m evidence {shlex.join([name, *options])}"
    print(f"{table_of(name)}: {record(name, study.rows(given), command)} rows added")
    if hasattr(study, "figures"):
        for key, value in study.figures(load(name)).items():
            print(f"{key}: {value}")


def _run_at(commit: str, arguments: list[str]) -> None:
    """Run a study by the code of a commit, and take its table."""
    with tempfile.TemporaryDirectory() as folder:
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "--quiet", "--detach", folder, commit], check=True)
        table = Path("evidence/data") / table_of(arguments[0]).name
        try:
            (Path(folder) / table).write_bytes((DATA / table.name).read_bytes())
            command = [sys.executable, "-m", "evidence", *arguments]
            subprocess.run(command, cwd=folder, env=os.environ | {"PYTHONPATH": folder}, check=True)
            (DATA / table.name).write_bytes((Path(folder) / table).read_bytes())
        finally:
            subprocess.run([*git, "remove", "--force", folder], check=True)


def _state(name: str) -> str:
    """What there is of a study by now."""
    rows = load(name)
    return (
        f"{len(rows)} rows, last of {rows[-1]['date']} at {rows[-1]['commit']}"
        if rows
        else "never run"
    )


if __name__ == "__main__":
    main()
