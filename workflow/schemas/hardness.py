"""Tables of the hardness stage."""

from workflow.schemas.table import Table, boolean, integer, number, text

_STEP = integer("step", "MD step")
_DISPLACEMENT = number("displacement_nm", "nm", "travel of the flat since the start")

TABLES = (
    Table(
        ("hardness/points.csv",),
        "One closing run.",
        (
            text("run", "name of the closing run"),
            text("potential", "interatomic potential"),
            number("energy_scale", "1", "factor on the potential's energies (1 full, 0.5 halved)"),
            text("asperity", "name of the asperity in the scene"),
            number("wavelength_nm", "nm", "wavelength of the asperity, side of the cell"),
            number("amplitude_nm", "nm", "amplitude of the asperity"),
            number(
                "film_nm",
                "nm",
                "thickness of the film; 0: the body below by itself; none: oxide throughout",
                empty=True,
            ),
            integer("seed", "seed of the glass and of the velocities"),
            integer("atoms", "number of atoms"),
            text("status", "yield, no_yield, or rejected: why"),
            boolean(
                "sound",
                "whether energy, temperature, film and range of contact are as they must be",
            ),
            number(
                "contact_length_nm", "nm", "square root of the contact area, mean over the plateau"
            ),
            number("contact_area_nm2", "nm²", "square of contact_length_nm"),
            number("hardness_GPa", "GPa", "mean contact stress of the plateau"),
            number("hardness_lo", "GPa", "lower end of the 68 % interval of hardness_GPa"),
            number("hardness_hi", "GPa", "upper end of the 68 % interval of hardness_GPa"),
            number("length_min_nm", "nm", "smallest contact length of the plateau"),
            number("length_max_nm", "nm", "largest contact length of the plateau"),
            number(
                "same_shape_GPa",
                "GPa",
                "mean contact stress where the contact is 0.5 to 0.6 wavelengths wide",
            ),
            number("same_shape_length_nm", "nm", "mean contact length there"),
            number("plateau_exponent", "1", "n of stress ~ length^n on the plateau"),
            integer("plateau_points", "averages on the plateau"),
            number("onset_displacement_nm", "nm", "travel at the onset of plasticity"),
            number("onset_length_nm", "nm", "contact length at the onset of plasticity"),
            number("exchanges_before", "1", "bond exchanges per snapshot before contact"),
            number("exchanges_at_onset", "1", "new bond exchanges in the snapshot of the onset"),
            number("onset_p_value", "1", "chance of as many exchanges without plasticity"),
            number("exchanges_after", "1", "new bond exchanges per snapshot from the onset on"),
            number("lowering_nm", "nm", "how much lower the top is in the last relaxed snapshot"),
            number("drift_meV_atom_ps", "meV/atom/ps", "drift of the energy balance"),
            number("warming_K", "K", "highest temperature above that of the start"),
            integer("atom_steps", "atoms times MD steps"),
            number("lammps_cpu_s", "s", "processor time of LAMMPS"),
        ),
    ),
    Table(
        ("hardness/witness/*.csv",),
        "One relaxed snapshot of a closing run.",
        (
            _STEP,
            _DISPLACEMENT,
            integer("exchanged_bonds", "bonds broken or formed since the first snapshot"),
            integer("new_exchanges", "bonds broken or formed since the last snapshot"),
            number("lowering_nm", "nm", "how much lower the top is than in the first snapshot"),
            number(
                "top_area_nm2", "nm^2", "contact area under load, nan while the contact is small"
            ),
            number(
                "top_force_over_hamaker",
                "1/nm",
                "pull-off force of the rigid top over the Hamaker constant",
            ),
            number(
                "top_work_over_hamaker", "1", "work of its separation over the Hamaker constant"
            ),
        ),
    ),
    Table(
        ("hardness/closing/*.csv",),
        "One average of a closing run.",
        (
            _STEP,
            number("time_ps", "ps", "time since the flat began to move"),
            _DISPLACEMENT,
            number("force_nN", "nN", "force on the flat"),
            number("nominal_stress_GPa", "GPa", "force over the cross-section of the cell"),
            number("contact_area_nm2", "nm²", "contact area"),
            number("contact_length_nm", "nm", "square root of the contact area"),
            number("contact_stress_GPa", "GPa", "force over contact area; nan without contact"),
            number("temperature_K", "K", "temperature"),
            number(
                "energy_drift_meV_per_atom",
                "meV/atom",
                "energy less work of what moves and heat of the thermostat",
            ),
            number("contact_atoms", "1", "atoms in contact, mean over the samples of the average"),
            integer("atoms", "number of atoms"),
        ),
    ),
)
