"""Settings of the atomistic stages, a module each: keys with default, unit and range."""

from atomistic.settings.elastic import DftSettings, ElasticSettings, NitrideGlassSettings
from atomistic.settings.hardness import (
    AsperitySettings,
    ClosingSettings,
    GlassSettings,
    HardnessSettings,
)

__all__ = [
    "AsperitySettings",
    "ClosingSettings",
    "DftSettings",
    "ElasticSettings",
    "GlassSettings",
    "HardnessSettings",
    "NitrideGlassSettings",
]
