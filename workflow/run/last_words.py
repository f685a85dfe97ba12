"""What a run says at its end about the results that lie there."""

import shlex
from collections.abc import Callable, Collection, Iterator
from pathlib import Path

from workflow.files.checksums import recorded
from workflow.run.damage import made_place
from workflow.scene.renamed import SINCE, STAGES, place_now

REMOVE = "nothing here reads them; remove them when you need them no more"


def where_results_are(results: Path, studies: Collection[str], scene: str) -> str:
    """The folder of results, its report, and how tables that it lacks come onto it; an older page
    is none.

    Parameters
    ----------
    studies : tables that a run makes only where they are asked for.
    scene : as the user gave it.
    """
    page = results / "report.html"
    if not page.exists():
        return f"results are in {results}"
    made = page.stat().st_mtime
    newer = {path for path in recorded(results) if path != page and path.stat().st_mtime > made}
    if newer - {Path(name) for name in studies}:
        return (
            f"results are in {results}; {page} is older than they are: a run without a target"
            " renews it"
        )
    words = f"results are in {results}; the report is {page}"
    if newer:
        words += f"; it shows the new studies after: asperity run {shlex.quote(scene)} report"
    return words


def foreign_results(results: Path, is_made: Callable[[str], bool]) -> list[str]:
    """Lines on results that no rule of this version makes: folders that have another name now,
    then all others.

    Parameters
    ----------
    is_made : whether a rule makes the file or the folder of this path.
    """
    foreign = [path for path in recorded(results) if made_place(path, results, is_made) is None]
    before = [path for path in foreign if place_now(path.relative_to(results).as_posix())]
    folders = sorted({path.relative_to(results).parts[0] for path in before})
    lines = [f"{results / name} is `{STAGES[name]}` since {SINCE}; {REMOVE}" for name in folders]
    unnamed = [path for path in foreign if path not in before]
    if not unnamed:
        return lines
    subject = f"{unnamed[0]} is a result"
    if len(unnamed) > 1:
        subject = f"{unnamed[0]} and {len(unnamed) - 1} more are results"
    return [
        *lines,
        f"{subject} of another version: nothing here reads or changes them; move away what you do"
        " not need",
    ]


def answer_words(results: Path, since: float, has_scans: bool) -> Iterator[str]:
    """What the measurements show, and the verdict of a page that is newer than `since` (seconds of
    the system clock).
    """
    described = results / "topography" / "parameters.json"
    if described.exists() and (has_scans or described.stat().st_mtime >= since):
        from workflow.run.closing_words import closing_words

        yield from closing_words(results)
        yield ""
    page = results / "report.html"
    if page.exists() and page.stat().st_mtime >= since:
        from workflow.report.available import results_in
        from workflow.report.verdict import verdict

        if answer := verdict(results_in(results)):
            yield answer.sentence
