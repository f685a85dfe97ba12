"""Fit equations of state.  In: elastic/scans/*.csv.  Out: elastic/points.csv (Å3, eV), bulk_moduli.csv (GPa)."""

from atomistic.elastic.energy_scans import fit_scan
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    scans = [load_csv(path) for path in snakemake.input.scans]
    write_csv(snakemake.output.points, [row for scan in scans for row in scan])
    write_csv(snakemake.output.moduli, [fit_scan(scan) for scan in scans])
