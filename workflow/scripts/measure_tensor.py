"""Elastic constants.  In: material, elastic/structures/GLASS.xyz.  Out: elastic/tensors/NAME.{json (GPa), xyz (Å)}."""

from pathlib import Path

from atomistic.elastic.dft import PyscfGamma, TwoMeshes
from atomistic.elastic.energy_scans import make_calculator
from atomistic.elastic.joint_moduli import Measured, measure_constants
from atomistic.elastic.networks import crystal
from atomistic.materials import load_material
from atomistic.settings import DftSettings, RelaxationSettings, TensorSettings
from workflow.job import job
from workflow.results import load_json, write_json, write_text
from workflow.structure_files import ScfStore, load_structure, start_from, structure_text

with job(snakemake) as run:
    settings = snakemake.params.settings
    dft = RelaxationSettings(**settings["relaxation"]).applied_to(DftSettings(**settings["dft"]))
    store = ScfStore(Path(snakemake.params.store))
    material = load_material(snakemake.input.material)
    name, cutoff_Ha, criteria = snakemake.wildcards.structure, None, None
    if name in material.crystals:
        cell = material.crystals[name].constants_cell or material.crystals[name]
        atoms, cutoff_Ha = crystal(material, name, cell.supercell), cell.cutoff_Ha
    else:
        atoms, criteria = load_structure(snakemake.input.structure), material.part("network_glass")
    reasons = load_json(snakemake.input.report)["gate"]["reasons"] if snakemake.input.get("report") else []
    if reasons:
        measured = Measured(atoms, None, None, "; ".join(reasons))
    else:
        calculator = make_calculator(dft, "GGA", atoms.cell.array * 1.03, store, cutoff_Ha)
        if snakemake.input.get("start"):
            start_from(calculator, snakemake.input.start)
        if isinstance(calculator, PyscfGamma):
            calculator = TwoMeshes(calculator)  # curvatures feel the ripple of one mesh
        tensor = TensorSettings(**settings["tensor"])
        measured = measure_constants(atoms, calculator, tensor, run.progress, criteria)
    write_text(snakemake.output.at_rest, structure_text(measured.atoms))
    write_json(snakemake.output.tensor, measured.report(name), run.provenance)
    store.remove()
