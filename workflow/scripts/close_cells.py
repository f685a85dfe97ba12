"""Close and open some cells of the pad.

In: pad/inputs.csv, pad/grid.csv.  Out: pad/cells/chunk_NNN.h5 (nN at the separations of the grid).
"""

import numpy as np

from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.pad.cells import FIRST_SEED, close_cells, grid_of_rows
from workflow.contact_settings import contact_settings
from workflow.job import job
from workflow.results import Dataset, load_csv, load_numbers, write_h5

with job(snakemake) as run:
    inputs, contact = contact_of(
        medians(load_csv(snakemake.input.inputs)), contact_settings(snakemake.params.contact, snakemake)
    )
    grid = grid_of_rows(load_numbers(snakemake.input.grid))
    seeds = [FIRST_SEED + number for number in range(*snakemake.params.bounds)]
    cells = list(close_cells(inputs, contact, grid, seeds, run.progress))
    group = {
        "seed": Dataset(seeds, "1", "seed of the surface", ("cell",)),
        "first_contact_nm": Dataset([cell.first_contact_nm for cell in cells], "nm", "first contact", ("cell",)),
        "settled": Dataset([int(cell.settled) for cell in cells], "1", "whether flow came to rest", ("cell",)),
        "closing_nN": Dataset(
            np.array([cell.closing for cell in cells]),
            "nN",
            "repulsive and attractive force while closing",
            ("cell", "force", "separation"),
        ),
        "opening_nN": Dataset(
            np.array([cell.opening for cell in cells]),
            "nN",
            "repulsive and attractive force while opening from each depth; NaN below it",
            ("cell", "depth", "force", "separation"),
        ),
    }
    write_h5(snakemake.output[0], {"cells": group}, {}, run.provenance)
