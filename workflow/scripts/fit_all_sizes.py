"""The size effect from a scene's own runs and those of the study that differ in the asperity alone.

In:  hardness/points.csv, study/hardness.csv (GPa, nm).  Out: size_effect.json (n of H ~ L^-n, free fit).
"""

from atomistic.hardness.size_effect import free_fit, size_exponents
from atomistic.settings import HardnessSettings
from workflow.job import job
from workflow.results import load_csv, write_json

with job(snakemake) as run:
    fit = HardnessSettings.model_validate(snakemake.params.settings).fit
    of_scene = load_csv(snakemake.input.points)
    beyond = [row for row in load_csv(snakemake.input.study) if row["case"] in snakemake.params.cases]
    by_run = {row["run"]: row for row in [*beyond, *of_scene] if row["status"] == "yield"}
    points = list(by_run.values())
    write_json(
        snakemake.output.fit,
        {
            "runs": sorted(by_run),
            "size_effect": size_exponents(points, fit),
            "free_fit": {
                f"scale_{scale}": free_fit([row for row in points if row["energy_scale"] == scale], fit)
                for scale in sorted({row["energy_scale"] for row in points})
            },
        },
        run.provenance,
    )
