"""Error of B against run time.  In: material, bulk moduli, points.  Out: accuracy/elastic.csv."""

from atomistic.elastic.networks import crystal
from atomistic.elastic.studies import ensemble_points, volume_points
from atomistic.materials import load_material
from atomistic.settings import ElasticSettings
from workflow.files.results import load_csv, write_csv
from workflow.run.job import job, settings_from_job
from workflow.run.studies import accuracy_rows

with job(snakemake) as run:
    material = load_material(snakemake.input.material)
    settings = settings_from_job(ElasticSettings, snakemake.params.settings)
    glasses = [row for row in load_csv(snakemake.input.moduli) if row["structure"] not in material.crystals]
    clamped = [row for row in glasses if row["xc"] == "GGA" and not row["flags"]]
    names = {row["structure"] for row in clamped}
    cost = sum(float(p["wall_s"]) for p in load_csv(snakemake.input.points) if p["structure"] in names)
    rows = list(accuracy_rows("elastic", ensemble_points([float(row["B_GPa"]) for row in clamped], cost)))
    name = next(iter(material.crystals), "")
    small, larger = crystal(material, name, (1, 1, 1)), crystal(material, name)
    rows += accuracy_rows("elastic", volume_points(small, larger, settings, run.progress))
    write_csv(snakemake.output.table, rows)
