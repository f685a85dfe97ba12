"""Settings of the atomistic stages: every key with its default, unit and accepted range."""

from pydantic import BaseModel, ConfigDict


class Settings(BaseModel):
    """Base of all settings: unknown keys, infinities and NaN are refused; instances are frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class HardnessSettings(Settings):
    """Size-dependent hardness from molecular dynamics (docs/hardness.md)."""


class ElasticSettings(Settings):
    """Effective modulus E* from density functional theory (docs/elastic.md)."""
