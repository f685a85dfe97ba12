"""E(V) of one crystal with known moduli.  In: its material file.  Out: accuracy/anchors/CRYSTAL_XC.csv (Å3, eV, s)."""

from dataclasses import asdict
from pathlib import Path

from atomistic.elastic.energy_scans import make_calculator, scan_volumes
from atomistic.elastic.networks import crystal
from atomistic.materials import load_material
from atomistic.settings import DftSettings
from workflow.job import job
from workflow.results import write_csv
from workflow.structure_files import ScfStore

with job(snakemake) as run:
    material = load_material(snakemake.input.material)
    name, xc = snakemake.wildcards.crystal, snakemake.wildcards.xc
    strains = snakemake.params.settings["strains"]
    atoms = crystal(material, name)
    store = ScfStore(Path(snakemake.params.store))
    calculator = make_calculator(
        DftSettings(**snakemake.params.settings["dft"]),
        xc,
        atoms.cell.array * (1 + max(strains)),
        store,
        material.crystals[name].cutoff_Ha,
    )
    points = scan_volumes(atoms, calculator, strains, progress=run.progress)
    row = {"structure": name, "xc": xc, "ions": "clamped", "atoms": len(atoms)}
    write_csv(snakemake.output.points, [{**row, **asdict(point)} for point in points])
    store.remove()
