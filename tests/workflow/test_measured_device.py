"""The posterior of a measured device is made once, and read by every job."""

import numpy as np
import pytest

from mesoscale.answer import measured
from mesoscale.answer.spread import properties_at
from mesoscale.settings.device import SpreadSettings
from mesoscale.studies.answer_stability import published_beam
from workflow.run.measured_device import remember_measured, write_measured
from workflow.schemas import UnfitTable

PROVENANCE = {"rule": "narrow_device", "inputs_hash": "0", "versions": {}}
KNOWN = ("thickness_um", "dielectric_nm", "permittivity", "bow_nm", "tilt_nm")
SPREAD = SpreadSettings(**dict.fromkeys(KNOWN))
DEVICE = published_beam(measured={"pull_in_V": "72 +- 1"}, spread=SPREAD)


@pytest.fixture
def written(tmp_path, monkeypatch):
    monkeypatch.setattr(measured, "_REMEMBERED", {})
    monkeypatch.setattr(measured, "PRIOR_BEAMS", 30)
    monkeypatch.setattr(measured, "NEAR_BEAMS", 6)
    path = tmp_path / "measured.h5"
    return str(path), write_measured(str(path), DEVICE, PROVENANCE)


def test_a_job_takes_the_posterior_from_its_file(written, monkeypatch):
    """With the same numbers, and without a beam being solved."""
    path, posterior = written
    units = np.linspace(0.05, 0.95, 3 * len(DEVICE.varied)).reshape(3, -1)
    before = properties_at(DEVICE, units)
    remains = measured.what_remains(DEVICE)
    monkeypatch.setattr(measured, "_narrowed", None)
    remember_measured(path, DEVICE)
    assert (properties_at(DEVICE, units) == before).all()
    assert measured.what_remains(DEVICE) == remains
    # neither of these changes what the measurements say
    held = DEVICE.model_copy(update={"hold_voltage_V": 90.0, "release_at": 0.5})
    assert (measured.narrowed(held).z == posterior.z).all()


def test_a_file_of_another_device_is_refused(written):
    path, _ = written
    other = DEVICE.model_copy(update={"gap_um": 3.3})
    with pytest.raises(UnfitTable, match=r"measured.h5: not of this device; delete it"):
        remember_measured(path, other)
