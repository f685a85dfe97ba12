"""Hardness, or the reason why there is none, of each closing run.

In:  closing/*.csv, witness/*.csv (GPa, nm), runs/*.json.  Out: points.csv.
"""

from atomistic.hardness import find_hardness
from atomistic.settings import HardnessSettings
from workflow.job import job
from workflow.results import read_csv, read_json, write_csv

with job(snakemake) as run:
    settings = HardnessSettings(**snakemake.params.settings)
    rows = []
    for curve_path, witness_path, summary_path in zip(
        snakemake.input.curves, snakemake.input.witnesses, snakemake.input.summaries, strict=True
    ):
        curve, witness = (
            [{name: float(value or "nan") for name, value in row.items()} for row in read_csv(path)]
            for path in (curve_path, witness_path)
        )
        facts = read_json(summary_path)
        found = find_hardness(curve, witness, facts["wavelength_nm"] ** 2, settings.closing, settings.plasticity)
        rows.append(
            {
                "run": facts["run"],
                "potential": settings.potential,
                "energy_scale": facts["energy_scale"],
                "geometry": f"asperity-{settings.closing.protocol}",
                "asperity": facts["asperity"],
                "wavelength_nm": facts["wavelength_nm"],
                "amplitude_nm": facts["amplitude_nm"],
                "seed": facts["seed"],
                "atoms": facts["atoms"],
                **found.row(),
            }
        )
    write_csv(snakemake.output.points, rows)
