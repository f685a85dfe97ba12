"""Files of the user that changed since results were made of them, whatever their dates."""

import ast
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from graphlib import TopologicalSorter
from typing import Any

from workflow.files.checksums import UNREADABLE

MOST_NAMED = 3
CHECKSUM = re.compile(rf"[0-9a-f]{{64}}|{UNREADABLE}")


def changed_files(
    jobs: Iterable[Any], recorded: Callable[[Any], list[str] | None]
) -> dict[str, set[int]]:
    """Files whose content differs from that of which a result was made, with the numbers of the
    jobs that read them.

    Parameters
    ----------
    jobs : Snakemake's, that are to run; some of their parameters are checksums of files by path.
    recorded : parameters, as text, with which a result was made; None where nothing is known.
    """
    changed: dict[str, set[int]] = {}
    for job in jobs:
        now = _checksums(job.params)
        for result in job.output if now else ():
            former = _checksums(_values(recorded(result) or [], now))
            for path in now.keys() & former.keys():
                if now[path] != former[path]:
                    changed.setdefault(path, set()).add(job.jobid)
    return changed


def _checksums(parameters: Iterable[Any]) -> dict[str, str]:
    """Checksums of files by path among the values of parameters."""
    checksums: dict[str, str] = {}
    for value in parameters:
        if isinstance(value, dict) and all(
            CHECKSUM.fullmatch(str(item)) for item in value.values()
        ):
            checksums |= value
    return checksums


def _values(parameters: Iterable[str], paths: Iterable[str]) -> Iterator[Any]:
    """Values of those recorded parameters that name one of these files; Snakemake records their
    text.
    """
    for text in parameters:
        if any(repr(path) in text for path in paths):
            with suppress(ValueError, SyntaxError):  # nan and inf, which settings may have
                yield ast.literal_eval(text)


def renewed_by(readers: Iterable[int], needs: Mapping[int, Iterable[int]]) -> set[int]:
    """Numbers of jobs that wait, over any number of others, for one of `readers`, and these.

    Parameters
    ----------
    needs : numbers of the jobs that each job waits for.
    """
    renewed = set(readers)
    grown = True
    while grown:
        waiting = {number for number, needed in needs.items() if renewed & set(needed)}
        grown = not waiting <= renewed
        renewed |= waiting
    return renewed


def change_lines(
    changed: Mapping[str, Collection[int]],
    needs: Mapping[int, Iterable[int]],
    rules: Mapping[int, str],
    cost: Callable[[Collection[int]], str],
) -> Iterator[str]:
    """A line for files that renew the same jobs: their names, the rules of these jobs, and the
    time.

    Parameters
    ----------
    rules : of each job that is to run, by number.
    cost : words for the time that jobs of these numbers take.
    """
    order = [number for number in TopologicalSorter(needs).static_order() if number in rules]
    groups: dict[frozenset[int], list[str]] = {}
    for path, readers in changed.items():
        groups.setdefault(frozenset(renewed_by(readers, needs)), []).append(path)
    for renewed, paths in groups.items():
        names = [rules[number] for number in order if number in renewed]
        files = "it" if len(paths) == 1 else "them"
        yield (
            f"{_some(paths)}: changed since results were made of {files}; renews"
            f" {_some(list(dict.fromkeys(names)))} (jobs: {len(names)}, {cost(renewed)})"
        )


def _some(words: list[str]) -> str:
    named = ", ".join(words[:MOST_NAMED])
    more = len(words) - MOST_NAMED
    if more <= 0:
        return named
    return f"{named} and {more} more"
