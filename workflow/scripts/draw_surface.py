"""Draw a map of the surface with its colour bar, and its spectrum with the trusted range.

In: topography/spectra.h5, topography/parameters.json.  Out: topography/surface.png.
"""

from workflow.job import job
from workflow.report.surface_picture import surface_picture
from workflow.results import atomic_path, load_h5, load_json

with job(snakemake) as run:
    groups, _, attributes = load_h5(snakemake.input.spectra)
    with atomic_path(snakemake.output[0]) as temporary:
        surface_picture(groups, attributes, load_json(snakemake.input.parameters), temporary)
