"""Cycles of random draws spread over processes; a module of its own, because processes cannot import `__main__`."""

import multiprocessing
import statistics
import time

from mesoscale.contact import run_cycle
from mesoscale.contact.studies.draws import draw_inputs
from mesoscale.settings import ContactSettings


def one_of_many(number: int) -> float:
    """Processor time (s) of a cycle at 1024 x 1024, surface included, of draw `number` from Table 1."""
    start = time.process_time()
    run_cycle(draw_inputs(number), ContactSettings(), number)
    return time.process_time() - start


def many(cycles: int, processes: int) -> tuple[float, float]:
    """Wall time (s) of cycles of random draws spread over processes, start-up left out, and processor time of one."""
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        pool.map(one_of_many, range(2 * processes), chunksize=1)
        start = time.perf_counter()
        seconds = pool.map(one_of_many, range(cycles), chunksize=5)
        return time.perf_counter() - start, statistics.mean(seconds)
