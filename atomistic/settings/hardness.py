"""Size-dependent hardness from molecular dynamics (docs/hardness.md)."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from atomistic.settings.base import Settings

BASE_OVER_CONTACT = 1.0  # below it the stress rises with the contact (docs/hardness.md, "A base that is not felt")


class GlassSettings(Settings):
    """Melt and quench of a periodic glass cell."""

    atoms: int = Field(default=690, ge=100, le=2_000_000, description="atoms of the cell, about")
    melt_temperature_K: float = Field(
        default=4000, ge=1500, le=12000, description="temperature of the melt", json_schema_extra={"unit": "K"}
    )
    melt_ps: float = Field(default=8, gt=0, le=10_000, description="time in the melt", json_schema_extra={"unit": "ps"})
    quench_rate_K_ps: float = Field(
        default=50, gt=0, le=2000, description="cooling rate at zero pressure", json_schema_extra={"unit": "K/ps"}
    )
    final_temperature_K: float = Field(
        default=300, ge=10, le=1000, description="temperature of the glass", json_schema_extra={"unit": "K"}
    )
    rest_ps: float = Field(
        default=4, gt=0, le=10_000, description="rest after the quench", json_schema_extra={"unit": "ps"}
    )
    timestep_fs: float = Field(default=2, ge=0.1, le=4, description="time step", json_schema_extra={"unit": "fs"})
    segment_steps: int = Field(
        default=5000,
        ge=100,
        le=1_000_000,
        description="a killed quench loses at most this many steps",
    )


class AsperitySettings(Settings):
    """One asperity, Z = min[A w(2 pi x / lambda), A w(2 pi y / lambda)]."""

    name: str = Field(pattern=r"^[A-Za-z][A-Za-z0-9]{0,39}$", description="name in file names and tables")
    tiles: int = Field(
        ge=1,
        le=40,
        description="wavelength lambda in glass cells, so that nothing is strained",
    )
    amplitude_nm: float = Field(
        ge=0,
        le=10,
        description="amplitude A; 0 is a flat, for a spherical counterface",
        json_schema_extra={"unit": "nm"},
    )
    shape: Literal["sinusoidal", "pyramidal"] = Field(
        default="sinusoidal",
        description="w: a sine (eq. 6), or a triangle, whose pyramids press with the same stress at every size unless "
        "the material has a length of its own",
    )


class ClosingSettings(Settings):
    """Closing of an asperity against a counterface."""

    counterface: Literal["flat", "sphere", "oxide", "asperity"] = Field(
        default="flat",
        description="flat, sphere: rigid, frictionless, repulsive, without atoms; "
        "oxide, asperity: atoms of counter_material, flat or after eq. 6",
    )
    control: Literal["speed", "force", "steps"] = Field(
        default="speed",
        description="speed: constant closing speed; force: closing force raised in steps (Kim et al. 2013); "
        "steps: small steps, at rest after each (no temperature; counterface flat or sphere)",
    )
    interface: Literal["repulsive", "adhesive"] = Field(
        default="repulsive",
        description="atoms of a counterface of oxide: a short-range repulsion alone, or the potential itself",
    )
    counter_material: str = Field(default="SiO2", description="oxide of the counterface, by its formula")
    counter_potential: str | None = Field(
        default=None,
        description="potential of that oxide, as `potential`, where it is another (the interface is then repulsive: "
        "what acts between atoms of two potentials is not known); null: that of the asperity",
    )
    counter_base_nm: float = Field(
        default=2.5, ge=1, le=100, description="thickness of the oxide counterface", json_schema_extra={"unit": "nm"}
    )
    sphere_radius_nm: float = Field(
        default=2, gt=0, le=1000, description="radius of the spherical counterface", json_schema_extra={"unit": "nm"}
    )
    speed_m_s: float = Field(default=50, gt=0, le=1000, description="closing speed", json_schema_extra={"unit": "m/s"})
    timestep_fs: float = Field(
        default=3,
        ge=0.1,
        le=4,
        description="time step (over the square root of the energy scale: softer bonds vibrate more slowly)",
        json_schema_extra={"unit": "fs"},
    )
    temperature_K: float = Field(default=300, ge=1, le=1500, description="temperature", json_schema_extra={"unit": "K"})
    anneal_temperature_K: float = Field(
        default=1000,
        ge=1,
        le=3000,
        description="temperature at which the cut surface is annealed (times the energy scale)",
        json_schema_extra={"unit": "K"},
    )
    anneal_ps: float = Field(
        default=5,
        gt=0,
        le=10_000,
        description="time of the anneal and again of the cooling",
        json_schema_extra={"unit": "ps"},
    )
    base_nm: float = Field(
        default=2.6,
        ge=1,
        le=100,
        description="least thickness from the lower face to the mean height, the frozen bottom included",
        json_schema_extra={"unit": "nm"},
    )
    base_over_contact: float = Field(
        default=BASE_OVER_CONTACT,
        ge=0,
        le=10,
        description="the same thickness in units of the largest contact length that counts, "
        "sqrt(plasticity.max_area_fraction) wavelengths: a thinner base is felt, a scene may not ask for less",
    )
    frozen_nm: float = Field(
        default=0.5, gt=0, le=10, description="thickness of the frozen bottom", json_schema_extra={"unit": "nm"}
    )
    thermostat_nm: float = Field(
        default=0.7,
        gt=0,
        le=10,
        description="thickness of the thermostat layer above it",
        json_schema_extra={"unit": "nm"},
    )
    wall_stiffness_eV_A3: float = Field(
        default=10,
        gt=0,
        le=1000,
        description="force constant K of the plane (times the energy scale)",
        json_schema_extra={"unit": "eV/A^3"},
    )
    approach_nm: float = Field(
        default=0.1,
        gt=0,
        le=5,
        description="clearance at the start above the highest atom; bonds exchanged on this way are the background",
        json_schema_extra={"unit": "nm"},
    )
    depth_over_amplitude: float = Field(
        default=2.2,
        gt=0,
        le=4,
        description="largest travel below the highest atom, in amplitudes (in radii of a spherical counterface); "
        "two bodies that yield share it",
    )
    unload_nm: float = Field(
        default=0,
        ge=0,
        le=10,
        description="travel back at the closing speed, to confirm by dynamics what stays; 0: none",
        json_schema_extra={"unit": "nm"},
    )
    force_step_MPa: float = Field(
        default=20,
        gt=0,
        le=1000,
        description="control force: rise of the nominal stress per step",
        json_schema_extra={"unit": "MPa"},
    )
    dwell_ps: float = Field(
        default=10, ge=0.1, le=1000, description="control force: time per step", json_schema_extra={"unit": "ps"}
    )
    max_stress_GPa: float = Field(
        default=5,
        gt=0,
        le=50,
        description="control force: nominal stress at the end",
        json_schema_extra={"unit": "GPa"},
    )
    damping_ps: float = Field(
        default=1,
        gt=0,
        le=1000,
        description="control force: time in which the sample's motion as a whole is damped",
        json_schema_extra={"unit": "ps"},
    )
    segment_force_steps: int = Field(
        default=10,
        ge=1,
        le=10_000,
        description="control force: steps of force between restart files and relaxed snapshots",
    )
    segment_nm: float = Field(
        default=0.1,
        gt=0,
        le=1,
        description="travel between restart files and relaxed snapshots: what a killed run loses at most",
        json_schema_extra={"unit": "nm"},
    )
    processes: int = Field(
        default=1,
        ge=1,
        le=4096,
        description="MPI processes of one closing run, started as docs/cluster.md says",
    )


class AreaSettings(Settings):
    """Contact area, fixed by bodies of known section before any hardness is looked at (docs/hardness.md)."""

    depth_A: float = Field(
        default=0.5,
        gt=0,
        le=2,
        description="atoms nearer than this to the counterface, or beyond it, touch",
        json_schema_extra={"unit": "A"},
    )
    touch_A: float = Field(
        default=2.4,
        gt=0,
        le=5,
        description="distance of two atoms that defines zero gap for atomic counterfaces",
        json_schema_extra={"unit": "A"},
    )
    other_depths_A: tuple[Annotated[float, Field(gt=0, le=2)], ...] = Field(
        default=(0.25, 1.0, 1.5),
        description="further depths for which the area is reported, to show what the definition does",
        json_schema_extra={"unit": "A"},
    )
    closing_A: float = Field(
        default=4,
        gt=0,
        le=20,
        description="the space between touching atoms is contact where a disc of this radius does not fit",
        json_schema_extra={"unit": "A"},
    )
    rim_A: float = Field(
        default=1.7,
        ge=0,
        le=4,
        description="the rim of the contact lies this far outside the outermost touching atoms",
        json_schema_extra={"unit": "A"},
    )
    grid_A: float = Field(default=0.5, ge=0.05, le=2, description="grid spacing", json_schema_extra={"unit": "A"})
    travel_A: float = Field(
        default=0.25,
        gt=0,
        le=5,
        description="travel over which area and force are averaged",
        json_schema_extra={"unit": "A"},
    )
    snapshots: int = Field(default=5, ge=1, le=100, description="snapshots per average")


class YieldSettings(Settings):
    """What counts as yield, fixed before any fit."""

    min_length_nm: float = Field(
        default=2.0,
        gt=0,
        le=20,
        description="contact length from which stress is judged",
        json_schema_extra={"unit": "nm"},
    )
    max_area_fraction: float = Field(
        default=0.5,
        gt=0,
        le=1,
        description="contact area over cell area up to which stress is judged",
    )
    min_exchanges: int = Field(
        default=5,
        ge=1,
        le=1000,
        description="changed cation-oxygen bonds above the background that witness plasticity",
    )
    min_lowering_A: float = Field(
        default=0.5,
        ge=0,
        le=10,
        description="lasting lowering of the top that witnesses plasticity",
        json_schema_extra={"unit": "A"},
    )
    min_points: int = Field(
        default=4,
        ge=3,
        le=100,
        description="averages beyond the onset",
    )
    max_exponent: float = Field(
        default=0.35,
        gt=0,
        le=2,
        description="largest n in stress ~ length^n beyond the onset: 0 is a plateau, 1 is elastic",
    )
    stop_interval: float = Field(
        default=0.04,
        gt=0,
        le=0.5,
        description="a run ends once half the 68 % interval of its plateau is this share of it, with stop_points and "
        "stop_area_fraction; else where the area leaves max_area_fraction",
    )
    stop_points: int = Field(default=12, ge=4, le=1000, description="averages beyond the onset before a run may end")
    stop_area_fraction: float = Field(
        default=0.25,
        gt=0,
        le=1,
        description="contact area over cell area before a run may end: a larger asperity is to give a larger contact",
    )
    max_drift_meV_atom_ps: float = Field(
        default=0.2,
        gt=0,
        le=100,
        description="largest drift of the conserved energy",
        json_schema_extra={"unit": "meV/ps"},
    )
    max_warming_K: float = Field(
        default=150, gt=0, le=2000, description="largest rise of temperature", json_schema_extra={"unit": "K"}
    )


class SystematicSettings(Settings):
    """What moves every run of a scene alike, as standard deviations relative to the hardness (docs/hardness.md)."""

    rate: float = Field(default=0.05, ge=0, le=1, description="closing speed in use against rest")
    base: float = Field(default=0.04, ge=0, le=1, description="base in use against a thicker one")
    potential: float = Field(default=0.1, ge=0, le=1, description="one potential of silica against another")
    shape: float = Field(default=0.23, ge=0, le=1, description="asperities half and twice as steep as those in use")


class FitSettings(Settings):
    """Fit of H(A) = H_macro + H' A^-0.25."""

    h_macro: Literal["literature", "free"] = Field(
        default="literature",
        description="literature: H_macro from h_macro_GPa, H' from the points; free: both from the points",
    )
    h_macro_GPa: tuple[float, float] = Field(
        default=(0.7, 3.2),
        description="literature range of H_macro (Kim et al. 2013, Table 1)",
        json_schema_extra={"unit": "GPa"},
    )
    min_points: int = Field(default=6, ge=2, le=1000, description="defended points needed")
    min_share: float = Field(
        default=0.5,
        ge=0,
        le=1,
        description="share of runs that must give a defended point",
    )
    bootstrap: int = Field(default=2000, ge=100, le=100_000, description="bootstrap samples")
    systematic: SystematicSettings = SystematicSettings()


class HardnessSettings(Settings):
    """Size-dependent hardness from molecular dynamics (docs/hardness.md)."""

    potential: str = Field(default="pmmcs", description="name of a file in config/potentials, or a path")
    material: str = Field(
        default="SiO2", description="oxide of the asperity: formula of a file in config/materials with an oxide_glass"
    )
    energy_scales: tuple[Annotated[float, Field(gt=0, le=2)], ...] = Field(
        default=(1.0, 0.5),
        min_length=1,
        description="factors on all energies; 0.5 is the model-form twin",
    )
    seeds: tuple[Annotated[int, Field(ge=0, le=1_000_000)], ...] = Field(
        default=(1, 2), min_length=1, description="seeds of the glasses"
    )
    asperities: tuple[AsperitySettings, ...] = Field(
        default=(
            AsperitySettings(name="small", tiles=2, amplitude_nm=0.43),
            AsperitySettings(name="medium", tiles=3, amplitude_nm=0.64),
            AsperitySettings(name="large", tiles=4, amplitude_nm=0.86),
        ),
        min_length=1,
        description="asperities to close",
    )
    glass: GlassSettings = GlassSettings()
    closing: ClosingSettings = ClosingSettings()
    area: AreaSettings = AreaSettings()
    plasticity: YieldSettings = YieldSettings()
    fit: FitSettings = FitSettings()

    @model_validator(mode="after")
    def _one_potential_adheres(self) -> "HardnessSettings":
        if self.closing.counter_potential is not None and self.closing.interface == "adhesive":
            raise ValueError(
                f"closing.counter_potential {self.closing.counter_potential!r:.60}: nothing is known of how atoms of "
                "two potentials attract; set closing.interface to repulsive, or leave counter_potential out"
            )
        return self

    @model_validator(mode="after")
    def _something_to_press(self) -> "HardnessSettings":
        if self.closing.counterface != "sphere" and (flat := [a.name for a in self.asperities if a.amplitude_nm == 0]):
            raise ValueError(
                f"asperities: {flat[0]} has amplitude 0: a flat against a {self.closing.counterface} has no contact "
                "length; give an amplitude or set closing.counterface to sphere"
            )
        if len({asperity.name for asperity in self.asperities}) < len(self.asperities):
            raise ValueError("asperities: two have the same name; their results would be the same files")
        return self
