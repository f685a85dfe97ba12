"""What instruments measured: files and formats, levelling, and what each instrument can see."""

import glob
import os
from collections.abc import Sequence
from pathlib import Path

from mesoscale.errors import InputError

MOST_FILES = 200
"""Measurements of one surface that are described together: more take minutes, and say no more."""


def files_in(path: str | Path) -> list[str]:
    """The files of a folder by name, hidden ones apart; what is no folder is a file itself."""
    if not os.path.isdir(path):  # unlike Path.is_dir, False for a name that is too long
        return [str(path)]
    return sorted(filter(os.path.isfile, glob.glob(f"{glob.escape(str(Path(path)))}/*")))


def check_count(source: str, files: Sequence[object]) -> None:
    """Refuse more files than are described together.

    Raises
    ------
    InputError
    """
    if len(files) > MOST_FILES:
        raise InputError(
            f"{source}: {len(files)} files; at most {MOST_FILES} are described together: move those"
            " of this surface into a folder of their own, or name some of them"
        )
