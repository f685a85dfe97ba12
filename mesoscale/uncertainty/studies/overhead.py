"""What share of the machine's time the workflow takes beside the engine."""

from collections.abc import Mapping, Sequence

PAUSE_S = 60.0
"""A longer time without any job is an interruption of the user's and does not count."""


def workload(timings: Sequence[Mapping[str, str]], cores: int) -> dict[str, float | int]:
    """The row of uq/overhead.csv from the jobs' timings (start, end, cycles, engine's CPU seconds).

    elapsed_s runs from the first job's start to the last one's end, without pauses; overhead is
    1 - engine's CPU seconds / (cores elapsed_s), so it counts starting jobs, idle cores and other load.
    """
    jobs = sorted((float(row["job_started_s"]), float(row["job_ended_s"])) for row in timings)
    elapsed, reached = 0.0, jobs[0][0]
    for start, end in jobs:
        idle = max(start - reached, 0.0)
        elapsed += (idle if idle <= PAUSE_S else 0.0) + max(end - max(start, reached), 0.0)
        reached = max(reached, end)
    engine = sum(float(row["engine_cpu_s"]) for row in timings)
    return {
        "cycles": sum(int(row["cycles"]) for row in timings),
        "jobs": len(jobs),
        "cores": cores,
        "elapsed_s": elapsed,
        "engine_cpu_s": engine,
        "engine_s_per_cycle": engine_s_per_cycle(timings),
        "overhead": 1 - engine / (cores * elapsed),
        "peak_rss_MB": max(float(row["peak_rss_MB"]) for row in timings),
    }


def engine_s_per_cycle(timings: Sequence[Mapping[str, str]]) -> float:
    """CPU seconds of the engine per cycle, from the jobs' timings."""
    return sum(float(row["engine_cpu_s"]) for row in timings) / sum(int(row["cycles"]) for row in timings)
