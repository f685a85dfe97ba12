"""Propagate the inputs' uncertainty through the responses, validate these, and rank the inputs.

In: inputs.csv, law/parameters.csv, the paper's Tables 2 and 3; of uncertainty/:
direct/chunk_NNN.csv, direct/chunk_again.csv. Out, in uncertainty/: outputs.csv (Table 2),
sensitivity.csv (Table 3), surrogate.json, samples.csv, validation.csv,
law.csv (nm, GPa/nm, GPa).
"""

import numpy as np

from mesoscale.inputs.table import from_rows
from mesoscale.law.compact import Law
from mesoscale.law.parameters import FITTED
from mesoscale.law.samples import band_rows
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.paper_tables import table2, table3
from mesoscale.uncertainty.propagation import nodes_of_rows, output_rows, propagate, surrogate_json
from mesoscale.uncertainty.sensitivity import sensitivity_rows
from mesoscale.uncertainty.validation import direct_runs_of_rows, validation_rows
from workflow.files.results import load_csv, write_csv, write_json
from workflow.run.job import job, settings_from_job

with job(snakemake) as run:
    settings = settings_from_job(UncertaintySettings, snakemake.params.settings)
    table = from_rows(load_csv(snakemake.input.inputs))
    nodes = nodes_of_rows(load_csv(snakemake.input.parameters))
    paper_rows = load_csv(snakemake.input.table2)
    paper = table2(paper_rows)

    direct = direct_runs_of_rows(
        (row for path in snakemake.input.direct for row in load_csv(path)),
        table.names,
        settings.direct_runs,
    )

    result = propagate(nodes, table, settings, direct)
    outputs = output_rows(nodes, result, direct, paper, table2(paper_rows, exchanged=True))
    write_csv(snakemake.output.outputs, outputs)
    most_GPa = snakemake.params.max_force_nN / snakemake.params.length_nm**2  # 1 GPa nm^2 = 1 nN
    constants = {"rho_a_nm": Law.rho_a_nm, "alpha_nm": Law.shield_nm, "most_GPa": most_GPa}
    write_json(snakemake.output.surrogate, surrogate_json(result, table, constants), run.provenance)
    names = [*table.names, *FITTED]
    values = np.hstack([result.samples, result.outputs])
    write_csv(
        snakemake.output.samples, (dict(zip(names, line, strict=True)) for line in values.tolist())
    )
    columns = dict(zip(names, values.T, strict=True))
    write_csv(snakemake.output.law, band_rows(columns))

    repeated = (row for path in snakemake.input.again for row in load_csv(path))
    again = direct_runs_of_rows(repeated, table.names, settings.direct_runs)[1]
    write_csv(
        snakemake.output.validation,
        validation_rows(direct, table, result, settings, again, most_GPa),
    )

    run.progress(0.5, "validated; ranks the inputs")
    # None is not a number
    seeds_shares = np.array([row["seed_share"] for row in outputs], dtype=float)
    effects = load_csv(snakemake.input.table3)
    printed = table3(effects), table3(effects, as_printed=True)
    write_csv(
        snakemake.output.sensitivity,
        sensitivity_rows(nodes, table, settings, seeds_shares, *printed, direct),
    )
