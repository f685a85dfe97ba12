"""Assemble the pad from its points, and say what the switch does over all of them.

In: inputs.csv, pad/points/*.h5 (GPa against nm; V), config/effects.yaml.
Out: pad/model.h5, pad/inputs.csv (with the film's typical place, and how much places differ), pad/curves.csv (MPa
against nm), device/pad_switch.json, device/budget.csv (V), device/rough_pad.va, device/rough_pad.sub.
"""

from pathlib import Path

from asperity.guards.foreign_yaml import load_mapping
from mesoscale.circuit.spice import spice_pad
from mesoscale.circuit.verilog import verilog_pad
from mesoscale.device.budget import budget, effects_of
from mesoscale.device.release import switch_on_pad
from mesoscale.inputs.table import to_rows
from mesoscale.pad.memory import curve_rows
from workflow.files.results import write_csv, write_json, write_text
from workflow.run.job import job
from workflow.run.pads import load_model, points_of_job, write_solved

with job(snakemake) as run:
    points, _ = points_of_job(snakemake)
    model = load_model(snakemake.input.chunks, points)
    pad = model.central.pressed
    write_csv(snakemake.output.inputs, to_rows(points.table))
    write_solved(snakemake.output.model, dict(enumerate((model.central, *model.points))), run.provenance, points.design)
    write_csv(snakemake.output.table, curve_rows(pad.cells, pad.law))
    write_text(snakemake.output.verilog, verilog_pad(pad.law, pad.cells.count))
    write_text(snakemake.output.spice, spice_pad(pad.law, pad.cells.count))
    switch = switch_on_pad(model, points.contact.length_nm**2)
    write_json(snakemake.output.switch, switch, run.provenance)
    effects = effects_of(load_mapping(Path(snakemake.input.effects), "table of effects"))
    if points.contact.air or "humidity" in points.table.names:
        effects.pop("humid air", None)  # the answer holds it
    write_csv(snakemake.output.budget, budget(effects, switch, model.central))
