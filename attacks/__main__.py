"""Run a campaign and add its rows to a table: `python -m attacks scenes|planned|scans|results|kills|disk [options]`."""

import argparse
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from mesoscale.tables import grow_table, load_table

TABLES = Path(__file__).resolve().parent.parent / "docs" / "data"


def _scenes(folder: Path, given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    from attacks.scenes import campaign

    return campaign(folder, given.seed, given.count)


def _planned(folder: Path, given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    from attacks.scenes import planned

    return (planned(folder, seed) for seed in range(given.seed, given.seed + given.count))


def _scans(folder: Path, given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    from attacks.scans import campaign

    attacked = {(row["file"], row["damage"], row["seed"]) for row in given.done}
    return campaign(folder, [Path(name) for name in given.files], given.seed, given.count, attacked)


def _results(folder: Path, given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    from attacks.results import campaign

    return campaign(folder, given.seed, given.count)


def _kills(folder: Path, given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    from attacks.kills import campaign

    return campaign(folder, given.scene, given.count, given.seed)


def _disk(folder: Path, given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    from attacks.full_disk import campaign

    return campaign(folder, given.seed, given.count)


CAMPAIGNS: dict[str, Callable[[Path, argparse.Namespace], Iterator[dict[str, Any]]]] = {
    "scenes": _scenes,
    "planned": _planned,
    "scans": _scans,
    "results": _results,
    "kills": _kills,
    "disk": _disk,
}


def main() -> None:
    """Rows are added as they come, so that a campaign that is cut short has its part."""
    parser = argparse.ArgumentParser(prog="python -m attacks", description=__doc__)
    parser.add_argument("campaign", choices=CAMPAIGNS)
    parser.add_argument("--seed", type=int, help="of the first attack; default: the next of the table; scans: 0")
    parser.add_argument("--count", type=int, default=100, help="attacks; for scans: of each file")
    parser.add_argument("--files", nargs="*", default=(), help="scans: folders of files, beside those that are made")
    parser.add_argument("--scene", choices=("contact", "glass"), default="contact", help="kills: what is killed")
    parser.add_argument("--folder", type=Path, help="where to work and keep the undisturbed runs; default: temporary")
    given = parser.parse_args()
    table = TABLES / f"attacks_{given.campaign}.csv"
    given.done = load_table(table)
    if given.seed is None:
        given.seed = 0 if given.campaign == "scans" else 1 + max((int(row["seed"]) for row in given.done), default=-1)
    outcomes: Counter[str] = Counter()
    with ExitStack() as stack:
        folder = given.folder or Path(stack.enter_context(tempfile.TemporaryDirectory()))
        folder.mkdir(parents=True, exist_ok=True)

        def counted() -> Iterator[dict[str, Any]]:
            for row in CAMPAIGNS[given.campaign](folder.resolve(), given):
                outcomes[str(row.get("outcome", row.get("equal")))] += 1
                yield row

        grow_table(table, counted(), digits=3)
    if not outcomes:
        parser.exit(message=f"{table}: has all of these attacks\n")
    print(f"{table}: {', '.join(f'{count} {outcome}' for outcome, count in sorted(outcomes.items()))}")


if __name__ == "__main__":
    main()
