"""Settings of the mesoscale stages: every key with its default, unit and accepted range."""

from pydantic import BaseModel, ConfigDict


class Settings(BaseModel):
    """Base of all settings: unknown keys, infinities and NaN are refused; instances are frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class TopographySettings(Settings):
    """AFM scans to spectrum and roughness parameters (docs/topography.md)."""


class ContactSettings(Settings):
    """Mesoscale contact model (docs/contact.md)."""


class InputsSettings(Settings):
    """Origin and distribution of the uncertain inputs (docs/uncertainty.md)."""


class LawSettings(Settings):
    """Fit of the compact force-separation law (docs/law.md)."""


class UncertaintySettings(Settings):
    """Propagation of uncertainty and sensitivity (docs/uncertainty.md)."""


class DeviceSettings(Settings):
    """Switch driven by the force-separation law (docs/device.md)."""
