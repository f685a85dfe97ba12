"""Fit the force-separation law to both branches of every curve, of the runs and of the nominal
cycles.

In: inputs.csv, law/runs/chunk_NNN.h5, contact/nominal.h5 (nm, nN). Out: law/parameters.csv, one
row per run and branch; law/nominal.csv, one row per nominal curve and branch.
"""

from mesoscale.inputs.table import from_rows
from mesoscale.law.branches import stored_rows
from workflow.files.results import load_csv, load_h5, write_csv
from workflow.run.job import job

with job(snakemake) as run:
    names = from_rows(load_csv(snakemake.input.inputs)).names
    rows = []
    for done, path in enumerate(snakemake.input.chunks):
        curves, root, attributes = load_h5(path)
        for name in sorted(key for key in attributes if "/" not in key):
            attrs = attributes[name]
            head = {key: attrs[key] for key in ("run", "node", "seed")}
            values = {key: attrs[key] for key in names}
            rows += [
                {**head, **row, **values}
                for row in stored_rows(curves, name, attrs, root["cell_area_nm2"])
            ]
        run.progress((done + 1) / len(snakemake.input.chunks), "curves fitted")
    write_csv(snakemake.output.parameters, sorted(rows, key=lambda row: row["run"]))

    nominal = []
    curves, root, attributes = load_h5(snakemake.input.nominal)
    for name in sorted({key.rpartition("/")[0] for key in curves if "/" in key}):
        about = {**root, **attributes.get(name, {})}
        nominal += [
            {"curve": name, **row}
            for row in stored_rows(curves, name, about, float(about["cell_area_nm2"]))
        ]
    write_csv(snakemake.output.nominal, nominal)
