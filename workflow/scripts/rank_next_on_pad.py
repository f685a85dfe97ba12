"""Rank what to measure next for the switch on the pad.

In: calibration/priors.csv, pad/inputs.csv, calibration/cycles/chunk_NNN.csv, calibration/local_cycles.csv,
pad/grid.csv, pad/cells/*.h5 (nN), pad/draws/*.csv.
Out: calibration/next_on_pad.csv (V), without rows where the draws do not give switches on the pad.
"""

from functools import partial

from mesoscale.calibration.further import next_on_pad
from mesoscale.calibration.likelihood import posterior_of
from mesoscale.calibration.posterior import cycles_of_rows, expected_of, responses_of
from mesoscale.device.release import cutoff_range, released_on_pad
from mesoscale.errors import InputError
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows
from mesoscale.pad.memory import flats_of
from mesoscale.settings import DeviceSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.pad_files import load_cells, load_draws
from workflow.results import load_csv, write_csv

POINTS = 128
"""Switches that are solved; made-up data leave a tenth to a half of them with weight."""

with job(snakemake) as run:
    contact = contact_settings(snakemake.params.contact, snakemake)
    prior, inputs = from_rows(load_csv(snakemake.input.priors)), from_rows(load_csv(snakemake.input.inputs))
    rows = [row for path in (*snakemake.input.cycles, snakemake.input.local_cycles) for row in load_csv(path)]
    cycles = cycles_of_rows(rows, prior.names)
    cells = load_cells(snakemake.input.grid, snakemake.input.cells, contact.length_nm**2)
    draws = load_draws(snakemake.input.draws, inputs, contact, *snakemake.params.design)
    central = contact_of(inputs.medians(), contact)
    cutoffs = cutoff_range(central[1].gap_cutoff_nm, draws)
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    responses, laws = responses_of(prior, cycles)
    given = partial(
        posterior_of,
        prior,
        responses=responses,
        law_responses=laws,
        switch=None,
        max_force_nN=contact.max_force_nN,
        expected=expected_of(cycles),
    )
    ranked = []
    try:
        x, volts = released_on_pad(cells, draws, inputs, flats_of(*central), device, cutoffs, POINTS)
    except InputError as error:
        print(error, file=run.log, flush=True)  # answer_status of device/pad_switch.json has it, too
    else:
        x = x[:, [inputs.names.index(name) for name in prior.names]]  # how places differ is no input of a cell
        ranked = next_on_pad(given, responses, x, volts, contact.max_force_nN)
        ranked = [{**row, "solved": len(volts), "refused": POINTS - len(volts)} for row in ranked]
    write_csv(snakemake.output[0], ranked)
