"""E(V) of a crystal with both functionals.  In: its material.  Out: elastic/scans/NAME.csv (Å3,
eV).
"""

from pathlib import Path

from atomistic.elastic.energy_scans import scan_rows
from atomistic.elastic.networks import crystal
from atomistic.materials import load_material
from atomistic.settings import DftSettings
from workflow.files.results import write_csv
from workflow.files.structures import ScfStore
from workflow.run.job import job, settings_from_job

with job(snakemake, shared=True) as run:
    dft = settings_from_job(DftSettings, snakemake.params.dft)
    name = snakemake.wildcards.crystal
    store = ScfStore(Path(snakemake.params.store))
    atoms = crystal(load_material(snakemake.input.material), name)
    scans = [scan_rows(name, atoms, xc, dft, store, progress=run.progress) for xc in ("GGA", "LDA")]
    write_csv(snakemake.output.points, [row for scan in scans for row in scan])
    store.remove()
