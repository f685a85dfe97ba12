"""Press the pads of some points, and solve the switch on each.

In: pad/inputs.csv.  Out: pad/points/chunk_NNN.h5 (GPa against nm; V). Number 0 is the point at central inputs.
"""

from mesoscale.device.points import on_pad_grid, solve_point, solve_points, surfaces_of
from mesoscale.settings import DeviceSettings, PadSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.pad_files import points_of, write_solved

with job(snakemake) as run:
    contact = contact_settings(snakemake.params.contact, snakemake)
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    pad = settings_from_job(PadSettings, snakemake.params.pad)
    points = points_of(snakemake.input.inputs, contact, device, pad.points)
    contact, solved = on_pad_grid(contact, points.table), {}
    numbers = range(*snakemake.params.bounds)
    if 0 in numbers:
        solved[0] = solve_point(points.by_number[0], contact, pad.cells, surfaces_of(0), run.progress)
    else:
        asked = [(number, points.by_number[number]) for number in numbers]
        for number, one in zip(numbers, solve_points(asked, contact, pad.point_cells), strict=True):
            solved[number] = one
            run.progress(len(solved) / len(numbers), f"{len(solved)} of {len(numbers)} points")
    write_solved(snakemake.output[0], solved, run.provenance)
