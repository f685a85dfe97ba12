"""Close the pads of one case to several loads and open them.

In: pad/inputs.csv.  Out: adhesion/pads/case_NNN.csv (uJ/m^2, kPa, nm; uN and mJ/m^2 of a sphere).
"""

from mesoscale.errors import InputError
from mesoscale.inputs.table import medians
from mesoscale.pad.adhesion import plan_cases, rows_of_case
from mesoscale.settings import AdhesionSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    adhesion = settings_from_job(AdhesionSettings, snakemake.params.adhesion)
    if adhesion.pads == 0:
        raise InputError("adhesion.pads = 0: no pad to open; give at least 2, or take scene adhesion")
    contact = contact_settings(snakemake.params.contact, snakemake)
    cases = plan_cases(medians(load_csv(snakemake.input.inputs)), contact, adhesion)
    case = cases[int(snakemake.wildcards.adhesion_case)]
    write_csv(snakemake.output[0], list(rows_of_case(case, adhesion, run.progress)))
