"""Fit the force-separation law to both branches of every curve of the runs.

In: inputs.csv, curves/runs/chunk_NNN.h5 (nm, nN).  Out: law/parameters.csv and law/wells.csv, one row
per run and branch.
"""

from mesoscale.inputs.table import from_rows
from mesoscale.law.branches import fit_stored
from workflow.job import job
from workflow.results import load_csv, load_h5, write_csv

with job(snakemake) as run:
    names = from_rows(load_csv(snakemake.input.inputs)).names
    rows, wells = [], []
    for done, path in enumerate(snakemake.input.chunks):
        curves, root, attributes = load_h5(path)
        for name in sorted(key for key in attributes if "/" not in key):
            attrs = attributes[name]
            head = {key: attrs[key] for key in ("run", "node", "seed")}
            values = {key: attrs[key] for key in names}
            for stored in fit_stored(curves, name, attrs, root["cell_area_nm2"]):
                rows.append({**head, **stored.row, **values})
                wells.append({**head, **stored.well_row})
        run.progress((done + 1) / len(snakemake.input.chunks), "curves fitted")
    for table, path in ((rows, snakemake.output.parameters), (wells, snakemake.output.wells)):
        table.sort(key=lambda row: row["run"])
        write_csv(path, table)
