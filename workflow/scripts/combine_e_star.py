"""Combine E*.  In: elastic/bulk_moduli.csv (GPa), counter body.  Out: e_star.json, e_star.h5, structures.csv."""

import json
from pathlib import Path

import yaml

from atomistic.elastic.moduli import Modulus, effective_modulus
from atomistic.settings import ElasticSettings
from workflow.job import job
from workflow.results import Dataset, read_csv, write_csv, write_h5, write_json

with job(snakemake) as run:
    settings = ElasticSettings(**snakemake.params.settings)
    counter_body = yaml.safe_load(Path(snakemake.input.counter_body).read_text(encoding="utf-8"))
    reports = [json.loads(Path(path).read_text(encoding="utf-8")) for path in snakemake.input.structures]
    gates = {report["structure"]: report["gate"] for report in reports}
    moduli = []
    for row in read_csv(snakemake.input.moduli):
        if row["structure"] in gates:  # crystals anchor the engine, they are not part of the ensemble
            reasons = [row["flags"]] if row["flags"] else []
            reasons += gates[row["structure"]]["reasons"]
            B = float(row["B_GPa"] or "nan")
            moduli.append(Modulus(row["structure"], row["xc"], row["ions"], B, not reasons, "; ".join(reasons)))
    summary, samples = effective_modulus(moduli, counter_body, settings)
    write_csv(
        snakemake.output.structures,
        [
            {
                "structure": report["structure"],
                "atoms": report["atoms"],
                "density_g_cm3": report["density_g_cm3"],
                **{key: report[key] for key in report if key.startswith("coordination_")},
                "bond_spread_A": report["bond_spread_A"],
                **report["relaxation"],
                "quenches": len(read_csv(attempts)),
                "status": "accepted"
                if report["gate"]["passed"]
                else "rejected: " + "; ".join(report["gate"]["reasons"]),
            }
            for report, attempts in zip(reports, snakemake.input.attempts, strict=True)
        ],
    )
    units = {"e_star_GPa": "GPa", "B_GPa": "GPa", "nu": "1", "counter_E_GPa": "GPa", "xc": "1"}
    names = {
        "e_star_GPa": "effective modulus E*",
        "B_GPa": "bulk modulus of the glass",
        "nu": "Poisson ratio of the glass",
        "counter_E_GPa": "Young modulus of the counter body",
        "xc": "functional: 0 GGA, 1 GGA + (LDA - GGA)",
    }
    group = {key: Dataset(values, units[key], names[key], ("sample",)) for key, values in samples.items()}
    write_h5(snakemake.output.samples, {"samples": group}, {"ions": settings.ions}, run.provenance)
    write_json(snakemake.output.e_star, summary, run.provenance)
