"""What the switch does on the pad, over all that is uncertain.

In: inputs.csv, pad/model.h5 (GPa against nm; V), config/effects.yaml, hardness/fit.json where the
scene uses it. Out: answer/pad_switch.json, answer/budget.csv (V), answer/errors.csv (V),
answer/rough_pad.va, answer/rough_pad.sub.
"""

from pathlib import Path

from asperity.guards.foreign_yaml import load_mapping
from mesoscale.answer.budget import OF_RUNS, budget, effects_of, left_open, with_twins
from mesoscale.answer.other_devices import release_by_hardness
from mesoscale.answer.release import switch_on_pad
from mesoscale.answer.reserve import central_reserve, freed_by_surface
from mesoscale.answer.sticking import sticking_by_key
from mesoscale.circuit.spice import spice_pad
from mesoscale.circuit.verilog import verilog_pad
from mesoscale.studies.own_errors import of_switch
from workflow.files.results import load_json, write_csv, write_json, write_text
from workflow.run.job import job
from workflow.run.pads import load_model, points_of_job

with job(snakemake) as run:
    points, settings = points_of_job(snakemake)
    model = load_model([snakemake.input.model], points)
    pad = model.central.pressed
    write_text(snakemake.output.verilog, verilog_pad(pad.curves, pad.count))
    write_text(snakemake.output.spice, spice_pad(pad.curves, pad.count))
    switch = switch_on_pad(model, points.contact.length_nm**2)
    reserve = central_reserve(model.central)
    if reserve and model.central.sticks:
        reserve["freed_by"] += freed_by_surface(model.central, points.on_grid, settings.cells)
    switch["reserve"] = reserve
    contact = points.contact
    switch["sticking_by_key"] = sticking_by_key(model, points.table, contact, points.device)
    if points.device.measured:
        from mesoscale.answer.measured import what_remains  # compiles

        switch["measured"] = what_remains(points.device)
    write_json(snakemake.output.switch, switch, run.provenance)
    effects = effects_of(load_mapping(Path(snakemake.input.effects), "table of effects"))
    effects = left_open(effects, snakemake.params.stated)
    if computed := snakemake.input.get("hardness"):
        effects = with_twins(effects, load_json(computed)["twins"])
    else:
        effects = {name: effect for name, effect in effects.items() if name not in OF_RUNS}
    factors = [effect.hardness for effect in effects.values() if effect.hardness is not None]
    central = model.central.point
    releases = release_by_hardness(central, points.on_grid, settings.point_cells, factors)
    errors = list(of_switch(central, points.on_grid, settings.point_cells, pad.curves))
    write_csv(snakemake.output.errors, ({"stage": "answer", **row} for row in errors))
    errors_V = {row["knob"]: row["release_V"] for row in errors}
    write_csv(snakemake.output.budget, budget(effects, switch, model.central, releases, errors_V))
