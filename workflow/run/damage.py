"""Results that changed after they were made, are of another version, or dated in the future."""

import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

from asperity.guards.foreign_text import shown
from workflow.files.checksums import is_damaged, is_late, recorded

FORMER = ".former"
"""Behind the name of a table of another version, which is kept."""


def made_place(path: Path, results: Path, is_made: Callable[[str], bool]) -> Path | None:
    """What a rule makes of a result file: the file, or a folder that holds it; none where no rule
    makes either.
    """
    folders_above = path.relative_to(results).parents
    places = (path, *(results / folder for folder in folders_above))
    return next((place for place in places if is_made(str(place))), None)


def renew_damaged(results: Path, is_made: Callable[[str], bool], plan: bool) -> None:
    """Delete what is damaged, rename tables of another version and date what is late, before
    Snakemake looks for what is there.

    Parameters
    ----------
    is_made : whether a rule makes the file or the folder of this path; other files stay as they
        are.
    plan : whether nothing is to be changed.
    """
    # needs NumPy; rules are also linted where Snakemake is alone
    from workflow.files.results import has_other_columns

    former = []
    for path in recorded(results):
        place = made_place(path, results, is_made)
        if place is None:
            continue
        if is_damaged(path):
            _say(f"{path}: damaged, it differs from its checksum; a run makes it again")
            if not plan:
                _delete(place)
        elif has_other_columns(path):
            former.append(path)
            if not plan:
                path.replace(path.with_name(path.name + FORMER))
        elif is_late(path):
            _say(f"{path}: dated in the future; a run sets its date")
            if not plan:
                os.utime(path)
    if former:
        more = f" and {len(former) - 1} more" if len(former) > 1 else ""
        _say(
            f"{former[0]}{more}: tables of another version; a run makes them again, and keeps the"
            f" old ones as *{FORMER}"
        )


def _delete(place: Path) -> None:
    """A file, or a folder, all of which its rule makes."""
    if place.is_dir():
        shutil.rmtree(place)
    else:
        place.unlink()


def _say(line: str) -> None:
    print(shown(line), file=sys.stderr)
