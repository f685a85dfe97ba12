"""The UM-Bridge server, with the real client of the umbridge package, and mistreated."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from concurrent.futures import ThreadPoolExecutor
from http.client import HTTPConnection

import numpy as np
import pytest

from asperity.models import MODELS

umbridge = pytest.importorskip("umbridge")

CENTRE = [0.215, 91.0, 1.95, 8.4, 0.025, 0.75, 8.5]
QUICK = {"cells": 1, "separations_nm": [80.0, 60.0], "contact": {"pixels": 32}}
CONTACT = {"contact": {"pixels": 64, "max_force_nN": 2000}}


@pytest.fixture(scope="module")
def server():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    process = subprocess.Popen(
        [sys.executable, "-m", "asperity", "serve", "--port", str(port), "--workers", "2"],
        stdout=subprocess.PIPE,
    )
    url = f"http://127.0.0.1:{port}"
    for _ in range(600):
        try:
            urllib.request.urlopen(f"{url}/Info", timeout=1).close()
            break
        except OSError:
            time.sleep(0.1)
    yield url, process
    process.send_signal(signal.SIGINT)
    process.wait(20)


def post(url, path, body):
    request = urllib.request.Request(
        f"{url}/{path}",
        data=body if isinstance(body, bytes) else json.dumps(body).encode(),
        headers={"Content-Type": "application/json"},
    )
    try:
        with urllib.request.urlopen(request, timeout=120) as answer:
            return answer.status, json.load(answer)
    except urllib.error.HTTPError as error:
        return error.code, json.load(error)


HEAD = b"POST /Evaluate HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"


@pytest.mark.parametrize(
    ("request_bytes", "words"),
    [
        (
            HEAD + b"Transfer-Encoding: chunked\r\n\r\nZZ\r\nabc\r\n0\r\n\r\n",
            "no HTTP: Invalid character in chunk size",
        ),
        (
            HEAD + b"Transfer-Encoding: chunked\r\n\r\n3\r\nabcdef\r\n0\r\n\r\n",
            "no HTTP: Expected LF",
        ),
        (HEAD + b"Content-Length: -5\r\n\r\n", "no HTTP: Invalid character in Content-Length"),
        (HEAD + b"Content-Encoding: gzip\r\nContent-Length: 3\r\n\r\nabc", "cannot be decoded"),
        (b"HELLO\r\n\r\n", "no HTTP: Invalid method"),
        (HEAD + b"Content-Length: 100\r\n\r\n{", "did not come within 1 s"),
    ],
)
def test_what_is_no_request_is_answered_in_one_line_and_let_go(request_bytes, words):
    """By a server of its own, whose errors are read: no stacks."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    code = f"from asperity import server; server.BODY_S = 1.0; server.serve('127.0.0.1', {port}, 1)"
    process = subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.PIPE)
    try:
        for _ in range(600):
            try:
                client = socket.create_connection(("127.0.0.1", port), timeout=60)
                break
            except OSError:
                time.sleep(0.1)
        with client:
            client.sendall(request_bytes)
            answer = client.makefile("rb").read()  # until the server lets go
    finally:
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=20)
    head, _, body = answer.partition(b"\r\n\r\n")
    assert b" 400 " in head
    message = json.loads(body)["error"]["message"]
    assert words in message
    assert message.isprintable()
    assert b"Traceback" not in errors


@pytest.mark.parametrize(
    ("name", "values", "config"),
    [
        ("contact_cycle", CENTRE, {"seed": 3, **CONTACT}),
        ("law", CENTRE, {"seed": 3, "contact": {"pixels": 128}}),
        ("pad", CENTRE, {"cells": 2, "separations_nm": [40.0, 30.0], "contact": {"pixels": 64}}),
    ],
)
def test_client_gets_the_librarys_digits(server, name, values, config):
    model = umbridge.HTTPModel(server[0], name)
    assert model([values], config) == MODELS[name]([values], config)
    assert model.get_input_sizes(config) == [len(values)]
    assert model.get_output_sizes(config) == [len(part) for part in MODELS[name]([values], config)]


@pytest.mark.parametrize(
    ("path", "body", "words"),
    [
        ("Evaluate", b"{", "no JSON"),
        ("Evaluate", b"\xff\xfe", "no JSON"),
        ("Evaluate", b"[" * 100_000, "no JSON"),
        ("Evaluate", [], "JSON object"),
        ("Evaluate", {}, "no such model"),
        ("Evaluate", {"name": "none"}, "no such model"),
        ("Evaluate", {"name": "law"}, "one list of 7 numbers"),
        ("Evaluate", {"name": "law", "input": [[1, 2]]}, "one list of 7 numbers"),
        ("Evaluate", {"name": "law", "input": [["a"] * 7]}, "one list of 7 numbers"),
        ("Evaluate", {"name": "contact_cycle", "input": [[*CENTRE[:-1], -1]]}, "rms = -1"),
        (
            "Evaluate",
            {"name": "contact_cycle", "input": [CENTRE], "config": {"sed": 1}},
            "unknown key",
        ),
        (
            "Evaluate",
            {"name": "contact_cycle", "input": [CENTRE], "config": {"seed": -1}},
            "seed = -1",
        ),
        ("Evaluate", {"name": "contact_cycle", "input": [CENTRE], "config": 5}, "mapping"),
        ("Evaluate", {"name": []}, "no such model"),
        ("Evaluate", {"name": {"a": 1}}, "no such model"),
        ("ModelInfo", {"name": None}, "no such model"),
        (
            "Evaluate",
            {"name": "contact_cycle", "input": [CENTRE], "config": {"contact": {"cls": 1}}},
            "cls = 1",
        ),
        ("Evaluate", {"name": "contact_cycle", "input": [[*CENTRE[:-1], 10**400]]}, "too large"),
        (
            "Evaluate",
            {"name": "contact_cycle", "input": [CENTRE], "config": {"contact": {"pixels": 16384}}},
            "points",
        ),
        (
            "Evaluate",
            {"name": "pad", "input": [CENTRE], "config": {"cells": 100_000}},
            "grid points",
        ),
        (
            "Evaluate",
            {"name": "pad", "input": [CENTRE], "config": {"separations_nm": [40.0] * 5000}},
            "1 .. 1000",
        ),
        ("InputSizes", {"name": "none"}, "no such model"),
        ("OutputSizes", {"name": "pad", "config": {"separations_nm": "x"}}, "falling separations"),
    ],
)
def test_a_malformed_request_gets_one_line(server, path, body, words):
    status, answer = post(server[0], path, body)
    assert status == 400
    assert words in answer["error"]["message"]
    assert "\n" not in answer["error"]["message"]
    assert server[1].poll() is None


@pytest.mark.parametrize("headers", [
    {"Host": "evil.example"}, {"Host": "evil.example:4242"}, {"Host": "[::1"},
    {"Content-Type": "text/plain"},
    {"Content-Type": "application/x-www-form-urlencoded"},
    {"Content-Type": "application/json; charset=nobody"},
])  # fmt: skip
def test_a_web_page_cannot_use_the_server(server, headers):
    """A page of a stranger may send forms anywhere, and may let a name of its own lead here; JSON
    it may not send.
    """
    client = HTTPConnection(server[0].removeprefix("http://"), timeout=60)
    body = json.dumps({"name": "pad", "input": [CENTRE], "config": QUICK})
    client.request("POST", "/Evaluate", body, {"Content-Type": "application/json", **headers})
    answer = client.getresponse()
    assert answer.status == 400
    assert "\n" not in json.load(answer)["error"]["message"]


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="needs /proc")
def test_a_request_that_nobody_waits_for_is_ended(server):
    """Large requests keep both workers; their clients go away, and a small request is answered at
    once.
    """
    url = server[0].removeprefix("http://")
    body = json.dumps(
        {"name": "contact_cycle", "input": [CENTRE], "config": {"contact": {"pixels": 8192}}}
    )
    clients = [HTTPConnection(url) for _ in range(4)]
    for client in clients:
        client.request("POST", "/Evaluate", body, {"Content-Type": "application/json"})
    time.sleep(1)
    for client in clients:
        client.close()
    started = time.monotonic()
    assert len(umbridge.HTTPModel(server[0], "pad")([CENTRE], QUICK)) == 2
    assert time.monotonic() - started < 60  # of a busy machine: new workers import the library


def children(pid):
    found = []
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            try:
                with open(f"/proc/{entry}/stat") as stat, open(f"/proc/{entry}/cmdline") as line:
                    if (
                        int(stat.read().rpartition(")")[2].split()[1]) == pid
                        and "spawn_main" in line.read()
                    ):
                        found.append(int(entry))
            except OSError:
                continue
    return found


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="needs /proc")
def test_a_killed_worker_is_replaced(server):
    url, process = server
    model = umbridge.HTTPModel(url, "pad")
    first = model([CENTRE], QUICK)
    workers = children(process.pid)
    assert workers
    for worker in workers:
        os.kill(worker, signal.SIGKILL)
    assert model([CENTRE], QUICK) == first


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="needs /proc")
def test_a_worker_killed_at_work_is_replaced_and_its_request_repeated(server):
    url, process = server
    config = {"cells": 3, "separations_nm": [40.0, 30.0], "contact": {"pixels": 256}}
    with ThreadPoolExecutor(1) as client:
        answer = client.submit(umbridge.HTTPModel(url, "pad"), [CENTRE], config)
        time.sleep(0.3)  # the cells take longer
        for worker in children(process.pid):
            os.kill(worker, signal.SIGKILL)
        assert answer.result(120) == MODELS["pad"]([CENTRE], config)


def test_a_client_that_goes_away_leaves_the_server_well(server):
    url = server[0]
    host, port = url.removeprefix("http://").split(":")
    body = json.dumps(
        {"name": "contact_cycle", "input": [CENTRE], "config": {"contact": {"pixels": 256}}}
    ).encode()
    for cut in (len(body), len(body) // 2):
        client = socket.create_connection((host, int(port)))
        client.sendall(
            b"POST /Evaluate HTTP/1.1\r\nHost: x\r\nContent-Length: %d\r\n\r\n" % len(body)
            + body[:cut]
        )
        client.close()
    assert len(umbridge.HTTPModel(url, "pad")([CENTRE], QUICK)) == 2


@pytest.mark.skipif(not os.path.isfile("/proc/net/tcp"), reason="needs /proc")
def test_only_the_local_address_listens(server):
    port = int(server[0].rpartition(":")[2])
    with open("/proc/net/tcp") as table:
        addresses = [line.split()[1] for line in table.readlines()[1:] if line.split()[3] == "0A"]
    mine = [address for address in addresses if address.endswith(f":{port:04X}")]
    assert mine == [f"0100007F:{port:04X}"]


def test_a_foreign_library_propagates_through_it(server):
    """OpenTURNS sends a sample through a pad by way of the client: its pull grows with the Hamaker
    constant.
    """
    openturns = pytest.importorskip("openturns")
    model = umbridge.HTTPModel(server[0], "pad")

    def pull(point):
        return [-model([[float(point[0]), *CENTRE[1:]]], QUICK)[0][0]]

    function = openturns.PythonFunction(1, 1, pull)
    pulls = np.array(function(openturns.Sample(np.array([[0.1], [0.2], [0.3]]))))[:, 0]
    assert (np.diff(pulls) > 0).all()
