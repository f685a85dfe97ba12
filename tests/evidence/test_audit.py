"""The ranking of readings, on made-up engines that do and do not give the paper's tables."""

import csv
from pathlib import Path

import numpy as np
import pytest

from evidence.record import load
from evidence.uncertainty.audit import COUPLED, LAW_READINGS, MISPRINT, contact_readings, rank, with_reading
from mesoscale.inputs.table import collect
from mesoscale.law.parameters import LAW_OUTPUTS
from mesoscale.settings import ContactSettings, ReadingSettings
from mesoscale.uncertainty.collocation import nodes
from mesoscale.uncertainty.paper_tables import table2, table3
from tests.mesoscale import paper

PAPER = Path(__file__).parents[2] / "config" / "paper"
TABLE = collect(paper.INPUTS, {}, {})


def paper_rows(name):
    with (PAPER / name).open(newline="") as stream:
        return list(csv.DictReader(stream))


TWO, THREE = table2(paper_rows("table2.csv")), table3(paper_rows("table3.csv"))


def made_up(shift=0.0, scatter=0.0, missing=False):
    """Outputs (seeds, nodes, outputs) of an engine linear with the paper's means and mu*, off by `shift` deviations."""
    rng = np.random.default_rng(0)
    y = np.empty((6, 15, len(LAW_OUTPUTS)))
    for seed in range(6):
        off = shift + scatter * rng.normal()
        for node, u in enumerate(nodes(7)):
            for k, output in enumerate(LAW_OUTPUTS):
                mean, deviation = TWO[output.short]
                effects = [x if (x := THREE[output.short][key]) < MISPRINT * deviation else 0.0 for key in TABLE.names]
                y[seed, node, k] = mean + off * deviation + u @ np.array(effects) / 2
    if missing:
        y[1, 3, 3] = np.nan
    return y


def ranking(**groups):
    return rank({(name, "force_0.03"): y for name, y in groups.items()}, TABLE, [TWO], [THREE])


def test_the_papers_own_numbers_rank_first_at_almost_no_distance():
    best, second, third = ranking(far=made_up(2.0), exact=made_up(), near=made_up(0.5))
    assert [row["contact"] for row in (best, second, third)] == ["exact", "near", "far"]
    # the tables agree with each other to 3 %, but for the deviation of delta_C_a and delta_C_r (docs)
    assert best["distance_table3"] == pytest.approx(0.0, abs=1e-9)
    assert best["mean_d_c"] == pytest.approx(31.8)
    assert second["distance_table2"] > best["distance_table2"]


def test_intervals_come_from_the_scatter_of_seeds():
    sharp, blurred = ranking(sharp=made_up(1.0), blurred=made_up(1.0, scatter=0.5))
    rows = {row["contact"]: row for row in (sharp, blurred)}
    assert rows["sharp"]["distance_high"] - rows["sharp"]["distance_low"] == pytest.approx(0.0, abs=1e-9)
    assert rows["blurred"]["distance_low"] < rows["blurred"]["distance"] < rows["blurred"]["distance_high"]


def test_a_seed_with_a_missing_fit_is_counted_and_left_out():
    (row,) = ranking(holed=made_up(missing=True))
    assert row["missing"] == 1
    assert row["mean_rho_r"] == pytest.approx(3.31)


def test_readings_become_settings():
    reading = with_reading("areal.paper.hertz.truncation.sites.false", ContactSettings()).reading
    assert (reading.convention, reading.flow_pair, reading.prefactor) == ("areal", "paper", "hertz")
    assert (reading.radius, reading.area, reading.touching_attracts) == ("truncation", "sites", False)
    assert len(contact_readings()) == 48
    assert set(LAW_READINGS) >= {"first_contact", "force_0.03"}


def test_the_nearest_reading_is_the_default_and_can_be_audited_with_coupled_asperities():
    first = load("uncertainty.audit")[0]
    assert first["law"] == "first_contact"
    for contact in (ContactSettings(), paper.CONTACT):
        assert with_reading(first["contact"], contact) == contact
    coupled = with_reading(f"{first['contact']}.{COUPLED}", ContactSettings(reading=ReadingSettings(prefactor="paper")))
    assert coupled == with_reading(first["contact"], ContactSettings(mechanics="coupled"))
