"""What instruments measured: files and their formats, levelling, and what each instrument can see."""

from pathlib import Path


def files_in(path: str | Path) -> list[str]:
    """The files of a folder by name, hidden ones apart; what is no folder is a file itself."""
    if not Path(path).is_dir():
        return [str(path)]
    return sorted(str(file) for file in Path(path).iterdir() if file.is_file() and file.name[0] != ".")
