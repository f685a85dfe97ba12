"""Effective modulus E* from density functional theory (docs/elastic.md)."""

from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from atomistic.settings.base import Settings
from atomistic.settings.engines import refused_parameter


class NitrideGlassSettings(Settings):
    """Melt and quench of a small amorphous Si3N4 cell (Tersoff potential and soft cores)."""

    structures: int = Field(default=8, ge=1, le=1000, description="amorphous structures of the ensemble")
    formula_units: int = Field(default=4, ge=2, le=64, description="formula units of 7 atoms per cell")
    seed: int = Field(default=1, ge=0, le=1_000_000, description="seed of the ensemble")
    melt_temperature_K: float = Field(
        default=5000, ge=1500, le=12000, description="temperature of the melt", json_schema_extra={"unit": "K"}
    )
    melt_ps: float = Field(default=3, gt=0, le=10_000, description="time in the melt", json_schema_extra={"unit": "ps"})
    quench_rate_K_ps: float = Field(
        default=300, gt=0, le=5000, description="cooling rate", json_schema_extra={"unit": "K/ps"}
    )
    final_temperature_K: float = Field(
        default=300, ge=10, le=1000, description="end of the quench", json_schema_extra={"unit": "K"}
    )
    timestep_fs: float = Field(default=1, ge=0.1, le=1, description="time step", json_schema_extra={"unit": "fs"})
    max_defects: int = Field(
        default=0,
        ge=0,
        le=1000,
        description="atoms of a quenched cell that may lack or exceed their valence; 3 of 28 are as many as in large "
        "melt-quenched models",
    )
    attempts: int = Field(
        default=1000,
        ge=1,
        le=10_000,
        description="quenches per structure until one passes the gates; of 28 atoms about one in sixty does",
    )


class DftSettings(Settings):
    """Engine and numerical parameters of the density functional calculations."""

    engine: Literal["pyscf", "espresso", "vasp", "abinit", "cp2k", "gpaw", "siesta"] = Field(
        default="pyscf",
        description="pyscf (built in), or an ASE calculator configured in your own ASE configuration file",
    )
    parameters: dict[str, str | float | int | bool | dict[str, str | float | int | bool]] = Field(
        default={},
        description="keyword parameters of an ASE calculator other than pyscf: those of the physics "
        "(atomistic/settings/engines.py), no commands, no folders",
    )
    numerics: Literal["cached-grid", "multigrid", "fftdf"] = Field(
        default="cached-grid", description="how PySCF's potential is evaluated: ours (fast), or one of its own"
    )
    basis: str = Field(
        default="gth-dzvp-molopt-sr", pattern=r"^gth-[a-z0-9-]{1,56}$", description="GTH basis set by PySCF's name"
    )
    cutoff_Ha: float = Field(
        default=100,
        ge=20,
        le=1000,
        description="plane-wave cutoff of the density",
        json_schema_extra={"unit": "hartree"},
    )
    tolerance_Ha: float = Field(
        default=1e-6,
        gt=0,
        le=1e-3,
        description="SCF convergence of the energy per cell",
        json_schema_extra={"unit": "hartree"},
    )
    max_cycles: int = Field(default=50, ge=1, le=1000, description="SCF cycles before giving up")

    @model_validator(mode="after")
    def _only_physics(self) -> "DftSettings":
        if mistake := refused_parameter(self.engine, self.parameters):
            raise ValueError(mistake)
        return self


class RelaxationSettings(Settings):
    """Relaxation of the ions of a glass by DFT before its E(V) scan."""

    basis: str = Field(
        default="gth-dzvp-molopt-sr",
        pattern=r"^gth-[a-z0-9-]{1,56}$",
        description="GTH basis set during relaxation, by PySCF's name",
    )
    cutoff_Ha: float = Field(
        default=80,
        ge=20,
        le=1000,
        description="plane-wave cutoff during relaxation",
        json_schema_extra={"unit": "hartree"},
    )
    tolerance_Ha: float = Field(
        default=1e-7,
        gt=0,
        le=1e-3,
        description="SCF convergence where forces are needed",
        json_schema_extra={"unit": "hartree"},
    )
    force_eV_A: float = Field(
        default=0.3, gt=0, le=5, description="largest force left on an atom", json_schema_extra={"unit": "eV/A"}
    )
    max_steps: int = Field(
        default=15,
        ge=0,
        le=500,
        description="ionic steps; 0 keeps the cheap potential's geometry",
    )

    def applied_to(self, dft: DftSettings) -> DftSettings:
        """The engine with the parameters of the relaxation."""
        return dft.model_copy(
            update={"basis": self.basis, "cutoff_Ha": self.cutoff_Ha, "tolerance_Ha": self.tolerance_Ha}
        )


class TensorSettings(Settings):
    """Elastic constants of the first glasses from small strains, for bulk and shear modulus (docs/elastic.md)."""

    structures: int = Field(default=6, ge=1, le=1000, description="glasses whose elastic constants are computed")
    strain: float = Field(default=0.005, gt=0, le=0.03, description="size of the six strains, taken with both signs")
    displacement_A: float = Field(
        default=0.01,
        gt=0,
        le=0.2,
        description="largest displacement of an atom where the ions' Hessian is measured",
        json_schema_extra={"unit": "A"},
    )
    rounds: int = Field(default=4, ge=1, le=20, description="times six directions the ions may follow a strain along")
    tolerance_GPa: float = Field(
        default=5.0,
        gt=0,
        le=100,
        description="what of a constant's softening by the ions may be estimated instead of measured",
        json_schema_extra={"unit": "GPa"},
    )
    force_eV_A: float = Field(
        default=0.1,
        gt=0,
        le=5,
        description="largest force left when ions and cell relax before",
        json_schema_extra={"unit": "eV/A"},
    )
    max_steps: int = Field(
        default=80, ge=1, le=500, description="steps of that relaxation, on one mesh and again on both"
    )


class ElasticSettings(Settings):
    """Effective modulus E* from density functional theory (docs/elastic.md)."""

    material: str = Field(
        default="silicon_nitride",
        pattern=r"^[A-Za-z0-9_-]{1,60}$",
        description="file in config/materials: the computed body",
    )
    counter_body: str = Field(
        default="titanium",
        pattern=r"^[A-Za-z0-9_-]{1,60}$",
        description="file in config/materials: the other body, from experiment",
    )
    crystals: tuple[str, ...] = Field(
        default=("beta",), description="crystals of the material scanned beside the glass, to anchor the engine"
    )
    strains: tuple[Annotated[float, Field(gt=-0.2, lt=0.2)], ...] = Field(
        default=(-0.03, -0.015, 0.0, 0.015, 0.03),
        min_length=5,
        description="linear isotropic strains of an E(V) scan; at least five",
    )
    lda_structures: int = Field(default=4, ge=0, le=1000, description="glasses also computed with LDA")
    lda_centre: float = Field(
        default=-0.012,
        gt=-0.1,
        lt=0.1,
        description="strain about which LDA is scanned: its volume is some 4 % smaller than that of GGA",
    )
    relaxed_structures: int = Field(
        default=2,
        ge=0,
        le=1000,
        description="glasses also computed with ions relaxed at every strain",
    )
    relaxed_force_eV_A: float = Field(
        default=0.15,
        gt=0,
        le=5,
        description="largest force left when ions relax at a strain",
        json_schema_extra={"unit": "eV/A"},
    )
    ions: Literal["clamped", "relaxed"] = Field(
        default="clamped",
        description="which bulk moduli go into E* (the paper's scaling of all positions is 'clamped')",
    )
    poisson_ratio: tuple[float, float] = Field(
        default=(0.15, 0.25),
        description="range of the glass's Poisson ratio (Kim et al. 2013)",
    )
    poisson: Literal["literature", "computed"] = Field(
        default="literature",
        description="Poisson's ratio from the range above (the paper), or with B from elastic constants of the glasses",
    )
    size_error: float = Field(
        default=0.02,
        ge=0,
        le=1,
        description="with 'computed', standard deviation of a factor on B and G for what the size of the cell changes",
    )
    min_structures: int = Field(
        default=4,
        ge=2,
        le=1000,
        description="trusted bulk moduli below which E* fails its gate",
    )
    samples: int = Field(default=20_000, ge=100, le=10_000_000, description="samples of E*")
    seed: int = Field(default=1, ge=0, le=1_000_000, description="seed of the samples of E*")
    glass: NitrideGlassSettings = NitrideGlassSettings()
    dft: DftSettings = DftSettings()
    relaxation: RelaxationSettings = RelaxationSettings()
    tensor: TensorSettings = TensorSettings()

    @field_validator("poisson_ratio")
    @classmethod
    def _stable_solid(cls, value: tuple[float, float]) -> tuple[float, float]:
        if not -1 < value[0] < value[1] < 0.5:
            raise ValueError("two increasing numbers between -1 and 0.5: at 0.5 a solid has no finite E = 3B(1-2ν)")
        return value

    @model_validator(mode="after")
    def _stress_at_hand(self) -> "ElasticSettings":
        if self.poisson == "computed" and self.dft.engine == "pyscf" and self.dft.numerics != "cached-grid":
            raise ValueError(
                f"poisson 'computed' needs the stress, which dft.numerics {self.dft.numerics!r} does not give; "
                "use 'cached-grid'"
            )
        return self

    @field_validator("strains")
    @classmethod
    def _different(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        if len(set(value)) != len(value):
            raise ValueError("strains must differ from each other")
        return value
