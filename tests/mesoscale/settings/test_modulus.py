"""The modulus of the default beam: published values, and what a stated one has in their place."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from mesoscale.answer.departures import stated_departures
from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import STATED_MODULUS

PUBLISHED = Path(__file__).parents[3] / "config" / "materials" / "plated_nickel.csv"


def modulus_GPa(settings, units):
    """Modulus of devices at probabilities."""
    (row,) = [r for r in stated_departures(settings).rows if r.name == "youngs_modulus_GPa"]
    return settings.youngs_modulus_GPa * (1.0 + row.distribution.quantile(np.asarray(units)))


def test_the_default_modulus_is_fitted_to_published_values_of_plated_nickel():
    table = pd.read_csv(PUBLISHED, comment="#")
    published_GPa = table["young_GPa"].to_numpy()
    assert table["source"].str.len().min() > 10
    settings = DeviceSettings()
    assert settings.youngs_modulus_GPa == pytest.approx(published_GPa.mean(), rel=0.005)
    row = settings.spread.youngs_modulus_GPa
    assert row.varies == "common"
    deviation = published_GPa.std(ddof=1) / published_GPa.mean()
    assert row.values[1] == pytest.approx(deviation, abs=0.005)
    # crystals of nickel (c11 246.5, c12 147.3, c44 124.7 GPa) bound it from above (Voigt)
    shear = (246.5 - 147.3 + 3.0 * 124.7) / 5.0
    bulk = (246.5 + 2.0 * 147.3) / 3.0
    voigt_GPa = 9.0 * bulk * shear / (3.0 * bulk + shear)
    assert modulus_GPa(settings, [1.0])[0] == pytest.approx(voigt_GPa, rel=0.01)
    low, high = modulus_GPa(settings, [0.05, 0.95])
    assert low == pytest.approx(published_GPa.min(), rel=0.05)
    assert high == pytest.approx(published_GPa.max(), rel=0.1)


def test_a_stated_modulus_is_known_better_than_that_of_any_nickel():
    for stated in (
        DeviceSettings(youngs_modulus_GPa=70.0),
        DeviceSettings(youngs_modulus_GPa=152.0),
    ):
        assert stated.spread.youngs_modulus_GPa == STATED_MODULUS
    row = {"distribution": "normal", "values": [0.0, 2.0], "source": "resonance"}
    own = DeviceSettings(youngs_modulus_GPa=70.0, spread={"youngs_modulus_GPa": row})
    assert own.spread.youngs_modulus_GPa.values == (0.0, 2.0)
    known = DeviceSettings(youngs_modulus_GPa=70.0, spread={"youngs_modulus_GPa": None})
    assert known.spread.youngs_modulus_GPa is None
    again = DeviceSettings(**DeviceSettings().model_dump(mode="json"))
    assert again == DeviceSettings()
