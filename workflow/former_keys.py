"""Keys of scenes that are no more, with what to write instead; a scene that has one is refused in one line."""

FORMER_KEYS: dict[str, str] = {
    # device
    "device.landed_fraction": "no longer a setting, delete it: gap_um, bow_nm and tilt_nm say what is in contact",
    # inputs
    # hardness
    **{
        f"hardness.glass.{key}": "no longer a setting, delete it: all glasses have the same (docs/hardness.md)"
        for key in ("melt_temperature_K", "final_temperature_K", "timestep_fs", "segment_steps")
    },
    **{
        f"hardness.closing.{key}": "no longer a setting, delete it: all closings have the same (docs/hardness.md)"
        for key in (
            "timestep_fs",
            "temperature_K",
            "anneal_temperature_K",
            "counter_base_nm",
            "base_over_contact",
            "frozen_nm",
            "thermostat_nm",
            "wall_stiffness_eV_A3",
            "approach_nm",
            "force_step_MPa",
            "max_stress_GPa",
            "damping_ps",
            "segment_force_steps",
            "segment_nm",
        )
    },
    "hardness.closing.sphere_radius_nm": "no longer a setting, delete it: counterfaces are flat, oxide or asperity",
    "hardness.closing.unload_nm": "no longer a setting, delete it: the relaxed snapshots say what stays",
    "hardness.asperities.shape": "no longer a setting, delete it: all asperities are sinusoidal (eq. 6)",
    "hardness.area": "no longer a setting, delete it: the potential's file says with what its area is calibrated",
    "hardness.plasticity": "no longer a setting, delete it; `closing.stop: window` takes runs to their end",
    **{
        f"hardness.fit.{key}": "no longer a setting, delete it: fixed before any fit (docs/hardness.md)"
        for key in ("min_points", "min_share", "bootstrap", "systematic")
    },
    # elastic
    # topography
    # contact
    # law
    # pad and adhesion
    # uncertainty and calibration
}
