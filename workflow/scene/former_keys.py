"""Keys that former scenes have under another name, or that other keys replace; each is refused in one line.

A key that went without a successor is refused as every unknown key is: with the list of those accepted.
"""

from mesoscale.settings.definitions import BY_NAME
from mesoscale.settings.inputs import FORMS

RENAMED = {
    "elastic.glass.structures": "elastic.structures",
    "elastic.glass.seed": "elastic.seed",
    **{
        f"contact.{key}": f"contact.reading.{key}"
        for key in ("convention", "prefactor", "radius", "area", "flow_pair", "touching_attracts")
    },
    "pad.draws": "pad.points",
    "pad.draw_cells": "pad.point_cells",
    "device.bow_deviation_nm": "device.spread.bow_nm",
    "device.tilt_deviation_nm": "device.spread.tilt_nm",
}
REPLACED = {
    "device.electrode_um2": "the area is length_um times width_um",
    **{
        f"inputs.{row}.{key}": f"now among `values`, as one of {FORMS}"
        for row in BY_NAME
        for key in ("a", "b", "low", "high", "file")
    },
    **{f"inputs.{row}.prior": "without `values` the prior is that of the stage" for row in BY_NAME},
    "hardness.area": "the potential's file says with what its area is calibrated",
    **{
        f"hardness.closing.{key}": "a rigid flat at constant speed presses every asperity"
        for key in ("counterface", "control", "interface", "counter_material", "counter_potential", "dwell_ps")
    },
    "hardness.closing.depth_over_amplitude": "always 2.2",
    "hardness.fit": "H_macro is that of Table 1; H' follows from it",
    "hardness.plasticity": "`closing.stop: window` takes runs to their end",
    **dict.fromkeys(("elastic.ions", "elastic.relaxed_structures"), "ions are clamped in E(V)"),
    "elastic.poisson": "state the range as elastic.poisson_ratio",
    **{
        f"elastic.{key}": "the stage has its own"
        for key in ("strains", "samples", "dft.basis", "lda_structures", "glass.quench_rate_K_ps")
    },
    **{f"elastic.dft.{key}": "PySCF computes; state an e_star of another code" for key in ("engine", "parameters")},
    "elastic.relaxation": "max_steps is dft.relaxation_steps, basis and cut-off are those of dft",
    "contact.unloading_radius": "take mechanics: coupled where opening matters",
    "contact.merge": "take mechanics: coupled, whose repulsion does not fall where asperities merge",
    "contact.surface": "topography finds it; in Python ContactSettings(surface=…) takes it",
    "topography.max_missing": "always 5 %",
    "topography.synthetic.large_length_nm": "always 10 um",
    "history.creep_time_s": "always 1 s",
    "topography.method": "maximum likelihood; figure 10 shows the paper's line fits, too",
    "coupling": "both mechanics were compared once (docs/contact.md)",
    "report": "the page shows the studies that ran: targets accuracy and stability",
    "history.seeds": "always four surfaces",
    "history.creep": "creep_exponent states the power law, else it is logarithmic; dwell_s: 0 has none",
    "adhesion": "device/pad_switch.json has the adhesion of the pad",
    "law": "d_c is where the first asperity touches, rho_a is the paper's 2 nm",
    **dict.fromkeys(("uncertainty.surrogate", "uncertainty.response"), "responses are regressions of direct runs"),
    "uncertainty.samples": "always 10,000",
    "uncertainty.model_form_pairs": "both mechanics were compared once (docs/contact.md)",
    **{f"pad.{key}": "it follows from the switch" for key in ("max_pressure_MPa", "pilot_cells", "depths")},
    "device.adhesion_scale": "it acted on the calibration alone; inputs.adhesion states the attraction",
    **dict.fromkeys(("measurements.local_runs", "measurements.rounds"), "they follow from measurements.runs"),
    "pad.gap_cutoff_high_nm": "for another range of D0 than up to 0.3 nm give inputs.gap_cutoff",
}
FORMER_KEYS = {
    **{former: f"renamed, write {key}" for former, key in RENAMED.items()},
    **{former: f"no longer a key, delete it: {instead}" for former, instead in REPLACED.items()},
}
