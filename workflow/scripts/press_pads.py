"""Press the pads of some points, and solve the switch on each.

In: inputs.csv.  Out: pad/points/chunk_NNN.h5 (GPa against nm; V). Number 0 is the point at central inputs.
"""

from mesoscale.device.points import solve_point, solve_points, surfaces_of
from workflow.run.job import job
from workflow.run.pads import points_of_job, write_solved

with job(snakemake) as run:
    points, pad = points_of_job(snakemake)
    numbers, solved = range(*snakemake.params.bounds), {}
    if 0 in numbers:
        solved[0] = solve_point(points.by_number[0], points.on_grid, pad.cells, surfaces_of(0), run.progress)
        run.say(f"at central inputs {solved[0].outcome}{'; its interval follows' if pad.points else ''}")
    else:
        asked = [(number, points.by_number[number]) for number in numbers]
        for number, one in zip(numbers, solve_points(asked, points.on_grid, pad.point_cells), strict=True):
            solved[number] = one
            run.progress(len(solved) / len(numbers), f"{len(solved)} of {len(numbers)} points")
    write_solved(snakemake.output[0], solved, run.provenance)
