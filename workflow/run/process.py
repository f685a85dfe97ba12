"""Snakemake's process, made ready: its environment, its logging, its signals."""

import logging
import os
import shlex
import signal
import sys
from pathlib import Path
from types import FrameType
from typing import Any

from snakemake.shell import shell

from asperity.guards.environment import UnsafeFolder, secure
from workflow.run import ownership
from workflow.run.refuse import refuse


def prepare_process() -> None:
    """Change the environment for the jobs, which inherit it; before anything imports numba."""
    try:
        secure()
    except UnsafeFolder as error:
        refuse(error)
    if shlex.quote(sys.executable) != sys.executable:
        # Snakemake would not quote it in the commands of jobs
        python = Path(sys.executable)
        os.environ["PATH"] = f"{python.parent}{os.pathsep}{os.environ['PATH']}"
        sys.executable = python.name
    # on a full disk Snakemake's own log cannot be written: no traceback for each line
    logging.raiseExceptions = False
    os.environ[ownership.RUN] = str(os.getpid())  # jobs end with the process that started them


def obey_signals(workflow: Any) -> None:
    """Let Ctrl-C and SIGTERM end a run at once; Snakemake would wait for its jobs."""

    def interrupted(number: int, frame: FrameType | None) -> None:
        """End; what a job has not finished is made again by the next run, as after a kill."""
        if not workflow.local_exec:
            raise KeyboardInterrupt  # Snakemake takes its jobs off the cluster's queue
        print("\ninterrupted; what is finished is kept: run again", file=sys.stderr, flush=True)
        os._exit(128 + number)

    # Ctrl-C is for this process: its jobs end with it, without a word
    shell.prefix("trap '' INT; set -euo pipefail; ")
    signal.signal(signal.SIGINT, interrupted)
    signal.signal(signal.SIGTERM, interrupted)
    # a reader that went away ends the run; Snakemake would lose a job's end and wait for ever
    if workflow.local_exec:
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
