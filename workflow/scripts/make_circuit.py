"""Make the switch for circuit simulators: central, corners and draws; its C-V loop and its transient.

In: pad/inputs.csv, pad/grid.csv, pad/cells/*.h5 (nN), pad/draws/*.csv.
Out: device/circuit/*.va, device/circuit.json, device/circuit.csv, device/loop.csv (fF, V), device/transient.csv (us).
"""

from dataclasses import asdict
from pathlib import Path

from mesoscale.device.circuit import CORNERS, Version, loops, study_on_pad, transient, versions
from mesoscale.device.lumps import lumps_of
from mesoscale.device.release import cutoff_range, model_of
from mesoscale.device.switch_export import verilog_switch
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows
from mesoscale.pad.memory import flats_of, law_of
from mesoscale.settings import DeviceSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.pad_files import load_cells, load_draws
from workflow.results import load_csv, write_csv, write_json, write_text

with job(snakemake) as run:
    contact = contact_settings(snakemake.params.contact, snakemake)
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    inputs = from_rows(load_csv(snakemake.input.inputs))
    middle, settings = contact_of(inputs.medians(), contact)
    flats, cutoff = flats_of(middle, settings), settings.gap_cutoff_nm
    cells = load_cells(snakemake.input.grid, snakemake.input.chunks, contact.length_nm**2)
    draws = load_draws(snakemake.input.draws, inputs, contact, *snakemake.params.design)
    study, law = study_on_pad(device, law_of(cells, flats))
    model, cutoffs = model_of(cells, draws, inputs, flats, cutoff), cutoff_range(cutoff, draws)
    spread = versions(inputs, device, cutoffs, model, study.lumps)
    run.progress(0.4, "draws and corners")
    states = {"pull_in_V": study.pull_in_V, "release_V": study.release_V}
    central = Version({"switch": "central"} | states, device.model_copy(update={"tilt_nm": 0.0}), law)
    drawn = [version for version in spread if version.row["switch"] not in CORNERS]
    write_csv(snakemake.output.loop, loops(central, drawn))
    run.progress(0.6, "C-V loops")
    said, rows = transient(central, study.lumps)
    write_csv(snakemake.output.transient, rows)
    write_json(snakemake.output.summary, {"lumps": asdict(study), "transient": said}, run.provenance)
    write_csv(snakemake.output.table, [version.row for version in spread])
    for version in (central, *spread):
        text = verilog_switch(lumps_of(version.settings, study.lumps), study, version.law, cells.count)
        write_text(Path(snakemake.output.models) / f"{version.row['switch']}.va", text)
