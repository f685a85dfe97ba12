"""What the closing runs of a scene will cost.  Out: plan.csv."""

from atomistic.hardness.cost import plan_rows
from atomistic.settings import HardnessSettings
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    write_csv(snakemake.output.plan, plan_rows(HardnessSettings.model_validate(snakemake.params.settings)))
