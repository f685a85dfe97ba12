"""Relax one amorphous cell by DFT and scan its E(V).

In:  elastic/quenched/NAME.{xyz,csv}.  Out: elastic/structures/NAME.{xyz (Å),json},
elastic/scans/NAME.csv (Å3, eV).
"""

from pathlib import Path

from atomistic.elastic.dft import make_calculator
from atomistic.elastic.energy_scans import scan_rows
from atomistic.elastic.structures import relaxed_structure
from atomistic.materials import load_material
from atomistic.settings import DftSettings
from workflow.files.results import load_csv, write_csv, write_json, write_text
from workflow.files.structures import ScfStore, load_structure, structure_text
from workflow.run.job import job, settings_from_job

with job(snakemake, shared=True) as run:
    material = load_material(snakemake.input.material)
    name = snakemake.wildcards.amorphous
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
    start = getattr(relaxed.calculator, "history", [])[-1:]
    rejected = "; ".join(relaxed.reasons)
    scans = [
        scan_rows(name, relaxed.atoms, xc, dft, store, start, rejected, run.progress)
        for xc in snakemake.params.functionals
    ]
    write_text(snakemake.output.structure, structure_text(relaxed.atoms))
    write_json(snakemake.output.report, relaxed.report(name), run.provenance)
    write_csv(snakemake.output.points, [row for scan in scans for row in scan])
    store.remove()
