"""Results that changed after they were made, and results dated in the future."""

import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

from asperity.guards.foreign_text import shown
from workflow.files.checksums import is_damaged, is_late, recorded


def made_place(path: Path, results: Path, is_made: Callable[[str], bool]) -> Path | None:
    """What a rule makes of a result file: the file, or a folder that holds it; none where no rule
    makes either.
    """
    folders_above = path.relative_to(results).parents
    places = (path, *(results / folder for folder in folders_above))
    return next((place for place in places if is_made(str(place))), None)


def renew_damaged(results: Path, is_made: Callable[[str], bool], plan: bool) -> None:
    """Delete what is damaged and date what is late, before Snakemake looks for what is there.

    Parameters
    ----------
    is_made : whether a rule makes the file or the folder of this path; other files stay as they
        are.
    plan : whether nothing is to be changed.
    """
    for path in recorded(results):
        damaged = is_damaged(path)
        if not (damaged or is_late(path)):
            continue
        place = made_place(path, results, is_made)
        if place is None:
            continue
        if damaged:
            _say(f"{path}: damaged, it differs from its checksum; a run makes it again")
        else:
            _say(f"{path}: dated in the future; a run sets its date")
        if plan:
            continue
        if not damaged:
            os.utime(path)
        elif place.is_dir():
            shutil.rmtree(place)  # its rule makes all of it
        else:
            path.unlink()


def _say(line: str) -> None:
    print(shown(line), file=sys.stderr)
