"""Tables of the hardness stage and of its studies."""

from workflow.schemas.table import Column, Table, integer, number, text

_STEP = integer("step", "MD step")
_DISPLACEMENT = number("displacement_nm", "nm", "travel of the counterface since the start")
_UNLOADED = "; only of runs with `unload_nm`"

POINT: tuple[Column, ...] = (
    text("run", "name of the closing run"),
    text("potential", "interatomic potential"),
    number("energy_scale", "1", "factor on the potential's energies (1 full, 0.5 halved)"),
    text("geometry", "shapes of the two bodies"),
    text("asperity", "name of the asperity in the scene"),
    number("wavelength_nm", "nm", "wavelength of the asperity, side of the cell"),
    number("amplitude_nm", "nm", "amplitude of the asperity"),
    integer("seed", "seed of the glass and of the velocities"),
    integer("atoms", "number of atoms"),
    text("status", "yield, no_yield, or rejected: why"),
    number("contact_length_nm", "nm", "square root of the contact area, mean over the plateau"),
    number("contact_area_nm2", "nm²", "square of contact_length_nm"),
    number("hardness_GPa", "GPa", "mean contact stress of the plateau"),
    number("hardness_lo", "GPa", "lower end of the 68 % interval of hardness_GPa"),
    number("hardness_hi", "GPa", "upper end of the 68 % interval of hardness_GPa"),
    number("length_min_nm", "nm", "smallest contact length of the plateau"),
    number("length_max_nm", "nm", "largest contact length of the plateau"),
    number("window_exponent", "1", "n of stress ~ length^n in the whole window of lengths"),
    number("same_shape_GPa", "GPa", "mean contact stress where the contact is 0.5 to 0.6 wavelengths wide"),
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
    integer("restart_steps", "MD steps that a killed run loses at most"),
    number("lammps_cpu_s", "s", "processor time of LAMMPS"),
    number("python_cpu_s", "s", "processor time of the script"),
    integer("snapshot_exchanged_bonds", "bonds exchanged in the last snapshot" + _UNLOADED, True, True),
    integer("unloaded_exchanged_bonds", "bonds exchanged after unloading" + _UNLOADED, True, True),
    number("snapshot_lowering_nm", "nm", "lowering of the top in the last snapshot" + _UNLOADED, True, True),
    number("unloaded_lowering_nm", "nm", "lowering of the top after unloading" + _UNLOADED, True, True),
    number("unloaded_force_nN", "nN", "force left after unloading" + _UNLOADED, True, True),
)

TABLES = (
    Table(
        ("hardness/plan.csv",),
        "A closing run to come; the last row, `all`, is the sum.",
        (
            text("run", "name of the closing run, or all"),
            number("wavelength_nm", "nm", "side of the cell", empty=True),
            integer("atoms", "estimated number of atoms", empty=True),
            integer("steps", "MD steps", empty=True),
            integer("restart_steps", "MD steps that a killed run loses at most", empty=True),
            number("atom_steps", "1", "atoms times MD steps"),
            number("core_hours", "h", "estimated processor time"),
            number("hours", "h", "estimated run time", empty=True),
            integer("processes", "MPI processes of the run", empty=True),
        ),
    ),
    Table(("hardness/points.csv",), "One closing run.", POINT),
    Table(
        ("study/hardness.csv",),
        "One case of the study; the columns of hardness/points.csv after its label.",
        (text("case", "name of the case"), text("about", "what the case varies"), *POINT),
    ),
    Table(
        ("hardness/witness/*.csv", "accuracy/hardness/*/*.witness.csv", "study/hardness/*.witness.csv"),
        "One relaxed snapshot of a closing run.",
        (
            _STEP,
            _DISPLACEMENT,
            integer("exchanged_bonds", "bonds broken or formed since the first snapshot"),
            integer("new_exchanges", "bonds broken or formed since the last snapshot"),
            number("lowering_nm", "nm", "how much lower the top is than in the first snapshot"),
        ),
    ),
    Table(
        ("hardness/snapshots/*.csv", "accuracy/hardness/*/*.snapshots.csv", "study/hardness/*.snapshots.csv"),
        "One atom of a 0.8 nm slice through the peak, in a relaxed snapshot.",
        (
            _STEP,
            integer("type", "kind of the atom (1: cation)"),
            number("x_nm", "nm", "position along the slice"),
            number("y_nm", "nm", "position across the slice"),
            number("z_nm", "nm", "height"),
        ),
    ),
    Table(
        ("hardness/closing/*.csv", "accuracy/hardness/*/*.csv", "study/hardness/*.csv"),
        "One average of a closing run.",
        (
            _STEP,
            number("time_ps", "ps", "time since the counterface began to move"),
            _DISPLACEMENT,
            number("force_nN", "nN", "force on the counterface"),
            number("nominal_stress_GPa", "GPa", "force over the cross-section of the cell"),
            number("contact_area_nm2", "nm²", "contact area"),
            number("contact_length_nm", "nm", "square root of the contact area"),
            number("contact_stress_GPa", "GPa", "force over contact area; nan without contact"),
            number("temperature_K", "K", "temperature"),
            number(
                "energy_drift_meV_per_atom",
                "meV/atom",
                "energy minus work of what moves minus heat of the thermostat, between the ends of segments by a line",
            ),
            number("contact_atoms", "1", "atoms in contact, mean over the samples of the average"),
            integer("atoms", "number of atoms"),
            number("contact_area_nm2_depth_*A", "nm²", "contact area counted to another depth (Å)", optional=True),
        ),
    ),
)
