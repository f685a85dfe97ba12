"""Theories of contact to put beside a result: exact solutions, and those of rough surfaces."""

from mesoscale.theory.adhesion import (
    adhesive_wave_pressure,
    dmt_force,
    dmt_pull_off,
    jkr_force,
    jkr_indentation,
    jkr_pull_off,
    tabor_parameter,
)
from mesoscale.theory.greenwood_williamson import (
    Summits,
    greenwood_williamson_area_share,
    greenwood_williamson_pressure,
    summits_of,
)
from mesoscale.theory.persson import persson_area_share, persson_pressure_density
from mesoscale.theory.sphere import (
    hertz_contact_radius,
    hertz_force,
    hertz_indentation,
    hertz_pressure,
    punch_force,
    punch_pressure,
)
from mesoscale.theory.waves import (
    bisinusoid_area_at_first_touch,
    bisinusoid_area_near_full_contact,
    bisinusoid_full_pressure,
    wave_area_share,
    wave_full_pressure,
    wave_gap,
    wave_mean_pressure,
    wave_pressure,
    wave_separation,
)

__all__ = [
    "Summits",
    "adhesive_wave_pressure",
    "bisinusoid_area_at_first_touch",
    "bisinusoid_area_near_full_contact",
    "bisinusoid_full_pressure",
    "dmt_force",
    "dmt_pull_off",
    "greenwood_williamson_area_share",
    "greenwood_williamson_pressure",
    "hertz_contact_radius",
    "hertz_force",
    "hertz_indentation",
    "hertz_pressure",
    "jkr_force",
    "jkr_indentation",
    "jkr_pull_off",
    "persson_area_share",
    "persson_pressure_density",
    "punch_force",
    "punch_pressure",
    "summits_of",
    "tabor_parameter",
    "wave_area_share",
    "wave_full_pressure",
    "wave_gap",
    "wave_mean_pressure",
    "wave_pressure",
    "wave_separation",
]
