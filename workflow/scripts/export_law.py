"""Write the law for device and circuit simulators.

In: uq/samples.csv, law/parameters.csv, law/wells.csv (nm, GPa/nm, GPa).
Out: device/law.csv (nm, GPa, GPa/nm), device/law.json, device/asperity_contact.{sub,cir,va}.
"""

from pathlib import Path

import numpy as np

from mesoscale.device.behaviour import samples_json, samples_of_rows
from mesoscale.device.export import (
    law_table,
    spice_subcircuit,
    spice_testbench,
    verilog_module,
)
from mesoscale.law.wells import well_note
from mesoscale.settings import DeviceSettings, LawSettings
from workflow.job import job
from workflow.results import load_csv, write_csv, write_json, write_text

with job(snakemake) as run:
    settings = DeviceSettings(**snakemake.params.settings)
    law = LawSettings(**snakemake.params.law)
    rows, fitted = load_csv(snakemake.input.samples), load_csv(snakemake.input.parameters)
    samples = samples_of_rows(rows, fitted, settings, law.rho_a_nm, law.shield_nm)
    note = well_note(load_csv(snakemake.input.wells))
    area_nm2 = snakemake.params.length_nm**2
    write_csv(snakemake.output.table, law_table(samples.nominal, samples.laws))
    write_json(snakemake.output.samples, samples_json(samples, settings) | {"adhesion_well": note}, run.provenance)
    write_text(snakemake.output.spice, spice_subcircuit(samples.nominal, area_nm2, note))
    write_text(snakemake.output.verilog, verilog_module(samples.nominal, area_nm2, note))
    separations = np.arange(0.0, 100.1, 0.25)
    deck = spice_testbench(Path(snakemake.output.spice).name, "asperity_contact.txt", separations)
    write_text(snakemake.output.testbench, deck)
