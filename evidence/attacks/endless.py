"""Does a file that never ends, or unfolds to gigabytes, cost more than a minute?

Scans, containers, tables, scenes and potentials of some hundred bytes to kilobytes, each made to
keep its reader busy.
"""

import io
import json
import random
import resource
import struct
import time
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from atomistic.potentials import load_potential
from evidence.attacks.runs import HANG_S, Attack, campaign_table, figures
from mesoscale.errors import InputError
from mesoscale.tables import foreign_table
from mesoscale.topography.measurements.loading import load_measurements
from workflow.scene import SceneError, load_scene

__all__ = ["campaign", "figures", "rows"]
MOST_MB = 4000.0


def _tiff(rng: random.Random) -> bytes:
    """Pages that lead back to an earlier one, in a circle of one to three."""
    order, pages = rng.choice("<>"), rng.randrange(1, 4)
    content = (b"II" if order == "<" else b"MM") + struct.pack(f"{order}HI", 42, 8)
    for page in range(pages):
        entries = rng.randrange(3)
        following = 8 if page == pages - 1 else len(content) + 2 + 12 * entries + 4
        tags = b"".join(struct.pack(f"{order}HHII", 256 + k, 4, 1, 64) for k in range(entries))
        content += struct.pack(f"{order}H", entries) + tags + struct.pack(f"{order}I", following)
    return content


def _zip(files: dict[str, str | bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return stream.getvalue()


def _aliases(rng: random.Random) -> str:
    """Lists of lists of one list: ten lines that are a billion values."""
    width = rng.randrange(5, 12)
    lines = ["a: &a [x, x]"]
    lines += [
        f"{chr(97 + k)}: &{chr(97 + k)} [{', '.join([f'*{chr(96 + k)}'] * width)}]"
        for k in range(1, 12)
    ]
    return "\n".join(lines)


def _deep(rng: random.Random) -> str:
    return "x: " + rng.choice("[{") * rng.randrange(1000, 200_000)


def _many(rng: random.Random) -> str:
    return "x: [" + "a," * rng.randrange(60_000, 400_000) + "]"


def _tagged(rng: random.Random) -> str:
    tag = rng.choice(("int", "float", "bool", "null", "timestamp", "set", "omap"))
    return f"contact: {{pixels: !!{tag} {rng.choice(('x', '[]', ''))}}}"


def _digits(rng: random.Random) -> str:
    return "contact: {pixels: " + "9" * rng.randrange(4000, 400_000) + "}"


def _xlsx(rng: random.Random) -> bytes:
    cells = "<c r='A1' t='inlineStr'><is><t>1</t></is></c>" * 50
    lines = "".join(f"<row r='{k}'>{cells}</row>" for k in range(1, rng.randrange(20_000, 60_000)))
    book = "<sheets><sheet name='Height' sheetId='1' r:id='rId1'/></sheets>"
    link = (
        "<Relationship Id='rId1' Type='http://{0}/officeDocument/2006/relationships/{1}'"
        " Target='{2}'/>"
    )
    part = (
        "<Override PartName='/xl/{0}.xml'"
        " ContentType='application/vnd.{1}-officedocument.spreadsheetml.{2}+xml'/>"
    )
    home, package = "schemas.openxmlformats.org", "http://schemas.openxmlformats.org/package/2006"
    spaces = (
        f"xmlns='http://{home}/spreadsheetml/2006/main'"
        f" xmlns:r='http://{home}/officeDocument/2006/relationships'"
    )
    parts = {
        "[Content_Types].xml": (
            f"<Types xmlns='{package}/content-types'><Default Extension='rels' "
            "ContentType='application/vnd.openxmlformats-package.relationships+xml'/>"
            + part.format("workbook", "openxmlformats", "sheet.main")
            + part.format("worksheets/sheet1", "openxmlformats", "worksheet")
            + "</Types>"
        ),
        "xl/workbook.xml": f"<workbook {spaces}>{book}</workbook>",
        "xl/worksheets/sheet1.xml": (
            f"<worksheet {spaces}><sheetData>{lines}</sheetData></worksheet>"
        ),
    }
    for name, kind, target in (
        ("_rels/.rels", "officeDocument", "xl/workbook.xml"),
        ("xl/_rels/workbook.xml.rels", "worksheet", "worksheets/sheet1.xml"),
    ):
        parts[name] = (
            "<Relationships"
            f" xmlns='{package}/relationships'>{link.format(home, kind, target)}</Relationships>"
        )
    return _zip(parts)


def _container(rng: random.Random) -> bytes:
    text = rng.choice((_aliases, _deep, _many))(rng)
    return _zip(
        {"meta.yml": text}
        if rng.random() < 0.7
        else {"index.json": "[" * rng.randrange(1000, 10**6)}
    )


def _bomb(rng: random.Random) -> bytes:
    measurements = [
        {"name": "a", "size": [1.0], "datafile": {"original": "a.txt"}}
    ] * rng.randrange(1, 500)
    index = json.dumps({"surfaces": [{"name": "film", "topographies": measurements}]})
    return _zip({"index.json": index, "a.txt": b"0 " * rng.randrange(10**6, 10**7)})


def _claimed(rng: random.Random) -> str:
    """A text that claims many more values than it has, or whose numbers never end."""
    size = 10 ** rng.randrange(3, 12)
    head = f"# Width: 1 m\n# Height: 1 m\n{size} {size}\n"
    return rng.choice((head, "1" * 10**6, "1 " * 10**6, "\n" * 10**6, "1e" * 10**5))


def _sparse(rng: random.Random) -> int:
    return rng.randrange(2, 60) * 2**30


KINDS: dict[str, tuple[int, str, Callable[[random.Random], str | bytes | int]]] = {
    "pages in a circle": (6, ".tiff", _tiff),
    "container of aliases": (40, ".zip", _container),
    "container that unfolds": (20, ".zip", _bomb),
    "spreadsheet that unfolds": (4, ".xlsx", _xlsx),
    "text without end": (20, ".txt", _claimed),
    "sparse scan of gigabytes": (6, ".txt", _sparse),
    "scene of aliases": (20, ".yaml", _aliases),
    "scene of depth": (20, ".yaml", _deep),
    "scene of many values": (10, ".yaml", _many),
    "scene of tags": (30, ".yaml", _tagged),
    "scene of digits": (20, ".yaml", _digits),
    "potential of aliases": (20, ".potential", _aliases),
    "potential of tags": (10, ".potential", _tagged),
    "table of gigabytes": (4, ".csv", _sparse),
}
"""By kind: how many, suffix, and what makes the file: its content, or its size where it is all
zeros.
"""


def arguments(parser: Any) -> None:
    """Options of the study."""
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--share", type=float, default=1.0, help="of the files of each kind")


def rows(given: Any) -> Iterator[dict[str, Any]]:
    """A row for each kind of file."""
    yield from campaign_table(campaign, given.seed, given.share)


def campaign(folder: Path, seed: int, share: float = 1.0) -> Iterator[Attack]:
    """A share of the files of each kind."""
    for kind, (count, suffix, make) in KINDS.items():
        for number in range(max(1, round(count * share))):
            path = folder / f"endless{suffix}"
            content = make(random.Random(f"{seed} {kind} {number}"))
            with path.open("wb") as stream:
                if isinstance(content, int):
                    stream.truncate(content)
                else:
                    stream.write(content.encode() if isinstance(content, str) else content)
            started, used = time.monotonic(), _processor_s()
            outcome, words = _judge(path)
            seconds, clock = _processor_s() - used, time.monotonic() - started
            here = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            if seconds > HANG_S or clock > 3 * HANG_S:  # the machine may be busy
                outcome, words = (
                    "fault",
                    f"{seconds:.0f} s of the processor in {clock:.0f} s; {words}",
                )
            if here > MOST_MB:
                outcome, words = "fault", f"{here:.0f} MB; {words}"
            yield Attack(kind, outcome, seconds, words)
            path.unlink()


def _processor_s() -> float:
    """Seconds of the processor by now, of this process and of those that read."""
    both = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in both)


def _judge(path: Path) -> tuple[str, str]:
    try:
        if path.suffix == ".yaml":
            load_scene(str(path))
        elif path.suffix == ".potential":
            load_potential(path)
        elif path.suffix == ".csv":
            foreign_table(path, str(path))
        else:
            load_measurements(path)
    except (InputError, SceneError) as error:
        line = str(error).replace(f"{path.parent}/", "")
        return (
            ("refused", line)
            if "\n" not in line and len(line) < 1500
            else ("fault", f"long refusal: {line}")
        )
    except Exception as error:
        return "fault", f"{type(error).__name__}: {error}"
    return "used", ""
