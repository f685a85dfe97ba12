"""Hold the switches of all points for a life, and say what charge does to them.

In: inputs.csv, pad/model.h5; with a measured drift lifetime/rates.json.  Out: lifetime/lifetime.csv
and lifetime/holds.csv (V, s), lifetime/lifetime.json; lifetime/ageing.csv where the scene states
ageing.
"""

from mesoscale.charging.lifetime import hold_rows, life_rows, lives_of, summary
from mesoscale.charging.rates import narrowed_guesses
from mesoscale.settings import LifetimeSettings
from workflow.files.results import load_json, write_csv, write_json
from workflow.run.job import job, settings_from_job
from workflow.run.pads import load_model, points_of_job

with job(snakemake) as run:
    points, _ = points_of_job(snakemake)
    settings = settings_from_job(LifetimeSettings, snakemake.params.lifetime)
    model = load_model([snakemake.input.model], points)
    by_guess = None
    if narrowed := snakemake.input.get("rates"):
        by_guess = narrowed_guesses(load_json(narrowed))
    lives = lives_of(model, points.on_grid, settings, run.progress, by_guess)
    write_csv(snakemake.output.life, life_rows(lives))
    holds = list(hold_rows(lives))
    write_csv(snakemake.output.holds, holds)
    if path := snakemake.output.get("ageing"):
        from mesoscale.charging.ageing import ageing_rows

        write_csv(path, ageing_rows(lives.central))
    write_json(snakemake.output.summary, summary(lives, holds), run.provenance)
