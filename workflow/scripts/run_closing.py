"""Close one asperity against a flat.

In:  material, potential (YAML), glass (LAMMPS data file); base (LAMMPS data file), base_material
(YAML) where another
     body lies below.
Out: curve (GPa, nm), witness (bond exchanges, nm), summary.
"""

import resource
import time
from pathlib import Path

from atomistic.hardness.closing import run_closing
from atomistic.hardness.runs import ClosingRun, Protocol
from atomistic.hardness.stack import base_of
from atomistic.lammps import load_data
from atomistic.materials import load_material
from atomistic.potentials import load_potential
from atomistic.settings import ClosingSettings
from workflow.files.results import write_csv, write_json
from workflow.run.job import job, settings_from_job

with job(snakemake, shared=True) as run:
    closing_run = settings_from_job(ClosingRun, snakemake.params.closing_run)
    settings = settings_from_job(ClosingSettings, snakemake.params.closing)
    protocol = settings_from_job(Protocol, snakemake.params.protocol)
    potential = load_potential(snakemake.input.potential)
    material = load_material(snakemake.input.material)
    glass = load_data(snakemake.input.glass, tuple(potential.materials[material.formula_text]))
    base = None
    if cell := snakemake.input.get("base"):
        below = base_of(load_material(snakemake.input.base_material))
        base = below, load_data(cell, below.elements)
    started = time.perf_counter()
    closing = run_closing(
        closing_run,
        material,
        glass,
        potential,
        settings,
        Path(snakemake.params.work),
        protocol,
        run.progress,
        base,
    )
    lammps = resource.getrusage(resource.RUSAGE_CHILDREN)
    write_csv(snakemake.output.curve, closing.curve)
    write_csv(snakemake.output.witness, closing.witness)
    write_json(
        snakemake.output.summary,
        {
            "run": closing_run.name,
            "asperity": closing_run.asperity.name,
            "energy_scale": closing_run.energy_scale,
            "seed": closing_run.seed,
            "amplitude_nm": closing_run.asperity.amplitude_nm,
            "film_nm": closing_run.asperity.film_nm,
            **closing.summary,
            "wall_s": time.perf_counter() - started,
            "lammps_cpu_s": lammps.ru_utime + lammps.ru_stime,
            "peak_rss_MB": lammps.ru_maxrss / 1024,
            "python_cpu_s": time.process_time(),  # imports included
        },
        run.provenance,
    )
