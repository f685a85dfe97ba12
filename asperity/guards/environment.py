"""The environment of everything that is started: the command, its jobs, the workers of the server.

Python and several packages look for modules and settings in the working folder, and a working
folder may come from a stranger. Here each is told where to look instead. What the user set himself
stays.
"""

import locale
import os
import pwd
import tempfile
from pathlib import Path

from asperity.guards.bundle import ROOT

READ = {
    ".numba_config.yaml": "numba would take settings from it",
    "ucx.conf": "MPI's network layer would take settings, and libraries to load, from it",
    "matplotlibrc": "Matplotlib would take settings, among them programs to start, from it",
    ".snakemake/pip-deployments": "Snakemake would run modules of it",
    # PySCF prefers a file of a basis set's name to its own, and evaluates what stands in it
    "gth-*": "PySCF would take it for a basis set and run what stands in it",
    "ano": "PySCF would take it for a basis set and run what stands in it",
    "minao": "PySCF would take it for a basis set and run what stands in it",
}
"""What packages read of the working folder and cannot be told to leave: a folder that holds one is
refused.
"""


class UnsafeFolder(Exception):
    """The working folder holds settings that a package would read; the message is one line."""


def secure() -> None:
    """Change the environment of this process, which all that it starts inherit.

    Raises
    ------
    UnsafeFolder
    """
    # no module is taken from the working folder or from beside a job's script
    os.environ["PYTHONSAFEPATH"] = "1"
    entries = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    paths = [str(ROOT), *(path for path in entries if os.path.isabs(path))]
    os.environ["PYTHONPATH"] = os.pathsep.join(dict.fromkeys(paths))
    try:
        locale.setlocale(locale.LC_CTYPE, "")
    except locale.Error:  # not installed: each shell of a job would warn of it
        os.environ["LC_ALL"] = "C.UTF-8"
    # in place of `.pyscf_conf.py`, which PySCF would run
    os.environ.setdefault("PYSCF_CONFIG_FILE", str(Path(__file__).with_name("empty_settings")))
    os.environ.setdefault("NUMBA_CACHE_DIR", "")  # beside the code, as without this variable
    _introduce_user()
    if not _writable(Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")):
        cache = _own_cache()
        os.environ["XDG_CACHE_HOME"] = cache
        os.environ.setdefault("MPLCONFIGDIR", cache)
        os.environ["NUMBA_CACHE_DIR"] = os.environ["NUMBA_CACHE_DIR"] or cache
    state = Path(".snakemake")
    if os.path.lexists(state) and not state.is_dir():
        raise UnsafeFolder(
            f"{state}: a file, or a link to nowhere, where a folder belongs; move it away"
        )
    if state.is_dir():
        _check_state(state)
    for name, why in READ.items():
        present = [*Path().glob(name)] if "*" in name else [Path(name)]
        if present and os.path.lexists(present[0]):
            raise UnsafeFolder(f"{present[0]}: {why}; move it away, or work in another folder")


def _introduce_user() -> None:
    """Give a name and a home to a user whom the system does not know, as a container's may be;
    Snakemake would not start.
    """
    try:
        pwd.getpwuid(os.getuid())
    except KeyError:
        os.environ.setdefault("USER", str(os.getuid()))
        if "HOME" not in os.environ:
            os.environ["HOME"] = _own_cache()


def _check_state(path: Path) -> None:
    """See that what Snakemake keeps is no link, and may be read and written."""
    if path.is_symlink():
        raise UnsafeFolder(
            f"{path}: a link to {os.readlink(path)}, to which Snakemake would write; remove it"
        )
    is_folder = path.is_dir()
    if not os.access(path, os.R_OK | os.W_OK | (os.X_OK if is_folder else 0)):
        raise UnsafeFolder(
            f"{path}: may not be read and written; change its permissions, or remove it"
        )
    # packages of other workflows are full of links; no rule here uses them
    if is_folder and path.name not in {"conda", "conda-archive", "singularity", "apptainer"}:
        for entry in path.iterdir():
            _check_state(entry)


def _writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return folder.is_absolute() and os.access(folder, os.W_OK | os.X_OK)


def _own_cache() -> str:
    """A folder of this user alone where the home folder is read-only; the next run finds it
    again.
    """
    folder = Path(tempfile.gettempdir()) / f"asperity-cache-{os.getuid()}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        state = folder.lstat()
        if not folder.is_symlink() and state.st_uid == os.getuid() and state.st_mode & 0o077 == 0:
            return str(folder)
    except OSError:
        pass  # somebody else's
    return tempfile.mkdtemp(prefix="asperity-cache-")
