"""Drive a switch with the samples of the law, and write the law for device and circuit simulators.

In: uq/samples.csv, law/parameters.csv, law/wells.csv (nm, GPa/nm, GPa).
Out: device/switch.json (V, nm, fF), device/release.csv, device/stiction.csv; device/law.csv (nm, GPa, GPa/nm),
device/law.json, device/asperity_contact.{sub,cir,va}.
"""

from pathlib import Path

import numpy as np

from mesoscale.device.behaviour import drive_switch, samples_json, samples_of_rows, state_rows
from mesoscale.device.export import law_table, spice_subcircuit, spice_testbench, verilog_module
from mesoscale.device.statistics import stiction_rows
from mesoscale.law.wells import well_note
from mesoscale.settings import DeviceSettings, LawSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.results import load_csv, write_csv, write_json, write_text

with job(snakemake) as run:
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    law = settings_from_job(LawSettings, snakemake.params.law)
    rows, fitted = load_csv(snakemake.input.samples), load_csv(snakemake.input.parameters)
    samples = samples_of_rows(rows, fitted, device, law.rho_a_nm, law.shield_nm)
    contact = contact_settings(snakemake.params.contact, snakemake)
    area_nm2 = contact.length_nm**2
    law_pressure_MPa = contact.max_force_nN / area_nm2 * 1e3  # 1 GPa nm^2 = 1 nN
    results, states = drive_switch(samples, device, law_pressure_MPa)
    write_json(snakemake.output.switch, results, run.provenance)
    write_csv(snakemake.output.release, state_rows(states))
    write_csv(snakemake.output.stiction, stiction_rows(states["with_adhesion"].critical_fraction))

    note = well_note(load_csv(snakemake.input.wells))
    write_csv(snakemake.output.table, law_table(samples.nominal, samples.laws))
    write_json(snakemake.output.samples, samples_json(samples, device) | {"adhesion_well": note}, run.provenance)
    write_text(snakemake.output.spice, spice_subcircuit(samples.nominal, area_nm2, note))
    write_text(snakemake.output.verilog, verilog_module(samples.nominal, area_nm2, note))
    separations = np.arange(0.0, 100.1, 0.25)
    deck = spice_testbench(Path(snakemake.output.spice).name, "asperity_contact.txt", separations)
    write_text(snakemake.output.testbench, deck)
