"""Truth and estimate of a few sets of synthetic scans with random artefacts.

In: nothing.  Out: topography/recovery/sets_*.csv (1/nm, 1, nm; one row per set and method).
"""

from mesoscale.settings import TopographySettings
from mesoscale.topography.studies.recovery import COLUMNS, recovery_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    settings = TopographySettings(**snakemake.params.settings)
    same_everywhere = settings.synthetic.model_copy(update={"rms_variation": 0.0})
    first = snakemake.params.first
    sets = range(first, min(first + snakemake.params.sets, settings.study_sets))
    rows = []
    for row in recovery_rows(sets, same_everywhere, settings):
        rows.append(row)
        run.progress((row["set"] + 1 - first) / len(sets), f"set {row['set'] + 1}")
    write_csv(snakemake.output[0], rows, COLUMNS)
