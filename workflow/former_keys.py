"""Keys of scenes that are no more, with what to write instead; a scene that has one is refused in one line."""

from mesoscale.inputs.definitions import BY_NAME
from mesoscale.settings.inputs import FORMS

FORMER_KEYS: dict[str, str] = {
    # device
    "device.samples": "no longer a setting, delete it: they are 4000",
    "device.landed_fraction": "no longer a setting, delete it: gap_um, bow_nm and tilt_nm say what is in contact",
    # inputs
    **{
        f"inputs.{row}.{key}": f"now among `values`, as one of {FORMS}"
        for row in BY_NAME
        for key in ("a", "b", "low", "high", "file")
    },
    **{f"inputs.{row}.prior": "no longer a key: without `values` the prior is that of the stage" for row in BY_NAME},
    # hardness
    **{
        f"hardness.glass.{key}": "no longer a setting, delete it: all glasses have the same (docs/hardness.md)"
        for key in ("melt_temperature_K", "final_temperature_K", "timestep_fs", "segment_steps")
    },
    **{
        f"hardness.closing.{key}": "no longer a setting, delete it: all closings have the same (docs/hardness.md)"
        for key in (
            *("timestep_fs", "temperature_K", "anneal_temperature_K", "wall_stiffness_eV_A3", "approach_nm"),
            *("frozen_nm", "thermostat_nm", "counter_base_nm", "base_over_contact", "segment_nm"),
            *("force_step_MPa", "max_stress_GPa", "damping_ps", "segment_force_steps"),
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
    "elastic.ions": "no longer a setting, delete it: ions are clamped in E(V), and follow where poisson is computed",
    "elastic.lda_centre": "no longer a setting, delete it",
    "elastic.min_structures": "no longer a setting, delete it: four are needed",
    "elastic.relaxed_structures": "no longer a setting, delete it: poisson 'computed' lets ions follow the strain",
    "elastic.relaxed_force_eV_A": "no longer a setting, delete it: poisson 'computed' lets ions follow the strain",
    "elastic.size_error": "no longer a setting, delete it",
    "elastic.relaxation": "no longer a section: max_steps is dft.relaxation_steps, basis and cut-off are those of dft",
    "elastic.tensor": "no longer a section: structures is elastic.tensor_structures, the others are fixed",
    "elastic.glass.structures": "renamed, write elastic.structures",
    "elastic.glass.seed": "renamed, write elastic.seed",
    **dict.fromkeys(
        (f"elastic.glass.{key}" for key in ("melt_temperature_K", "melt_ps", "final_temperature_K", "timestep_fs")),
        "no longer a setting, delete it: quench_rate_K_ps and formula_units remain",
    ),
    "elastic.glass.attempts": "no longer a setting, delete it",
    **dict.fromkeys(
        (f"elastic.dft.{key}" for key in ("numerics", "tolerance_Ha", "max_cycles")),
        "no longer a setting, delete it: basis and cutoff_Ha remain",
    ),
    # topography
    **{
        f"topography.{key}": "no longer a setting, delete it: synthetic scans always have this surface and instrument"
        for key in (
            *("synthetic.seed", "synthetic.small_length_nm", "synthetic.q0", "synthetic.q1", "synthetic.slope"),
            *("synthetic.rms_nm", "synthetic.rms_variation", "synthetic.tip_radius_nm", "synthetic.noise_nm"),
            *("synthetic.line_noise_nm", "synthetic.tilt_deg", "synthetic.drift_nm", "synthetic.step_nm"),
        )
    },
    **{
        f"topography.{key}": "no longer a setting, delete it: a fixed number of the analysis (docs/topography.md)"
        for key in ("spike_threshold", "sections", "section_fraction", "window_flat", "confidence", "scans_per_job")
    },
    "topography.study_repeats": "no longer a setting, delete it: the accuracy study takes three surfaces",
    "topography.study_sets": "no longer a setting, delete it: python -m evidence topography.recovery",
    # contact
    "contact.convention": "renamed, write contact.reading.convention",
    "contact.prefactor": "renamed, write contact.reading.prefactor",
    "contact.radius": "renamed, write contact.reading.radius",
    "contact.area": "renamed, write contact.reading.area",
    "contact.flow_pair": "renamed, write contact.reading.flow_pair",
    "contact.touching_attracts": "renamed, write contact.reading.touching_attracts",
    "contact.surface.skewness": "renamed, write contact.surface.moments.skewness",
    "contact.surface.kurtosis": "renamed, write contact.surface.moments.kurtosis",
    **{
        f"contact.{key}": f"no longer a setting, delete it: {why}"
        for key, why in {
            "unloading_radius": "take mechanics: coupled where opening matters",
            "merge": "take mechanics: coupled, whose repulsion does not fall where asperities merge",
            "neighbours": "sites are connected through 8 neighbours",
            "flow": "flow returns to the yield surface, the limit of small increments",
            "flow_volume": "coupled flow leaves its volume out of the surface",
            "flow_increment_nm": "flow has no increments",
            "flow_width_nm": "it is 0.3 nm, the paper's",
            "flow_floor_pixels": "it is 1 pixel",
            "flow_tolerance": "it is 1e-3",
            "max_sweeps": "it is 500",
            "force_steps": "they are 40",
            "gap_bins": "they are 4096",
            "nominal_seed": "the nominal curves have seed 1",
            "nominal_force_nN": "figure 4 is drawn to 1e4 nN",
            "nominal_loads_nN": "figure 11 has the paper's loads",
            "study_seeds": "the accuracy study takes 3 surfaces",
            "study_draws": "see `python -m evidence contact.draws --help`",
        }.items()
    },
    "coupling": "no longer a section, delete it: see target model_form, and `python -m evidence contact.half_space`",
    "history.dwell_steps": "no longer a setting, delete it: a dwell is solved at 12 times",
    # law
    **{
        f"law.{key}": f"no longer a setting, delete it: {value}"
        for key, value in {
            "shield_nm": "it is 2 nm",
            "weights": "misfits are absolute",
            "relative_floor": "misfits are absolute",
            "points": "they are 200",
            "min_points": "they are 4",
            "min_depth_ratio": "it is 0.2",
            "max_depth_ratio": "it is 200",
            "max_relative_error": "it is 1",
            "max_residual": "it is 0.15",
        }.items()
    },
    # pad and adhesion
    **{f"pad.{key}": f"renamed, write pad.grid.{key}" for key in ("pilot_cells", "depths")},
    **{
        key: f"no longer a setting, delete it: {value}"
        for key, value in {
            "pad.step_nm": "it is 0.1 nm",
            "pad.max_pressure_MPa": "it follows from the switch",
            "pad.grid.max_pressure_MPa": "it follows from the switch",
            "pad.first_seed": "it is 1000",
            "pad.chunk_cells": "a job has 64 cells, or 32 coupled ones",
            "pad.chunk_draws": "a job has 12",
            "pad.gap_cutoff_high_nm": "it is 0.3 nm; for another range of D0 give inputs.gap_cutoff",
            "adhesion.step_nm": "it is 0.1 nm",
            "adhesion.first_seed": "it is 5000",
        }.items()
    },
    # uncertainty and calibration
    **{
        f"{section}.{key}": f"no longer a setting, delete it: {value}"
        for section, values in {
            "uncertainty": {
                "chaos_degree": "it is 3",
                "first_seed": "the first surface has seed 0",
                "central_share": "it is 0.999",
                "chunk_runs": "a job has 100 cycles",
                "sample_seed": "it is 1",
                "sobol_samples": "they are 2048",
                "sobol_bootstrap": "they are 40",
                "bootstrap": "they are 200",
                "morris_trajectories": "they are 24",
                "audit_seeds": "see `python -m evidence uncertainty.audit --help`",
                "audit_readings": "see `python -m evidence uncertainty.audit --help`",
                "study_runs": "see `python -m evidence uncertainty.work_precision --help`",
                "study_replicates": "see `python -m evidence uncertainty.work_precision --help`",
            },
            "measurements": {
                "chunk_runs": "a job has 100 cycles",
                "response_error": "it is 0.5",
                "walkers": "they are 32",
                "max_steps": "they are 4000",
                "samples": "4000 are kept",
                "seed": "it is 1",
            },
        }.items()
        for key, value in values.items()
    },
}
