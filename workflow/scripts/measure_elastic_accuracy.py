"""Error of B and G against run time.  In: material, bulk moduli and points if any.  Out: accuracy/elastic.csv."""

from atomistic.elastic.networks import crystal
from atomistic.elastic.studies.accuracy import accuracy_points, constants_points, ensemble_points, shear_points
from atomistic.materials import load_material
from workflow.checks import accuracy_rows
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    material = load_material(snakemake.input.material)
    small = crystal(material, "beta", (1, 1, 1))
    doubled = crystal(material, "beta")
    rows = list(accuracy_rows("elastic", accuracy_points(small, doubled, run.progress)))
    rows += accuracy_rows("elastic", shear_points(doubled, run.progress))
    rows += accuracy_rows("elastic", constants_points(small, material.part("network_glass")))
    if snakemake.input.get("moduli"):
        clamped = [
            row
            for row in load_csv(snakemake.input.moduli)
            if row["structure"] not in material.crystals
            and (row["xc"], row["ions"], row["flags"]) == ("GGA", "clamped", "")
        ]
        names = {row["structure"] for row in clamped}
        cost = sum(float(p["wall_s"]) for p in load_csv(snakemake.input.points) if p["structure"] in names)
        rows += accuracy_rows("elastic", ensemble_points([float(row["B_GPa"]) for row in clamped], cost))
    write_csv(snakemake.output.table, rows)
