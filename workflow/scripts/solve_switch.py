"""Drive a switch with the samples of the law.

In: uq/samples.csv, law/parameters.csv (nm, GPa/nm, GPa).
Out: device/switch.json (V, nm, fF), device/release.csv, device/stiction.csv, device/path.csv.
"""

from mesoscale.device.behaviour import drive_switch, samples_of_rows, state_rows, stiction_rows, switch_path
from mesoscale.settings import DeviceSettings, LawSettings
from workflow.job import job
from workflow.results import load_csv, write_csv, write_json

with job(snakemake) as run:
    settings = DeviceSettings(**snakemake.params.settings)
    law = LawSettings(**snakemake.params.law)
    rows, fitted = load_csv(snakemake.input.samples), load_csv(snakemake.input.parameters)
    samples = samples_of_rows(rows, fitted, settings, law.rho_a_nm, law.shield_nm)
    # 1 GPa nm^2 = 1 nN
    law_pressure_MPa = snakemake.params.max_force_nN / snakemake.params.length_nm**2 * 1e3
    results, states = drive_switch(samples, settings, law_pressure_MPa)
    write_json(snakemake.output.switch, results, run.provenance)
    write_csv(snakemake.output.release, state_rows(states))
    write_csv(snakemake.output.stiction, stiction_rows(states))
    write_csv(snakemake.output.path, switch_path(samples, settings))
