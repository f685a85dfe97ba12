"""Names of before 0.3.0 and what they are now, so that one line says it to whoever still uses
them.
"""

from pathlib import PurePosixPath

SINCE = "0.3.0"
STAGES = {
    "calibrate": "calibration",
    "curves": "contact",
    "device": "answer",
    "uq": "uncertainty",
}
"""Targets, and folders of results where the stage had one."""
SCENES: dict[str, str] = {}
TAILS = {"pad": "switch"}
MOVED = {
    "device/failure.json": "failure/failure.json",
    "device/failure.csv": "failure/failure.csv",
    "device/circuit.json": "circuit/circuit.json",
    "device/circuit.csv": "circuit/circuit.csv",
    "device/circuit": "circuit/models",
    "device/loop.csv": "circuit/loop.csv",
    "device/humidity.csv": "humidity/humidity.csv",
    "curves/runs": "law/runs",
}
"""Results that went elsewhere than the others of their folder."""


def name_now(name: str, names: dict[str, str]) -> str:
    """The line on a name that is another one now; empty where it is none of before."""
    if name not in names:
        return ""
    return f"`{name}` is `{names[name]}` since {SINCE}"


def place_now(result: str) -> str:
    """Where a result of before lies now, both inside `results/<scene>/`; empty where it is none
    of before.
    """
    path = PurePosixPath(result)
    for place in (path, *path.parents):
        if str(place) in MOVED:
            return str(PurePosixPath(MOVED[str(place)]) / path.relative_to(place))
    folder = path.parts[0] if path.parts else ""
    if folder not in STAGES:
        return ""
    return str(PurePosixPath(STAGES[folder], *path.parts[1:]))
