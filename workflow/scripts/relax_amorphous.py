"""Relax one amorphous cell by DFT.  In: elastic/quenched/NAME.xyz.  Out: elastic/structures/NAME.{xyz,json,h5}."""

from dataclasses import asdict
from pathlib import Path

import yaml

from atomistic.elastic.energy_scans import make_calculator
from atomistic.elastic.networks import examine
from atomistic.elastic.relaxation import UNTOUCHED, relax_glass
from atomistic.settings import DftSettings, RelaxationSettings
from workflow.job import job
from workflow.results import write_json, write_text
from workflow.structure_files import ScfStore, read_structure, structure_text, write_orbitals

with job(snakemake) as run:
    material = yaml.safe_load(Path(snakemake.input.material).read_text(encoding="utf-8"))
    relaxation = RelaxationSettings(**snakemake.params.settings["relaxation"])
    dft = DftSettings(**snakemake.params.settings["dft"])
    store = ScfStore(Path(snakemake.params.store))
    quenched = read_structure(snakemake.input.structure)
    verdict = examine(quenched, material["glass"], perfect=True)
    calculator = None
    if verdict.passed:
        calculator = make_calculator(relaxation.applied_to(dft), "GGA", quenched.cell.array * 1.02, store)
        atoms, done = relax_glass(quenched, calculator, relaxation, progress=run.progress)
        verdict = examine(atoms, material["glass"])
    else:  # nothing is spent on a cell that no quench made right
        atoms, done = quenched, UNTOUCHED
    reasons = [*verdict.reasons, *filter(None, [done.failure])]
    if done.gap_eV < material["glass"]["gap_eV"]:
        reasons.append(f"gap {done.gap_eV:.2f} eV: no insulator")
    report = {
        "structure": snakemake.wildcards.amorphous,
        "atoms": len(atoms),
        "density_g_cm3": verdict.density_g_cm3,
        **{f"coordination_{element}": value for element, value in verdict.coordination.items()},
        "bond_spread_A": verdict.bond_spread_A,
        "relaxation": asdict(done),
        "gate": {"passed": not reasons, "reasons": reasons},
    }
    write_text(snakemake.output.structure, structure_text(atoms))
    write_orbitals(snakemake.output.orbitals, calculator, run.provenance)
    write_json(snakemake.output.report, report, run.provenance)
    store.remove()
