"""E(V) of one structure.  In: elastic/structures/NAME.xyz.  Out: elastic/scans/NAME_XC_IONS.csv (Å3, eV)."""

from dataclasses import asdict
from pathlib import Path

from atomistic.elastic.energy_scans import make_calculator, rejected_points, scan_volumes
from atomistic.elastic.relaxation import relax_ions, strained
from atomistic.settings import DftSettings, RelaxationSettings
from workflow.job import job
from workflow.results import load_json, write_csv
from workflow.structure_files import ScfStore, load_structure, start_from

with job(snakemake) as run:
    settings = snakemake.params.settings
    relaxation = RelaxationSettings(**settings["relaxation"])
    dft = DftSettings(**settings["dft"])
    relaxed = snakemake.wildcards.ions == "relaxed"
    if relaxed:
        dft = relaxation.applied_to(dft)
    store = ScfStore(Path(snakemake.params.store))
    atoms = load_structure(snakemake.input.structure)
    if snakemake.wildcards.xc == "LDA":
        atoms = strained(atoms, settings["lda_centre"])
    largest = atoms.cell.array * (1 + max(settings["strains"]))
    calculator = make_calculator(dft, snakemake.wildcards.xc, largest, store)

    def relax(trial, hessian):
        return relax_ions(trial, settings["relaxed_force_eV_A"], relaxation.max_steps, hessian)

    reasons = load_json(snakemake.input.report)["gate"]["reasons"] if snakemake.input.get("report") else []
    if not reasons:
        if snakemake.input.get("start"):
            start_from(calculator, snakemake.input.start)
        points = scan_volumes(atoms, calculator, settings["strains"], relax if relaxed else None, run.progress)
    else:
        points = rejected_points(atoms, settings["strains"], "; ".join(reasons))
    name = {key: snakemake.wildcards[key] for key in ("structure", "xc", "ions")}
    write_csv(snakemake.output.points, [{**name, "atoms": len(atoms), **asdict(point)} for point in points])
    store.remove()
