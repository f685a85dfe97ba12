"""What the closing runs of a scene will cost.

In: materials (YAML), base: that of the body below films.  Out: plan.csv.
"""

from atomistic.hardness.cost import plan_rows
from atomistic.hardness.stack import base_of
from atomistic.materials import load_material
from atomistic.settings import HardnessSettings
from workflow.job import job, settings_from_job
from workflow.results import write_csv

with job(snakemake) as run:
    settings = settings_from_job(HardnessSettings, snakemake.params.hardness)
    material, counter_material = (load_material(snakemake.input[key]) for key in ("material", "counter_material"))
    base = base_of(load_material(snakemake.input.base)) if snakemake.input.get("base") else None
    write_csv(snakemake.output.plan, plan_rows(settings, material, counter_material, base))
