"""E(V).  In: elastic/structures/GLASS.{xyz,json,h5}, or a crystal's material.  Out: elastic/scans/*.csv (Å3, eV)."""

from dataclasses import asdict
from pathlib import Path

from atomistic.elastic.dft import make_calculator
from atomistic.elastic.energy_scans import LDA_CENTRE, rejected_points, scan_volumes
from atomistic.elastic.networks import crystal
from atomistic.elastic.relaxation import strained
from atomistic.materials import load_material
from atomistic.settings import DftSettings
from workflow.job import job, settings_from_job
from workflow.results import load_json, write_csv
from workflow.structure_files import ScfStore, load_structure, start_from

with job(snakemake) as run:
    dft, strains = settings_from_job(DftSettings, snakemake.params.dft), snakemake.params.strains
    store = ScfStore(Path(snakemake.params.store))
    glass = snakemake.input.get("structure")
    name, xc = snakemake.wildcards.structure, snakemake.wildcards.xc
    atoms = load_structure(glass) if glass else crystal(load_material(snakemake.input.material), name)
    if xc == "LDA":
        atoms = strained(atoms, LDA_CENTRE)
    calculator = make_calculator(dft, xc, atoms.cell.array * (1 + max(strains)), store)
    reasons = load_json(snakemake.input.report)["gate"]["reasons"] if glass else []
    if reasons:
        points = rejected_points(atoms, strains, "; ".join(reasons))
    else:
        if glass:
            start_from(calculator, snakemake.input.start)
        points = scan_volumes(atoms, calculator, strains, run.progress)
    head = {"structure": name, "xc": xc, "ions": "clamped", "atoms": len(atoms)}
    write_csv(snakemake.output.points, [{**head, **asdict(point)} for point in points])
    store.remove()
