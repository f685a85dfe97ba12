"""Anchors beside published values.  In: accuracy/anchors/*.csv, materials.  Out: accuracy/elastic_anchors.csv."""

from atomistic.elastic.energy_scans import fit_scan
from atomistic.materials import load_material
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    published = {}
    for path in snakemake.input.materials:
        published |= {name: data.published for name, data in load_material(path).crystals.items()}
    rows = []
    for path in snakemake.input.points:
        scan = load_csv(path)
        fit = fit_scan(scan)
        known = published[fit["structure"]]
        kind = fit["xc"] if fit["xc"] in known else "experiment"
        value = known[kind]
        atoms = int(fit["atoms"])
        rows.append(
            {
                **{key: fit[key] for key in ("structure", "xc", "atoms", "B_GPa", "B_prime", "residual_meV", "flags")},
                "V0_A3": fit["V0_A3"] * value.atoms / atoms if fit["V0_A3"] else None,
                "V0_atoms": value.atoms,
                "published": kind,
                "published_B_GPa": value.B_GPa,
                "published_V0_A3": value.V0_A3,
                "published_source": " ".join(value.source),
                "wall_s": round(sum(float(point["wall_s"]) for point in scan), 1),
            }
        )
    write_csv(snakemake.output.table, rows)
