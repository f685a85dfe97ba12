"""Close one asperity against the flat.

In:  potential (YAML), glass/N.data.
Out: closing/RUN.csv (GPa, nm), witness/RUN.csv (bond exchanges, nm), snapshots/RUN.csv (nm), runs/RUN.json.
"""

import resource
import time
from pathlib import Path

from atomistic.closing import run_closing
from atomistic.lammps import read_data
from atomistic.potentials import load_potential
from atomistic.runs import run_named
from atomistic.settings import HardnessSettings
from workflow.job import job
from workflow.results import write_csv, write_json

with job(snakemake) as run:
    settings = HardnessSettings(**snakemake.params.settings, asperities=[snakemake.params.asperity])
    potential = load_potential(snakemake.input.potential)
    closing_run = run_named(snakemake.wildcards.run, settings)
    glass = read_data(snakemake.input.glass, tuple(potential.materials[settings.material]))
    started, cpu = time.perf_counter(), time.process_time()
    closing = run_closing(closing_run, glass, potential, settings, Path(snakemake.params.work), run.progress)
    lammps = resource.getrusage(resource.RUSAGE_CHILDREN)
    write_csv(snakemake.output.curve, closing.curve)
    write_csv(snakemake.output.witness, closing.witness)
    write_csv(snakemake.output.snapshots, closing.snapshots, ["step", "type", "x_nm", "y_nm", "z_nm"])
    write_json(
        snakemake.output.summary,
        {
            "run": closing_run.name,
            "asperity": closing_run.asperity.name,
            "energy_scale": closing_run.energy_scale,
            "seed": closing_run.seed,
            "amplitude_nm": closing_run.asperity.amplitude_nm,
            **closing.summary,
            "wall_s": time.perf_counter() - started,
            "lammps_cpu_s": lammps.ru_utime + lammps.ru_stime,
            "peak_rss_MB": lammps.ru_maxrss / 1024,
            "python_cpu_s": time.process_time() - cpu,
        },
        run.provenance,
    )
