"""Assemble the pad from its cells, and drive the switch with it.

In: pad/inputs.csv, pad/grid.csv, pad/cells/*.h5 (nN), pad/draws/*.csv.
Out: pad/curves.h5 and pad/curves.csv (MPa against nm), pad/adhesion.csv, pad/compact.json,
device/pad_switch.json, device/rough_pad.va, device/rough_pad.sub.
"""

from dataclasses import asdict
from functools import cache, partial

import numpy as np

from mesoscale.device.electrode import releases_by_cells
from mesoscale.device.pad_export import spice_pad, verilog_pad
from mesoscale.device.pad_results import switch_on_pad
from mesoscale.device.release import try_answer
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows
from mesoscale.pad.compact import compact_summary
from mesoscale.pad.curves import adhesion_by_cells, curve_rows
from mesoscale.pad.memory import flats_of, law_of
from mesoscale.settings import DeviceSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.pad_files import load_cells, load_draws
from workflow.results import Dataset, load_csv, write_csv, write_h5, write_json, write_text

with job(snakemake) as run:
    contact = contact_settings(snakemake.params.contact, snakemake)
    area = contact.length_nm**2
    cells = load_cells(snakemake.input.grid, snakemake.input.chunks, area)
    grid = cells.grid
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    inputs = from_rows(load_csv(snakemake.input.inputs))
    middle, central = contact_of(inputs.medians(), contact)
    flats = flats_of(middle, central)

    table = curve_rows(cells)
    write_csv(snakemake.output.table, table)
    datasets = {
        "separation_nm": Dataset(grid.separation_nm, "nm", "mean separation", ("separation_nm",)),
        "depth_nm": Dataset(grid.depth_nm, "nm", "separation from which the pad is opened", ("depth_nm",)),
        "force": Dataset(np.arange(2), "1", "0: repulsive, 1: attractive", ("force",)),
        "closing_GPa": Dataset(
            cells.closing.mean(axis=0), "GPa", "repulsive and attractive pressure", ("force", "separation_nm")
        ),
        "opening_GPa": Dataset(
            cells.opening.mean(axis=0),
            "GPa",
            "repulsive and attractive pressure while opening from each depth",
            ("depth_nm", "force", "separation_nm"),
        ),
    }
    write_h5(snakemake.output.curves, {"pad": datasets}, {"cells": cells.count, **asdict(flats)}, run.provenance)
    write_csv(snakemake.output.adhesion, adhesion_by_cells(cells, [2**k for k in range(20)]))
    law = law_of(cells, flats)
    write_json(snakemake.output.compact, compact_summary(law), run.provenance)
    write_text(snakemake.output.verilog, verilog_pad(law, cells.count))
    write_text(snakemake.output.spice, spice_pad(law, cells.count))
    released = cache(partial(releases_by_cells, device, cells, flats))  # both below ask for them
    switch = switch_on_pad(cells, flats, device, area, released)
    if snakemake.input.draws:
        pads = load_draws(snakemake.input.draws, inputs, contact, *snakemake.params.design)
        switch |= try_answer(cells, pads, inputs, flats, device, central.gap_cutoff_nm, released, snakemake.threads)
    write_json(snakemake.output.switch, switch, run.provenance)
