"""Results that changed after they were made, and results dated in the future."""

import os
import sys
from collections.abc import Callable
from pathlib import Path

from asperity.guards.foreign_text import shown
from workflow.files.checksums import is_damaged, is_late, recorded


def renew_damaged(results: Path, is_made: Callable[[str], bool], plan: bool) -> None:
    """Delete what is damaged and date what is late, before Snakemake looks for what is there.

    Parameters
    ----------
    is_made : whether a rule makes the file of this path; other files stay as they are.
    plan : whether nothing is to be changed.
    """
    for path in recorded(results):
        damaged = is_damaged(path)
        if not (damaged or is_late(path)) or not is_made(str(path)):
            continue
        if damaged:
            _say(f"{path}: damaged, it differs from its checksum; a run makes it again")
        else:
            _say(f"{path}: dated in the future; a run sets its date")
        if plan:
            continue
        if damaged:
            path.unlink()
        else:
            os.utime(path)


def _say(line: str) -> None:
    print(shown(line), file=sys.stderr)
