"""Settings of the mesoscale stages, a module each: keys with default, unit and range."""

from asperity.guards.settings import Settings
from mesoscale.settings.contact import ContactSettings, ReadingSettings, SceneContact
from mesoscale.settings.device import DeviceSettings
from mesoscale.settings.failure import FailureSettings
from mesoscale.settings.history import HistorySettings
from mesoscale.settings.inputs import TABLE_1, DistributionRow, InputRow, InputsSettings
from mesoscale.settings.lifetime import LifetimeSettings
from mesoscale.settings.measurements import MeasurementsSettings, MeasurementTable
from mesoscale.settings.pad import PadSettings
from mesoscale.settings.topography import (
    InstrumentSettings,
    SyntheticScanSettings,
    TopographySettings,
)
from mesoscale.settings.uncertainty import UncertaintySettings

__all__ = [
    "TABLE_1",
    "ContactSettings",
    "DeviceSettings",
    "DistributionRow",
    "FailureSettings",
    "HistorySettings",
    "InputRow",
    "InputsSettings",
    "InstrumentSettings",
    "LifetimeSettings",
    "MeasurementTable",
    "MeasurementsSettings",
    "PadSettings",
    "ReadingSettings",
    "SceneContact",
    "Settings",
    "SyntheticScanSettings",
    "TopographySettings",
    "UncertaintySettings",
]
