"""Write the report page from the result files of the scene's stages.

In: result files of all stages that the scene needs.  Out: report.html, self-contained.
"""

from workflow.job import job
from workflow.report.available import Results
from workflow.report.render import render
from workflow.results import write_text

with job(snakemake) as run:
    shown = [path for path in snakemake.input if path not in set(snakemake.input.style)]
    shown += snakemake.params.studies
    write_text(snakemake.output[0], render(Results(snakemake.params.root, shown, snakemake.params.scene)))
