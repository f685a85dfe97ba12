"""E(V) of one structure.  In: elastic/structures/NAME.xyz.  Out: elastic/scans/NAME_XC.csv (Å3, eV)."""

from dataclasses import asdict
from pathlib import Path

from atomistic.elastic.dft import make_calculator
from atomistic.elastic.energy_scans import LDA_CENTRE, rejected_points, scan_volumes
from atomistic.elastic.relaxation import strained
from atomistic.settings import DftSettings
from workflow.job import job, settings_from_job
from workflow.results import load_json, write_csv
from workflow.structure_files import ScfStore, load_structure, start_from

with job(snakemake) as run:
    dft, strains = settings_from_job(DftSettings, snakemake.params.dft), snakemake.params.strains
    store = ScfStore(Path(snakemake.params.store))
    atoms = load_structure(snakemake.input.structure)
    if snakemake.wildcards.xc == "LDA":
        atoms = strained(atoms, LDA_CENTRE)
    calculator = make_calculator(dft, snakemake.wildcards.xc, atoms.cell.array * (1 + max(strains)), store)
    glass = snakemake.input.get("report")  # a crystal has neither a verdict nor orbitals to start from
    reasons = load_json(glass)["gate"]["reasons"] if glass else []
    if reasons:
        points = rejected_points(atoms, strains, "; ".join(reasons))
    else:
        if glass:
            start_from(calculator, snakemake.input.start)
        points = scan_volumes(atoms, calculator, strains, run.progress)
    name = {"structure": snakemake.wildcards.structure, "xc": snakemake.wildcards.xc, "ions": "clamped"}
    write_csv(snakemake.output.points, [{**name, "atoms": len(atoms), **asdict(point)} for point in points])
    store.remove()
