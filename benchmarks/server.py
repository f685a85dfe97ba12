"""Calls per second of the UM-Bridge server with 1 and 2 workers, beside the library called in this process.

python -m benchmarks.server [--calls 200]

The client keeps as many calls under way as there are workers; seeds differ, so no two calls are the same.
"""

import argparse
import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before any library starts its threads

import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import umbridge

from asperity.models import evaluate

INPUTS = [[0.215, 91.0, 1.95, 8.4, 0.025, 0.75, 8.5]]
LAWS = [[30.0, 1e-4, 5e-4, 3.0, 28.0, 1e-4, 5e-4, 3.0, 0.215]]
"""Closing, opening, hamaker."""
WORKERS = (1, 2)
START_S = 60.0


def rate(call: Callable[[int], object], calls: int, at_once: int) -> float:
    """Calls per second, after one call for each worker that starts it."""
    with ThreadPoolExecutor(at_once) as threads:
        list(threads.map(call, range(4 * at_once)))
        start = time.perf_counter()
        list(threads.map(call, range(100, 100 + calls)))
    return calls / (time.perf_counter() - start)


def started(workers: int) -> tuple[subprocess.Popen[bytes], str]:
    """A server on a free port of the local address, ready to answer."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "asperity", "serve", "--port", str(port), "--workers", str(workers)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    url = f"http://127.0.0.1:{port}"
    end = time.monotonic() + START_S
    while True:
        try:
            urllib.request.urlopen(f"{url}/Info", timeout=1).close()
            return process, url
        except OSError:
            if time.monotonic() > end:
                process.terminate()
                raise
            time.sleep(0.1)


def main(calls: int) -> None:
    """Print one line for each model."""
    configurations = {
        "contact_cycle": lambda seed: (INPUTS, {"seed": seed, "contact": {"pixels": 256}}),
        "switch": lambda seed: (LAWS, {}),
    }
    in_process = {
        name: rate(lambda seed, name=name, made=made: evaluate(name, *made(seed)), calls, 1)
        for name, made in configurations.items()
    }
    print("model          library   " + "   ".join(f"{count} worker{'s' * (count > 1)}" for count in WORKERS))
    rates: dict[str, list[float]] = {name: [] for name in configurations}
    for workers in WORKERS:
        process, url = started(workers)
        try:
            for name, made in configurations.items():
                model = umbridge.HTTPModel(url, name)
                rates[name].append(rate(lambda seed, model=model, made=made: model(*made(seed)), calls, workers))
        finally:
            process.terminate()
            process.wait()
    for name, values in rates.items():
        print(
            f"{name:13} {in_process[name]:8.1f}   "
            + "   ".join(f"{value:8.1f}" for value in values)
            + "   calls per second"
        )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=200)
    main(parser.parse_args().calls)
