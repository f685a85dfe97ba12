"""Close and open surfaces again and again at the medians of the inputs, held closed under creep if asked.

In: inputs.csv.  Out: history/cycles.csv (nm, nN), history/dwell.csv (s, nm) and, of the first surface,
history/curves.h5 (groups cycle_NNNN/closing|opening; nm, nN, nm^2).
"""

from dataclasses import asdict

from mesoscale.contact.cycle import BRANCH_COLUMNS
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.law.lifetime import cycle_row, dwell_rows, follow_all, shown_cycles
from mesoscale.settings import HistorySettings
from mesoscale.settings.contact import NOMINAL_SEED
from workflow.files.results import Dataset, load_csv, write_csv, write_h5
from workflow.run.contact_settings import contact_settings
from workflow.run.job import job, settings_from_job

with job(snakemake) as run:
    settings = settings_from_job(HistorySettings, snakemake.params.settings)
    contact = contact_settings(snakemake.params.contact, snakemake)
    middle = medians(load_csv(snakemake.input.inputs))
    inputs, contact = contact_of(middle, contact)
    cycles, dwell, groups, attributes = [], [], {}, {}
    shown = shown_cycles(settings)
    for seed, held in follow_all(inputs, contact, settings, run.progress):
        cycles.append(cycle_row(seed, held))
        dwell += dwell_rows(seed, held, contact, settings)
        if seed == NOMINAL_SEED and held.number in shown:
            name = f"cycle_{held.number:04d}"
            attributes[name] = {"cycle": held.number, "seed": seed, **middle}
            for branch in ("closing", "opening"):
                groups[f"{name}/{branch}"] = {
                    key: Dataset(values, *BRANCH_COLUMNS[key], ("separation_nm",))
                    for key, values in asdict(getattr(held.cycle, branch)).items()
                }
    write_csv(snakemake.output.cycles, cycles)
    write_csv(snakemake.output.dwell, dwell)
    write_h5(snakemake.output.curves, groups, {"cell_area_nm2": contact.length_nm**2}, run.provenance, attributes)
