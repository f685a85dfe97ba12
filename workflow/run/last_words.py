"""What a run says at its end about the results that lie there."""

from collections.abc import Callable
from pathlib import Path

from workflow.files.checksums import recorded
from workflow.scene.renamed import SINCE, STAGES, place_now


def foreign_results(results: Path, is_made: Callable[[str], bool]) -> list[str]:
    """Lines on results that no rule of this version makes: folders that are called otherwise now,
    and all others.

    Parameters
    ----------
    is_made : whether a rule makes the file of this path.
    """
    foreign = [path for path in recorded(results) if not is_made(str(path))]
    before = [path for path in foreign if place_now(path.relative_to(results).as_posix())]
    folders = sorted({path.relative_to(results).parts[0] for path in before})
    lines = [
        f"{results / folder} is `{STAGES[folder]}` since {SINCE}: results in it are read by nothing"
        " here and stay as they are; remove them when you need them no more"
        for folder in folders
    ]
    others = [path for path in foreign if path not in before]
    if not others:
        return lines
    subject = f"{others[0]} is a result"
    if len(others) > 1:
        subject = f"{others[0]} and {len(others) - 1} more are results"
    return [
        *lines,
        f"{subject} of another version: nothing here reads or changes them; move away what you do"
        " not need",
    ]
