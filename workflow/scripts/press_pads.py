"""Press the pads of some points, and solve the switch on each.

In: inputs.csv.  Out: pad/points/chunk_NNN.h5 (GPa against nm; V). Number 0 is the point at central
inputs, whose job also writes report.html, as far as it is known then.
"""

from pathlib import Path

from mesoscale.answer.switches import PadModel, solve_point, solve_points, surfaces_of
from workflow.files.results import write_text
from workflow.run.job import job
from workflow.run.pads import points_of_job, write_solved

numbers = range(*snakemake.params.bounds)
is_central = 0 in numbers  # its job also draws the first page

with job(snakemake, shared=not is_central) as run:
    points, pad = points_of_job(snakemake)
    solved = {}
    follows = False
    if is_central:
        solved[0] = solve_point(
            points.by_number[0], points.on_grid, pad.cells, surfaces_of(0), run.progress
        )
        follows = pad.points > 0 and not solved[0].refused
        run.say(
            f"at central inputs {solved[0].outcome}{'; its interval follows' if follows else ''}"
        )
    else:
        points_here = [(number, points.by_number[number]) for number in numbers]
        for number, result in zip(
            numbers, solve_points(points_here, points.on_grid, pad.point_cells), strict=True
        ):
            solved[number] = result
            run.progress(len(solved) / len(numbers), f"{len(solved)} of {len(numbers)} points")
    write_solved(snakemake.output[0], solved, run.provenance)
    # not where a calibration presses pads of the prior
    if follows and snakemake.rule.endswith("press_pads"):
        from workflow.report.early import early_page  # the other jobs draw nothing

        root = Path(snakemake.output[0]).parents[2]
        central = PadModel(solved[0], points.design, ())
        # of the same job
        spectra = [path.replace("parameters.json", "spectra.h5") for path in snakemake.input]
        files = sorted({*snakemake.input, *spectra})
        area = points.contact.length_nm**2
        write_text(
            root / "report.html", early_page(root, files, central, area, dict(snakemake.params))
        )
        run.say(f"{root / 'report.html'} shows it, and at the end of the run its interval")
