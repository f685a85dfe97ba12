"""Compute a chunk of direct contact cycles of a design and keep their law.

In: inputs.csv.  Out: uq/DESIGN/chunk_NNN.csv (inputs, seed, parameters of both branches, statuses),
uq/DESIGN/timing_NNN.csv (what the job and the engine in it took).
"""

import resource
import time

import psutil

from mesoscale.inputs.table import from_rows
from mesoscale.settings import LawSettings, UncertaintySettings
from mesoscale.uncertainty.designs import DESIGNS
from mesoscale.uncertainty.runs import compute_rows
from workflow.contact_settings import contact_settings
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    runs = DESIGNS[snakemake.wildcards.design](
        from_rows(load_csv(snakemake.input.inputs)),
        UncertaintySettings(**snakemake.params.uncertainty),
        *snakemake.params.bounds,
    )
    rows = list(
        compute_rows(
            runs,
            contact_settings(snakemake.params.contact, snakemake),
            LawSettings(**snakemake.params.law),
            run.progress,
        )
    )
    # apart from the results, which are the same for the same seeds
    seconds = [float(row.pop("cpu_s")) for row in rows]
    write_csv(snakemake.output.runs, rows)
    later = seconds[1:] or seconds  # the first cycle also loads the engine
    timing = {
        "cycles": len(rows),
        "engine_cpu_s": len(rows) * sum(later) / len(later),
        "job_started_s": psutil.Process().create_time(),
        "job_ended_s": time.time(),
        "peak_rss_MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }
    write_csv(snakemake.output.timing, [timing])
