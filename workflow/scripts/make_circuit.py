"""Make the switch for circuit simulators: central, corners and draws; its C-V loop and its transient.

In: inputs.csv, pad/model.h5.
Out: device/circuit/*.sub and *.va, device/circuit.json, device/circuit.csv, device/loop.csv (fF, V),
device/transient.csv (us).
"""

from dataclasses import asdict
from pathlib import Path

from mesoscale.device.circuit import Version, loops, study_on_pad, transient, versions
from mesoscale.device.lumps import lumps_of
from mesoscale.device.switch_export import spice_switch, verilog_lump
from workflow.job import job
from workflow.pad_files import load_model, points_of_job
from workflow.results import write_csv, write_json, write_text

with job(snakemake) as run:
    points, _ = points_of_job(snakemake)
    model = load_model([snakemake.input.model], points)
    pad = model.central.pressed
    study, law = study_on_pad(points.device, pad.law)
    spread = versions(model, points.table, points.on_grid, points.cutoffs_nm, study.lumps)
    run.progress(0.4, "draws and corners")
    states = {"pull_in_V": study.pull_in_V, "release_V": study.release_V}
    central = Version({"switch": "central"} | states, points.device.model_copy(update={"tilt_nm": 0.0}), law)
    drawn = [version for version in spread if not version.row["deviations"]]
    write_csv(snakemake.output.loop, loops(central, drawn))
    run.progress(0.6, "C-V loops")
    said, rows = transient(central, study.lumps)
    write_csv(snakemake.output.transient, rows)
    write_json(snakemake.output.summary, {"lumps": asdict(study), "transient": said}, run.provenance)
    write_csv(snakemake.output.table, [version.row for version in spread])
    for version in (central, *spread):
        lumps, path = lumps_of(version.settings, study.lumps), Path(snakemake.output.models) / version.row["switch"]
        write_text(path.with_suffix(".sub"), spice_switch(lumps, study, version.law, pad.cells.count))
        write_text(path.with_suffix(".va"), verilog_lump(lumps, version.law, pad.cells.count))
