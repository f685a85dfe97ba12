"""Size-dependent hardness from molecular dynamics (docs/hardness.md)."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from atomistic.settings.base import Settings


class GlassSettings(Settings):
    """Melt and quench of a periodic glass cell."""

    atoms: int = Field(default=690, ge=100, le=2_000_000, description="atoms of the cell, about")
    melt_ps: float = Field(
        default=8, ge=1e-3, le=10_000, description="time in the melt", json_schema_extra={"unit": "ps"}
    )
    quench_rate_K_ps: float = Field(
        default=50, ge=1e-3, le=2000, description="cooling rate at zero pressure", json_schema_extra={"unit": "K/ps"}
    )
    rest_ps: float = Field(
        default=4, ge=1e-3, le=10_000, description="rest after the quench", json_schema_extra={"unit": "ps"}
    )


class AsperitySettings(Settings):
    """One asperity, Z = min[A sin(2 pi x / lambda), A sin(2 pi y / lambda)] (Kim et al. 2013, eq. 6)."""

    name: str = Field(pattern=r"^[A-Za-z][A-Za-z0-9]{0,39}$", description="name in file names and tables")
    tiles: int = Field(
        ge=1,
        le=40,
        description="wavelength lambda in glass cells, so that nothing is strained",
    )
    amplitude_nm: float = Field(ge=1e-3, le=10, description="amplitude A", json_schema_extra={"unit": "nm"})
    film_nm: float | None = Field(
        default=None,
        ge=0,
        le=100,
        description="thickness of the oxide on hardness.base; 0: the base without oxide; null: oxide throughout",
        json_schema_extra={"unit": "nm"},
    )


class ClosingSettings(Settings):
    """Closing of an asperity against a rigid flat, frictionless and repulsive."""

    speed_m_s: float = Field(
        default=50, ge=1e-3, le=1000, description="closing speed", json_schema_extra={"unit": "m/s"}
    )
    depth_over_amplitude: float = Field(
        default=2.2,
        ge=0.01,
        le=4,
        description="largest travel below the highest atom, in amplitudes",
    )
    stop: Literal["settled", "window"] = Field(
        default="settled",
        description="settled: a run ends once the mean stress of its plateau is known to 4 %; "
        "window: it ends where the contact takes up half of the cell",
    )
    base_nm: float = Field(
        default=2.6,
        ge=1,
        le=100,
        description="least thickness below the mean height; always at least the width of the largest contact",
        json_schema_extra={"unit": "nm"},
    )
    anneal_ps: float = Field(
        default=5,
        ge=1e-3,
        le=10_000,
        description="time of the anneal of the cut surface and again of its cooling",
        json_schema_extra={"unit": "ps"},
    )
    processes: int = Field(
        default=1,
        ge=1,
        le=4096,
        description="MPI processes of one closing run, started as docs/cluster.md says",
    )


class FitSettings(Settings):
    """Fit of H(A) = H_macro + H' A^-0.25."""

    h_macro_GPa: tuple[float, float] = Field(
        default=(0.7, 3.2),
        description="range of H_macro, from which H' follows (default: Kim et al. 2013, Table 1)",
        json_schema_extra={"unit": "GPa"},
    )


class HardnessSettings(Settings):
    """Size-dependent hardness from molecular dynamics (docs/hardness.md)."""

    potential: str = Field(default="pmmcs", description="name of a file in config/potentials, or a path")
    material: str = Field(
        default="SiO2", description="oxide of the asperity: formula of a file in config/materials with an oxide_glass"
    )
    base: str | None = Field(
        default=None,
        description="body below the films of asperities with a film_nm: titanium, silicon_nitride, or another file "
        "in config/materials with a film_base",
    )
    energy_scales: tuple[Annotated[float, Field(ge=1e-3, le=2)], ...] = Field(
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
    fit: FitSettings = FitSettings()

    @model_validator(mode="after")
    def _films_have_a_base(self) -> "HardnessSettings":
        films = [asperity.name for asperity in self.asperities if asperity.film_nm is not None]
        if films and self.base is None:
            raise ValueError(
                f"asperities: {films[0]} has a film_nm, but there is no base; name what lies below (titanium)"
            )
        if self.base is not None and not films:
            raise ValueError(f"base {self.base!r:.60}: no asperity has a film_nm; add it, or leave base out")
        return self

    @model_validator(mode="after")
    def _names_differ(self) -> "HardnessSettings":
        if len({asperity.name for asperity in self.asperities}) < len(self.asperities):
            raise ValueError("asperities: two have the same name; their results would be the same files")
        return self
