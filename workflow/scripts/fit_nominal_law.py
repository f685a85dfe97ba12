"""Fit the force-separation law to both branches of every nominal curve.

In: curves/nominal.h5 (nm, nN).  Out: law/nominal.csv, one row per curve and branch.
"""

from mesoscale.law.branches import fit_stored
from workflow.job import job
from workflow.results import load_h5, write_csv

with job(snakemake) as run:
    curves, root, attributes = load_h5(snakemake.input.nominal)
    rows = []
    for name in sorted({key.rpartition("/")[0] for key in curves if "/" in key}):
        about_curve = {**root, **attributes.get(name, {})}
        area = float(about_curve["cell_area_nm2"])
        rows += [{"curve": name, **stored.row} for stored in fit_stored(curves, name, about_curve, area)]
    write_csv(snakemake.output[0], rows)
