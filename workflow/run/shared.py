"""Results that another scene in the same folder has made from the same inputs.

A job of hours, such as a closing by molecular dynamics, is done once for all scenes that ask for
it. It is the same where its rule, its settings, the content of its input files, the versions of the
packages and the commit of the code are. Each such job leaves a note beside its log.
"""

import hashlib
import json
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from workflow.files.checksums import is_damaged, record_of
from workflow.files.results import atomic_path

SUFFIX = ".made"


def key_of(provenance: Mapping[str, Any], commit: str) -> str:
    """What decides the results of a job; empty where that is not known, in a changed checkout."""
    if commit.endswith("-dirty"):
        return ""
    words = json.dumps([provenance, commit], sort_keys=True)
    return hashlib.sha256(words.encode()).hexdigest()


def take(log: Path, outputs: Iterable[str], key: str) -> str:
    """Copy the outputs of a job from a scene beside its own that has made them.

    Parameters
    ----------
    log : of the job, results/<scene>/logs/….
    key : by `key_of`.

    Returns
    -------
    The folder of that scene; empty where none has all of them, whole.
    """
    scene_folder = log.parents[1]
    wanted = [Path(output).relative_to(scene_folder) for output in outputs]
    for folder in sorted(scene_folder.parent.iterdir()) if key else ():
        note = _note(folder / log.relative_to(scene_folder))
        if folder == scene_folder or not note.is_file() or note.read_text(encoding="utf-8") != key:
            continue
        try:
            files = [folder / name for name in wanted]
            if not all(record_of(file).is_file() and not is_damaged(file) for file in files):
                continue
            for file, name in zip(files, wanted, strict=True):
                with atomic_path(scene_folder / name) as path:
                    shutil.copyfile(file, path)
        except FileNotFoundError:  # lost, or just being made again there
            continue
        return str(folder)
    return ""


def leave_note(log: Path, key: str) -> None:
    """Note beside the log of a finished job what its results were made from."""
    if key:
        _note(log).write_text(key, encoding="utf-8")  # one that is cut short is no key


def _note(log: Path) -> Path:
    return log.with_suffix(SUFFIX)
