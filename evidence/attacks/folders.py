"""Does a planted working folder run, hang or mislead?

Each folder holds one thing that Python, a package, Snakemake or a shell might take for its own. The
command works in it up to the first job, or refuses it in one line. A fault is anything else:
planted code that was run, something written outside the folder, a traceback, a hang, another scene.
"""

import os
import shutil
import stat
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from evidence.attacks.runs import CONTACT, HANG_S, TRACE, Attack, campaign_table, commanded, figures

__all__ = ["campaign", "figures", "rows"]
MODULES = (
    "yaml", "scipy", "numpy", "random", "types", "json", "pickle", "snakemake", "numba", "h5py",
    "pydantic", "asperity",
    "mesoscale", "workflow/__init__", "sitecustomize", "usercustomize", "typing_extensions",
    "psutil", "jinja2",
)  # fmt: skip
BESIDE_A_SCRIPT = ("json", "pickle", "random", "yaml", "csv", "encodings/__init__")
NAMES = (
    "ci #2.yaml", "a: b.yaml", "it's.yaml", 'a "b".yaml', "!x.yaml", "- y.yaml", "n\nl.yaml",
    "$(touch ran).yaml",
    "`touch ran`.yaml", "é\u202e.yaml", "\x1b[31mred.yaml", "{braces}.yaml", "null.yaml",
    "back\\slash.yaml",
    "%41.yaml", "percent:ci.yaml", "*.yaml", "~.yaml",
)  # fmt: skip


def arguments(parser: Any) -> None:
    """Options of the study."""
    parser.add_argument("--every", type=int, default=1, help="take each n-th folder")


def rows(given: Any) -> Iterator[dict[str, Any]]:
    """A row for each kind of folder."""
    yield from campaign_table(campaign, given.every)


def planted() -> Iterator[tuple[str, Callable[[Path, str], object]]]:
    """Kinds of folders with what makes them, from the folder and code that must not run."""
    for name in MODULES:
        yield "module", lambda folder, code, name=name: _write(folder / f"{name}.py", code)
    for name in BESIDE_A_SCRIPT:
        yield (
            "module beside a job's script",
            lambda folder, code, name=name: _write(
                folder / ".snakemake/scripts" / f"{name}.py", code
            ),
        )
    for name in (".pyscf_conf.py", "snakemake_storage_plugin_x.py", ".pythonrc.py", "conftest.py"):
        yield "settings that are code", lambda folder, code, name=name: _write(folder / name, code)
    yield (
        "modules for Snakemake",
        lambda folder, code: _write(
            folder / ".snakemake/pip-deployments/snakemake_storage_plugin_x.py", code
        ),
    )
    for name in ("gth-dzvp-molopt-sr", "ano"):
        yield "basis set that is code", lambda folder, code, name=name: _write(folder / name, code)
    for name, text in (
        (".numba_config.yaml", "disable_jit: 1\ncache_dir: .\n"),
        (".numba_config.yaml", "a: &a [1]\nb: [*a, *a]\n"),
        ("matplotlibrc", "text.usetex: True\nbackend: module://evil\n"),
        ("ucx.conf", "UCX_MODULE_DIR=.\n"),
        ("profiles/default/config.yaml", "cores: 0\nsnakefile: other\n"),
        ("Snakefile", "raise SystemExit(3)\n"),
        ("config.yaml", "scene: paper\n"),
        ("pyproject.toml", "[tool.snakemake]\n"),
        (".git/config", "[core]\n  fsmonitor = touch ran\n"),
        (".env", "PYTHONSTARTUP=x\n"),
    ):
        yield "settings", lambda folder, code, name=name, text=text: _write(folder / name, text)
    results = "results/contact"
    for name in (".lock", ".jobs", ".scene", "scene.yaml"):
        yield (
            "folder for a file",
            lambda folder, code, name=name: (folder / results / name).mkdir(parents=True),
        )
    for name in (results, f"{results}/logs", ".snakemake", "results"):
        yield "file for a folder", lambda folder, code, name=name: _write(folder / name, "x")
    for name in (".lock", ".jobs", ".scene", "logs", "work", "scene.yaml", "inputs.csv"):
        yield (
            "link out",
            lambda folder, code, name=name: _link(
                folder / results / name, folder.with_name("outside")
            ),
        )
    for name in (".snakemake/log", ".snakemake/metadata", ".snakemake/incomplete", ".snakemake"):
        yield (
            "link out",
            lambda folder, code, name=name: _link(folder / name, folder.with_name("outside")),
        )
    for name in (".lock", ".scene", "scene.yaml", "x.csv", ".inputs.csv.sha256"):
        yield "pipe", lambda folder, code, name=name: _pipe(folder / results / name)
    yield (
        "owner with control characters",
        lambda folder, code: _write(folder / results / ".scene", "\x1b[2J\x1b]0;x\x07"),
    )
    yield (
        "record that is no record",
        lambda folder, code: _write(folder / results / ".scene.yaml.sha256", "\x00" * 100),
    )
    yield (
        "metadata that is none",
        lambda folder, code: _write(folder / ".snakemake/metadata/eA==", "{["),
    )
    yield "link to nowhere", lambda folder, code: _link(folder / "results", folder / "nowhere")


def campaign(folder: Path, every: int = 1) -> Iterator[Attack]:
    """The command in each folder, and with each name of a scene."""
    outside = folder / "outside"
    outside.mkdir()
    for number, (kind, plant) in enumerate(planted()):
        if number % every == 0:
            place = folder / f"folder_{number}"
            place.mkdir()
            _write(place / "contact.yaml", CONTACT)
            ran = folder / "ran"
            plant(place, f"open({str(ran)!r}, 'w').close()\n")
            yield _judged(kind, place, "contact.yaml", "contact", outside)
            ran.unlink(missing_ok=True)
            for path in outside.iterdir():
                shutil.rmtree(path) if path.is_dir() else path.unlink()
    for number, name in enumerate(NAMES):
        if number % every == 0:
            place = folder / f"name_{number}"
            place.mkdir()
            _write(place / name, f"name: mine\n{CONTACT}")
            yield _judged("name of a scene", place, name, "mine", outside)


def _judged(kind: str, place: Path, scene: str, results: str, outside: Path) -> Attack:
    target = f"results/{results}/scene.yaml"
    status, said, seconds = commanded(place, "run", "--cores", "1", scene, target)
    made = (
        sorted(path.name for path in (place / "results").glob("*"))
        if (place / "results").is_dir()
        else []
    )
    done = status == 0 and (place / target).is_file() and made == [results]
    refused = status != 0 and any(line.startswith("ERROR ") for line in said.splitlines())
    faults = [
        word
        for word, is_so in (
            (
                "planted code ran",
                (place.with_name("ran")).exists() or bool(list(place.rglob("ran"))),
            ),
            ("written outside", any(outside.iterdir())),
            ("traceback", bool(TRACE.search(said))),
            (
                "control characters",
                "\x1b" in said.replace("\x1b[3", "").replace("\x1b[0m", "").replace("\x1b[1", ""),
            ),
            (f"more than {HANG_S:.0f} s", seconds > 3 * HANG_S),  # of a busy machine
            (f"neither done nor refused: {said[-300:]}", not done and not refused),
        )
        if is_so
    ]
    words = next((line for line in said.splitlines() if line.startswith("ERROR ")), "worked")
    return Attack(
        kind,
        "fault" if faults else "refused" if refused else "used",
        seconds,
        f"{place.name}: {faults or words}",
    )


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def _link(path: Path, target: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.symlink_to(target)


def _pipe(path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    os.mkfifo(path, stat.S_IRUSR | stat.S_IWUSR)
