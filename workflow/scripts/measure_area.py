"""Contact area of bodies of known section.

In:  potential (YAML), glass (LAMMPS data file); counter_glass, counter_potential where the counterface is of another
     oxide or potential: the second slab is then of these.
Out: accuracy/hardness_area.csv.
"""

import time
from pathlib import Path

from atomistic.hardness.closing import commensurate
from atomistic.hardness.studies.area import area_rows, pressed_layers
from atomistic.lammps import load_data
from atomistic.potentials import load_potential
from atomistic.settings import HardnessSettings
from workflow.checks import accuracy_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    settings = HardnessSettings.model_validate(snakemake.params.settings)
    potential = load_potential(snakemake.input.potential)
    glass = load_data(snakemake.input.glass, tuple(potential.materials[settings.material]))
    slabs = [(potential, glass)] * 2
    if counter := snakemake.input.get("counter_glass"):
        counter_potential = load_potential(snakemake.input.counter_potential)
        elements = tuple(counter_potential.materials[settings.closing.counter_material])
        slabs[1] = (counter_potential, commensurate(load_data(counter, elements), glass))
    points = []
    for scale, bodies in [*((scale, 1) for scale in settings.energy_scales), (settings.energy_scales[0], 2)]:
        started, cpu = time.perf_counter(), time.process_time()
        work = Path(snakemake.params.work) / f"{scale:g}_{bodies}"
        layers = pressed_layers(slabs[:bodies], scale, settings, work)
        names = " on ".join(dict.fromkeys(slab[0].name for slab in slabs[:bodies]))
        label = {"potential": names, "energy_scale": scale, "bodies": bodies}
        rows = list(area_rows(layers, settings.area, label))
        cost = {"wall_s": time.perf_counter() - started, "cpu_s": time.process_time() - cpu}
        points += [{**row, **cost} for row in rows]
    write_csv(snakemake.output.table, accuracy_rows("hardness", points))
