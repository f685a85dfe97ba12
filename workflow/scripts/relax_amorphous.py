"""Relax one amorphous cell by DFT.  In: elastic/quenched/NAME.{xyz,csv}.  Out: elastic/structures/NAME.*."""

from pathlib import Path

from atomistic.elastic.dft import make_calculator
from atomistic.elastic.structures import relaxed_structure
from atomistic.materials import load_material
from atomistic.settings import DftSettings
from workflow.job import job, settings_from_job
from workflow.results import load_csv, write_json, write_text
from workflow.structure_files import ScfStore, load_structure, structure_text, write_start

with job(snakemake) as run:
    material = load_material(snakemake.input.material)
    dft = settings_from_job(DftSettings, snakemake.params.dft)
    store = ScfStore(Path(snakemake.params.store))
    quenched = load_structure(snakemake.input.structure)
    status = load_csv(snakemake.input.attempts)[-1]["status"]
    largest_cell = quenched.cell.array * 1.02  # the mesh of a cell that would swell by this much
    relaxed = relaxed_structure(
        quenched,
        material.part("network_glass"),
        lambda: make_calculator(dft, "GGA", largest_cell, store, forces=True),
        dft.relaxation_steps,
        "" if status == "accepted" else status.removeprefix("rejected: "),
        run.progress,
    )
    write_text(snakemake.output.structure, structure_text(relaxed.atoms))
    write_start(snakemake.output.start, relaxed.calculator, run.provenance)
    write_json(snakemake.output.report, relaxed.report(snakemake.wildcards.amorphous), run.provenance)
    store.remove()
