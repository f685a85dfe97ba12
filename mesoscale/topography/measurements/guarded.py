"""A stranger's file is read in a process of its own, with limits of time and memory.

Readers of 40 formats meet files that point at themselves, unfold to gigabytes, or fill the terminal
with warnings. The process is a fork, which costs some milliseconds and needs no second import of
the readers.
"""

import multiprocessing
import os
import resource
import signal
import sys
import tempfile
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NoReturn

from mesoscale.errors import InputError

CPU_S, MEMORY_MB = 8.0, 2000.0
"""What the smallest file may take."""


def guarded(path: Path, read: Callable[[], Any]) -> Any:
    """What `read` returns, from a process with limits; without fork, from this process.

    Raises
    ------
    InputError : that of `read`; its limits are reached, or it fails otherwise.
    """
    if sys.platform != "linux":
        return read()
    size_MB = path.stat().st_size / 2**20
    if size_MB > 4000:
        raise InputError(f"{path}: {size_MB:.0f} MB; at most 4000 MB are accepted: crop the scan")
    # measured: 6 s and 2.6 GB for a map of 8192² pixels (512 MB), 9 s and 0.8 GB for one of 4096²
    # as text (147 MB)
    cpu_s = min(CPU_S + size_MB, 50.0)
    memory_MB = min(MEMORY_MB + 20.0 * size_MB, 16000.0)
    # ours: the process may be killed
    with tempfile.TemporaryDirectory(prefix="asperity-") as folder:
        receiver, sender = multiprocessing.Pipe(duplex=False)
        child = os.fork()  # not multiprocessing.Process, which a worker of a pool may not start
        if child == 0:
            _in_child(read, sender, folder, cpu_s, memory_MB)
        sender.close()
        with receiver:
            outcome, result = "slow", None
            try:
                if receiver.poll(3.0 * cpu_s):  # by the clock: the machine may be busy
                    outcome, result = receiver.recv()
            except EOFError:  # ended by a limit or by a fault of a reader
                outcome = "ended"
            finally:
                if outcome == "slow":  # or this process is interrupted
                    os.kill(child, signal.SIGKILL)
                status = os.waitpid(child, 0)[1]
        if outcome == "ended" and os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU:
            outcome = "slow"
    if outcome == "read":
        return result
    if outcome == "refused":
        raise InputError(result)
    reason = {
        "memory": f"reading it needs more than {memory_MB:.0f} MB",
        "slow": f"reading it takes more than {cpu_s:.0f} s",
        "failed": f"its reader failed: {result}",
        "ended": "its reader ended without a word",
    }[outcome]
    raise InputError(
        f"{path}: {reason}; the file may be damaged or made to do so: save it again (.gwy)"
    )


def _in_child(
    read: Callable[[], Any], pipe: Connection, folder: str, cpu_s: float, memory_MB: float
) -> NoReturn:
    """Read, answer and end, without what the forked process would do at its end."""
    try:
        _limit(folder, cpu_s, memory_MB)
        pipe.send(("read", read()))
    except InputError as error:
        pipe.send(("refused", str(error)))
    except MemoryError:
        pipe.send(("memory", None))
    except BaseException as error:  # readers of foreign formats fail in many ways
        pipe.send(("failed", " ".join(f"{type(error).__name__}: {error}".split())[:200]))
    finally:
        os._exit(0)


def _limit(folder: str, cpu_s: float, memory_MB: float) -> None:
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nothing, stream)
    sys.stdout = sys.stderr = os.fdopen(nothing, "w")  # a notebook's go elsewhere
    tempfile.tempdir = folder
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    limits = (
        (resource.RLIMIT_AS, used + int(memory_MB * 2**20)),
        (resource.RLIMIT_CPU, int(cpu_s) + 1),
        (resource.RLIMIT_FSIZE, 600 * 2**20),  # a container is unpacked while it is read
        (resource.RLIMIT_CORE, 0),
    )
    for limit, value in limits:
        hard = resource.getrlimit(limit)[1]
        if hard != resource.RLIM_INFINITY:
            value = min(value, hard)
        resource.setrlimit(limit, (value, hard))
