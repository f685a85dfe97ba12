"""Does the server answer every request in one line of JSON, and others while it works on a large
one?

Requests are made up, cut off, of foreign hosts, of forms, or as large as they may be; between them
an ordinary one must be answered as always.
"""

import json
import random
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

from asperity.models import MODELS
from evidence.attacks.runs import HANG_S, TRACE, Attack, figures, table

__all__ = ["campaign", "figures", "rows"]
CENTRE = [0.215, 91.0, 1.95, 8.4, 0.025, 0.75, 8.5]
QUICK = {"cells": 1, "separations_nm": [80.0, 60.0], "contact": {"pixels": 32}}
ORDINARY = {"name": "pad", "input": [CENTRE], "config": QUICK}
JSON = {"Content-Type": "application/json"}
ODD: tuple[Any, ...] = (
    None, True, -1, 0, 1e300, 10**400, "", "x", [], {}, [[]], [None], "\x1b[31m", "\u202e", "cls",
    "self", "__class__",
    float("nan"), float("inf"), {"cls": 1}, {"self": 1}, {"pixels": 10**9}, {"pixels": "!!int"},
    [1e5] * 5000,
    "a" * 10**5,
)  # fmt: skip
KEYS = (
    "name",
    "input",
    "config",
    "seed",
    "cells",
    "contact",
    "law",
    "device",
    "separations_nm",
    "cls",
    "__init__",
)
KINDS = (
    "made up",
    "made up",
    "made up",
    "made up",
    "foreign host",
    "form",
    "cut off",
    "no HTTP",
    "too large",
    "left alone",
)


def arguments(parser: Any) -> None:
    """Options of the study."""
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=300)


def rows(given: Any) -> Iterator[dict[str, Any]]:
    """A row for each kind of request."""
    yield from table(campaign(given.seed, given.count))


def campaign(seed: int, count: int) -> Iterator[Attack]:
    """Requests to one server, which must be well at the end."""
    rng = random.Random(seed)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [str(Path(sys.executable).with_name("asperity")), "serve", "--port", str(port)]
    with tempfile.TemporaryFile() as errors:
        server = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors)
        try:
            while not _listens(port):
                time.sleep(0.1)
            for number in range(count):
                kind = KINDS[number % len(KINDS)]
                started = time.monotonic()
                outcome, words = _send(rng, port, kind)
                if outcome != "fault" and number % 10 == 9:
                    status, answer = _post(port, "/Evaluate", json.dumps(ORDINARY).encode(), JSON)
                    if status != 200 or server.poll() is not None:
                        outcome, words = (
                            "fault",
                            f"an ordinary request gets {status} {answer[:100]}",
                        )
                seconds = time.monotonic() - started
                yield Attack(kind, "fault" if seconds > HANG_S else outcome, seconds, words)
            errors.seek(0)
            said = errors.read().decode(errors="replace")
            words = said[-300:] if TRACE.search(said) or server.poll() is not None else "quiet"
            yield Attack(
                "what the server says", "used" if words == "quiet" else "fault", 0.0, words
            )
        finally:
            server.terminate()
            server.wait()


def _listens(port: int) -> bool:
    with socket.socket() as client:
        return client.connect_ex(("127.0.0.1", port)) == 0


def _send(rng: random.Random, port: int, kind: str) -> tuple[str, str]:
    body, headers = json.dumps(ORDINARY).encode(), dict(JSON)
    path = rng.choice(("/Evaluate", "/Evaluate", "/ModelInfo", "/InputSizes", "/OutputSizes", "/x"))
    if kind in ("cut off", "no HTTP", "left alone"):
        return _leave(rng, port, kind)
    if kind == "foreign host":
        headers["Host"] = rng.choice(
            ("evil.example", "evil.example:4242", "localhost.evil.example", "", "[::1")
        )
    elif kind == "form":
        headers["Content-Type"] = rng.choice(
            ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data")
        )
    elif kind == "too large":
        big = {
            "name": "pad",
            "input": [CENTRE],
            "config": {"cells": 10**5, "contact": {"pixels": 16384}},
        }
        path, body = "/Evaluate", json.dumps(big).encode() + b" " * rng.choice((0, 2 << 20))
    else:
        content = {**ORDINARY, "name": rng.choice(list(MODELS)), "config": {}}
        for _ in range(rng.randrange(1, 4)):
            owner = (
                rng.choice((content, content["config"]))
                if isinstance(content.get("config"), dict)
                else content
            )
            owner[rng.choice(KEYS)] = rng.choice(ODD)
        body = json.dumps(rng.choice((content, content, content, rng.choice(ODD)))).encode()
        body = body[: rng.randrange(len(body))] if rng.random() < 0.2 and body else body
    status, answer = _post(port, path, body, headers)
    try:
        content = json.loads(answer)
    except ValueError:
        return "fault", f"{status}, no JSON: {answer[:100]}"
    if kind in ("foreign host", "form", "too large") and status == 200:
        return "fault", "it was computed"
    if status == 200:
        return "used", ""
    line = content.get("error", {}).get("message", "") if isinstance(content, dict) else ""
    plain = status in (400, 404, 405, 413) or content["error"]["type"] == "ModelError"
    return ("refused" if line and line.isprintable() and plain else "fault", f"{status} {line}")


def _post(port: int, path: str, body: bytes, headers: dict[str, str]) -> tuple[int, str]:
    client = HTTPConnection("127.0.0.1", port, timeout=2 * HANG_S)
    try:
        client.request("POST", path, body, headers)
        response = client.getresponse()
        return response.status, response.read().decode()
    except OSError as error:
        return 0, f'{{"error": {{"type": "none", "message": "{type(error).__name__}"}}}}'
    finally:
        client.close()


def _leave(rng: random.Random, port: int, kind: str) -> tuple[str, str]:
    """A client that sends a part, or all, of a long request and goes away."""
    body = {"name": "contact_cycle", "input": [CENTRE], "config": {"contact": {"pixels": 4096}}}
    text = json.dumps(body).encode()
    head = (
        b"POST /Evaluate HTTP/1.1\r\nHost: localhost\r\nContent-Type:"
        b" application/json\r\nContent-Length: %d\r\n\r\n"
    )
    whole = rng.randbytes(500) if kind == "no HTTP" else head % len(text) + text
    with socket.create_connection(("127.0.0.1", port)) as client:
        client.sendall(whole if kind == "left alone" else whole[: rng.randrange(1, len(whole))])
        if kind == "left alone":
            time.sleep(0.3)  # the worker is at it
    return "used", "the client went away"
