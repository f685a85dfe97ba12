"""The ranking of readings, on made-up engines that do and do not give the paper's tables."""

import csv
from pathlib import Path

import numpy as np
import pytest

from mesoscale.inputs.table import collect
from mesoscale.law.parameters import LAW_OUTPUTS
from mesoscale.settings import ContactSettings, LawSettings
from mesoscale.uncertainty.collocation import nodes
from mesoscale.uncertainty.paper_tables import table2, table3
from mesoscale.uncertainty.studies.audit import LAW_READINGS, MISPRINT, rank, with_reading
from mesoscale.uncertainty.studies.readings import NEAREST, audited_readings, contact_readings
from tests.mesoscale import paper

PAPER = Path(__file__).parents[3] / "config" / "paper"
TABLE = collect(paper.INPUTS, {}, {}, 0.999)


def paper_rows(name):
    with (PAPER / name).open(newline="") as stream:
        return list(csv.DictReader(stream))


TWO, THREE = table2(paper_rows("table2.csv")), table3(paper_rows("table3.csv"))


def made_up(reading, shift=0.0, scatter=0.0, missing=False):
    """Rows of an engine that is linear with the paper's means and mu*, off by `shift` deviations."""
    rng = np.random.default_rng(0)
    rows = []
    for seed in range(6):
        off = shift + scatter * rng.normal()
        for node, u in enumerate(nodes(7, 1)):
            row = {"contact": reading, "law": "force_0.03", "seed": str(seed), "node": str(node), "converged": "True"}
            for output in LAW_OUTPUTS:
                mean, deviation = TWO[output.short]
                effects = [x if (x := THREE[output.short][key]) < MISPRINT * deviation else 0.0 for key in TABLE.names]
                row[output.name] = repr(float(mean + off * deviation + u @ np.array(effects) / 2))
            if missing and (seed, node) == (1, 3):
                row["rho_r_nm"] = ""
            rows.append(row)
    return rows


def ranking(*groups):
    return rank([row for group in groups for row in group], TABLE, 0.999, [TWO], [THREE])


def test_the_papers_own_numbers_rank_first_at_almost_no_distance():
    best, second, third = ranking(made_up("far", 2.0), made_up("exact"), made_up("near", 0.5))
    assert [row["contact"] for row in (best, second, third)] == ["exact", "near", "far"]
    # the tables agree with each other to 3 %, but for the deviation of delta_C_a and delta_C_r (docs)
    assert best["distance_table3"] == pytest.approx(0.0, abs=1e-9)
    assert best["mean_d_c"] == pytest.approx(31.8)
    assert second["distance_table2"] > best["distance_table2"]


def test_intervals_come_from_the_scatter_of_seeds():
    sharp, blurred = ranking(made_up("sharp", 1.0), made_up("blurred", 1.0, scatter=0.5))
    rows = {row["contact"]: row for row in (sharp, blurred)}
    assert rows["sharp"]["distance_high"] - rows["sharp"]["distance_low"] == pytest.approx(0.0, abs=1e-9)
    assert rows["blurred"]["distance_low"] < rows["blurred"]["distance"] < rows["blurred"]["distance_high"]


def test_a_seed_with_a_missing_fit_is_counted_and_left_out():
    (row,) = ranking(made_up("holed", missing=True))
    assert row["missing"] == 1
    assert row["mean_rho_r"] == pytest.approx(3.31)


def test_readings_become_settings():
    settings = with_reading("areal.paper.hertz.truncation.sites.false", ContactSettings())
    assert (settings.convention, settings.flow_pair, settings.prefactor) == ("areal", "paper", "hertz")
    assert (settings.radius, settings.area, settings.touching_attracts) == ("truncation", "sites", False)
    assert len(audited_readings(())) == 16
    assert audited_readings(("all",)) == contact_readings()
    assert set(LAW_READINGS) >= {"first_contact", "force_0.03", "free_fit"}


def test_mended_readings_end_with_their_choices():
    names = audited_readings(("mended",))
    assert len(names) == 4
    assert with_reading(names[0], ContactSettings()) == with_reading(NEAREST, ContactSettings()) == ContactSettings()
    settings = with_reading(f"{NEAREST}.flattened.not_less", ContactSettings())
    assert (settings.unloading_radius, settings.merge) == ("flattened", "not_less")
    assert settings.touching_attracts is False


def test_the_nearest_reading_can_be_audited_with_coupled_asperities():
    name = f"{NEAREST}.coupled"
    assert audited_readings((name,)) == [name]
    settings = with_reading(name, ContactSettings(prefactor="paper"))
    assert settings == with_reading(NEAREST, ContactSettings(mechanics="coupled"))


def test_the_default_is_the_reading_that_the_audit_puts_first():
    with (PAPER.parents[1] / "docs" / "data" / "audit.csv").open(newline="") as stream:
        first = next(csv.DictReader(stream))
    for contact, law in (
        (ContactSettings(), LawSettings()),
        (paper.CONTACT, paper.LAW),
    ):
        assert with_reading(first["contact"], contact) == contact
        assert law.model_copy(update=LAW_READINGS[first["law"]]) == law
