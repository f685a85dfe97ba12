"""Contact cycles at the medians of the inputs (the means, where they are symmetric), for figures 4
and 11; a picture.

In: inputs.csv.  Out: contact/nominal.h5 (groups <model>/closing|opening and load_<F
nN>/closing|opening; nm, nN, nm^2), with inputs, seed, largest force and flags as attributes of the
group of each curve; contact/spots.h5 (the surface and where the flat has reached it, on the closing
to the largest force); contact/errors.csv (numerical errors).
"""

from dataclasses import asdict

from mesoscale.contact.cycle import BRANCH_COLUMNS
from mesoscale.contact.nominal import nominal_cycles
from mesoscale.contact.spots import spots_under
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.settings.contact import NOMINAL_SEED
from mesoscale.studies.own_errors import of_contact
from workflow.files.results import Dataset, load_csv, write_csv, write_h5
from workflow.run.contact_settings import contact_settings
from workflow.run.job import job

with job(snakemake) as run:
    middle = medians(load_csv(snakemake.input.inputs))
    inputs, settings = contact_of(middle, contact_settings(snakemake.params.settings, snakemake))
    groups = {}
    attributes = {}
    cycles = []
    for name, chosen, force, cycle in nominal_cycles(inputs, settings, run.progress):
        cycles.append((force, cycle))
        attributes[name] = {
            **middle,
            "model": chosen.model,
            "seed": NOMINAL_SEED,
            "max_force_nN": force,
            "converged": cycle.converged,
            "first_contact_nm": cycle.first_contact_nm,
            "last_contact_nm": cycle.last_contact_nm,
            **cycle.flags,
        }
        for branch, curve in (("closing", cycle.closing), ("opening", cycle.opening)):
            groups[f"{name}/{branch}"] = {
                key: Dataset(values, *BRANCH_COLUMNS[key], ("separation_nm",))
                for key, values in asdict(curve).items()
            }
    reading = {"cell_area_nm2": settings.length_nm**2, "contact": settings.model_dump(mode="json")}
    write_h5(snakemake.output.nominal, groups, reading, run.provenance, attributes)
    spots = spots_under(inputs, settings, max(cycles, key=lambda pair: pair[0])[1])
    datasets = {
        "towards_flat_nm": Dataset(
            spots.towards_flat_nm, "nm", "height towards the flat", ("x", "y")
        ),
        "step": Dataset(
            spots.step, "1", "first step at which the flat reaches the pixel; -1: never", ("x", "y")
        ),
        "separation_nm": Dataset(
            spots.separation_nm, "nm", "mean separation of the step", ("number",)
        ),
        "repulsive_nN": Dataset(spots.repulsive_nN, "nN", "repulsive force", ("number",)),
        "asperities": Dataset(spots.asperities, "1", "asperities in contact", ("number",)),
        "cut_share": Dataset(
            spots.cut_share, "1", "share of the area that the flat has reached", ("number",)
        ),
    }
    write_h5(
        snakemake.output.spots,
        {"spots": datasets},
        {"length_nm": settings.length_nm},
        run.provenance,
    )
    write_csv(
        snakemake.output.errors,
        ({"stage": "contact", **row} for row in of_contact(inputs, settings)),
    )
