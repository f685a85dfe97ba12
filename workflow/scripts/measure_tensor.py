"""Elastic constants.  In: elastic/structures/GLASS.{xyz,json,h5}.  Out: elastic/tensors/NAME.{json (GPa), xyz (Å)}."""

from pathlib import Path

from atomistic.elastic.constants import Measured, measure_constants
from atomistic.elastic.dft import PyscfGamma, TwoMeshes, make_calculator
from atomistic.materials import load_material
from atomistic.settings import DftSettings
from workflow.job import job, settings_from_job
from workflow.results import load_json, write_json, write_text
from workflow.structure_files import ScfStore, load_structure, start_from, structure_text

with job(snakemake) as run:
    store = ScfStore(Path(snakemake.params.store))
    atoms = load_structure(snakemake.input.structure)
    reasons = load_json(snakemake.input.report)["gate"]["reasons"]
    if reasons:
        measured = Measured(atoms, None, None, "; ".join(reasons))
    else:
        dft = settings_from_job(DftSettings, snakemake.params.dft)
        calculator = make_calculator(dft, "GGA", atoms.cell.array * 1.03, store, forces=True)
        start_from(calculator, snakemake.input.start)
        if isinstance(calculator, PyscfGamma):
            calculator = TwoMeshes(calculator)  # curvatures feel the ripple of one mesh
        criteria = load_material(snakemake.input.material).part("network_glass")
        measured = measure_constants(atoms, calculator, run.progress, criteria)
    write_text(snakemake.output.at_rest, structure_text(measured.atoms))
    write_json(snakemake.output.tensor, measured.report(snakemake.wildcards.amorphous), run.provenance)
    store.remove()
