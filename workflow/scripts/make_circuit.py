"""Make the switch for circuit simulators: central, corners and draws, and its slow C-V loop.

In: inputs.csv, pad/model.h5. Out: circuit/models/*.sub and *.va, circuit/circuit.json,
circuit/circuit.csv, circuit/loop.csv (fF, V).
"""

from dataclasses import asdict
from pathlib import Path

from mesoscale.circuit.lumps import lumps_of
from mesoscale.circuit.spice import spice_switch
from mesoscale.circuit.switches import central_switch, loops, spread_switches
from mesoscale.circuit.verilog import verilog_lump
from workflow.files.results import write_csv, write_json, write_text
from workflow.run.job import job
from workflow.run.pads import load_model, points_of_job

with job(snakemake) as run:
    points, _ = points_of_job(snakemake)
    model = load_model([snakemake.input.model], points)
    pad = model.central.pressed
    central, errors = central_switch(points.device, pad.curves)
    spread = spread_switches(model, points.table, points.on_grid, points.cutoffs_nm, errors.lumps)
    run.progress(0.5, "draws and corners")
    write_csv(
        snakemake.output.loop,
        loops(central, [switch for switch in spread if not switch.row["deviations"]]),
    )
    write_json(snakemake.output.summary, {"lumps": asdict(errors)}, run.provenance)
    write_csv(snakemake.output.table, [switch.row for switch in spread])
    for switch in (central, *spread):
        lumps = lumps_of(switch.settings, errors.lumps)
        path = Path(snakemake.output.models) / switch.row["switch"]
        netlist = spice_switch(lumps, errors, switch.pad, pad.count, switch.row["pull_in_V"])
        write_text(path.with_suffix(".sub"), netlist)
        write_text(path.with_suffix(".va"), verilog_lump(lumps, switch.pad, pad.count))
