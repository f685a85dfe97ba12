"""False and missed yield at the noise of the closing runs.

In:  closing/*.csv, witness/*.csv (GPa, nm), points.csv.  Out: accuracy/hardness_detection.csv.
"""

import time

from atomistic.hardness.studies.detection import detection_points
from atomistic.settings import HardnessSettings
from workflow.checks import accuracy_rows
from workflow.job import job
from workflow.results import load_csv, load_numbers, write_csv

with job(snakemake) as run:
    started, cpu = time.perf_counter(), time.process_time()
    points = detection_points(
        [load_numbers(path) for path in snakemake.input.curves],
        [load_numbers(path) for path in snakemake.input.witnesses],
        [float(point["wavelength_nm"]) ** 2 for point in load_csv(snakemake.input.points)],
        HardnessSettings.model_validate(snakemake.params.settings),
    )
    cost = {"wall_s": time.perf_counter() - started, "cpu_s": time.process_time() - cpu}
    write_csv(snakemake.output.table, accuracy_rows("hardness", [{**point, **cost} for point in points]))
