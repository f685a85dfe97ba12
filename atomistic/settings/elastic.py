"""Effective modulus E* from density functional theory (docs/elastic.md)."""

from typing import Annotated

from pydantic import Field, field_validator

from atomistic.settings.base import Settings


class NitrideGlassSettings(Settings):
    """Melt and quench of a small amorphous Si3N4 cell (Tersoff potential and soft cores)."""

    formula_units: int = Field(default=4, ge=2, le=64, description="formula units of 7 atoms per cell")
    quench_rate_K_ps: float = Field(
        default=300, ge=1e-3, le=5000, description="cooling rate", json_schema_extra={"unit": "K/ps"}
    )
    max_defects: int = Field(
        default=0,
        ge=0,
        le=1000,
        description="atoms of a quenched cell that may lack or exceed their valence; 3 of 28 are as many as in large "
        "melt-quenched models",
    )


class DftSettings(Settings):
    """The density functional calculations (PySCF)."""

    basis: str = Field(
        default="gth-dzvp-molopt-sr", pattern=r"^gth-[a-z0-9-]{1,56}$", description="GTH basis set by PySCF's name"
    )
    cutoff_Ha: float = Field(
        default=100,
        ge=20,
        le=1000,
        description="plane-wave cutoff of the density; at most 80 where forces are computed",
        json_schema_extra={"unit": "hartree"},
    )
    relaxation_steps: int = Field(
        default=15,
        ge=0,
        le=500,
        description="steps that the ions of a quenched glass may take to rest; 0 keeps the cheap potential's geometry",
    )

    @property
    def forces_cutoff_Ha(self) -> float:
        """Plane-wave cutoff of forces: at 80 Ha they are within 0.5 eV/Å of those at 140; no volumes are compared."""
        return min(self.cutoff_Ha, 80.0)


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
    structures: int = Field(default=8, ge=1, le=1000, description="glasses whose E(V) is computed with GGA")
    lda_structures: int = Field(default=4, ge=0, le=1000, description="the first of them, also with LDA")
    crystals: tuple[str, ...] = Field(
        default=("beta",), description="crystals of the material scanned beside the glass, to anchor the engine"
    )
    strains: tuple[Annotated[float, Field(gt=-0.2, lt=0.2)], ...] = Field(
        default=(-0.03, -0.015, 0.0, 0.015, 0.03),
        min_length=5,
        description="linear isotropic strains of an E(V) scan; at least five",
    )
    poisson_ratio: tuple[float, float] = Field(
        default=(0.15, 0.25),
        description="range of the glass's Poisson ratio; the default is that of Kim et al. (2013)",
    )
    samples: int = Field(default=20_000, ge=100, le=10_000_000, description="samples of E*")
    seed: int = Field(default=1, ge=0, le=1_000_000, description="seed of the glasses and of the samples of E*")
    glass: NitrideGlassSettings = NitrideGlassSettings()
    dft: DftSettings = DftSettings()

    @field_validator("poisson_ratio")
    @classmethod
    def _stable_solid(cls, value: tuple[float, float]) -> tuple[float, float]:
        if not -1 < value[0] < value[1] < 0.5:
            raise ValueError("two increasing numbers between -1 and 0.5: at 0.5 a solid has no finite E = 3B(1-2ν)")
        return value

    @field_validator("strains")
    @classmethod
    def _different(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        if len(set(value)) != len(value):
            raise ValueError("strains must differ from each other")
        return value
