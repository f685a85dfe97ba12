"""What instruments measured: files and their formats, levelling, and what each instrument can see."""

import glob
import os
from pathlib import Path


def files_in(path: str | Path) -> list[str]:
    """The files of a folder by name, hidden ones apart; what is no folder is a file itself."""
    if not os.path.isdir(path):  # unlike Path.is_dir, False for a name that is too long
        return [str(path)]
    return sorted(filter(os.path.isfile, glob.glob(f"{glob.escape(str(Path(path)))}/*")))
