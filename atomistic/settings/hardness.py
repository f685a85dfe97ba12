"""Size-dependent hardness from molecular dynamics (docs/hardness.md)."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from asperity.guards.settings import Settings, key


class GlassSettings(Settings):
    """Melt and quench of a periodic glass cell."""

    atoms: int = key(690, "atoms of the cell, about", "[100, 2_000_000]")
    melt_ps: float = key(8, "time in the melt", "[0.001, 10_000] ps")
    quench_rate_K_ps: float = key(50, "cooling rate at zero pressure", "[0.001, 2000] K/ps")
    rest_ps: float = key(4, "rest after the quench", "[0.001, 10_000] ps")


EnergyScales = tuple[Annotated[float, Field(ge=1e-3, le=2)], ...]


class AsperitySettings(Settings):
    """An asperity, min[A sin(2 pi x / lambda), A sin(2 pi y / lambda)] (Kim et al. 2013, eq. 6)."""

    name: str = key(..., "name in file names and tables", pattern=r"^[A-Za-z][A-Za-z0-9]{0,39}$")
    tiles: int = key(
        ..., "wavelength lambda in glass cells, so that nothing is strained", "[1, 40]"
    )
    amplitude_nm: float = key(..., "amplitude A", "[0.001, 10] nm")
    film_nm: float | None = key(
        None, "oxide on hardness.base; 0: the base alone; null: all oxide", "[0, 100] nm"
    )
    energy_scales: EnergyScales | None = key(
        None,
        "factors on the energies of this asperity; null: those of hardness.energy_scales",
        min_length=1,
    )


class ClosingSettings(Settings):
    """Closing of an asperity against a rigid flat, frictionless and repulsive."""

    speed_m_s: float = key(50, "closing speed", "[0.001, 1000] m/s")
    stop: Literal["settled", "window"] = key(
        "settled",
        "end of a run: plateau stress known to 4 % (settled), or contact on half of the cell",
    )
    base_nm: float = key(
        2.6, "least thickness below the mean height; at least the widest contact", "[1, 100] nm"
    )
    anneal_ps: float = key(
        5, "time of the anneal of the cut surface and again of its cooling", "[0.001, 10_000] ps"
    )
    processes: int = key(
        1, "MPI processes of one closing run, started as docs/cluster.md says", "[1, 4096]"
    )


class HardnessSettings(Settings):
    """Size-dependent hardness from molecular dynamics (docs/hardness.md)."""

    potential: str = key("pmmcs", "name of a file in config/potentials, or a path")
    material: str = key(
        "SiO2", "oxide of the asperity: formula of a file in config/materials with an oxide_glass"
    )
    base: str | None = key(
        None, "body below the films: a file in config/materials with a film_base, such as titanium"
    )
    energy_scales: EnergyScales = key(
        (1.0,),
        "factors on all energies; 0.5 is the twin that tells the error of the potential's form",
        min_length=1,
    )
    energies: Literal["measured", "scales"] = key(
        "measured",
        "range of the potential's energies: that which bounds the measured indentation of the oxide"
        " (measured), or the energy scales themselves, each as likely, as Kim et al. (2013) take"
        " them (scales)",
    )
    seeds: tuple[Annotated[int, Field(ge=0, le=1_000_000)], ...] = key(
        (1, 2), "seeds of the glasses", min_length=1
    )
    asperities: tuple[AsperitySettings, ...] = key(
        (
            AsperitySettings(name="small", tiles=2, amplitude_nm=0.43, energy_scales=(1.0, 0.5)),
            AsperitySettings(name="medium", tiles=3, amplitude_nm=0.64),
            AsperitySettings(name="large", tiles=4, amplitude_nm=0.86),
        ),
        "asperities to close",
        min_length=1,
    )
    glass: GlassSettings = GlassSettings()
    closing: ClosingSettings = ClosingSettings()

    @model_validator(mode="after")
    def _films_have_a_base(self) -> "HardnessSettings":
        films = [asperity.name for asperity in self.asperities if asperity.film_nm is not None]
        if films and self.base is None:
            raise ValueError(
                f"asperities: {films[0]} has a film_nm, but there is no base; name what lies below"
                " (titanium)"
            )
        if self.base is not None and not films:
            raise ValueError(
                f"base {self.base!r:.60}: no asperity has a film_nm; add it, or leave base out"
            )
        return self

    @model_validator(mode="after")
    def _some_energies_are_whole(self) -> "HardnessSettings":
        for asperity in self.asperities:
            if 1.0 not in self.scales_of(asperity):
                key = (
                    "energy_scales"
                    if asperity.energy_scales is None
                    else f"asperities: {asperity.name}"
                )
                raise ValueError(
                    f"{key}: energies without 1.0; a twin is compared with the potential itself:"
                    " add 1.0"
                )
        scales = {scale for asperity in self.asperities for scale in self.scales_of(asperity)}
        if self.energies == "scales" and len(scales) == 1:
            raise ValueError(
                "energies: scales, but all asperities have full energies; add 0.5 to energy_scales"
            )
        return self

    def scales_of(self, asperity: AsperitySettings) -> EnergyScales:
        """Factors on the energies of an asperity."""
        return asperity.energy_scales or self.energy_scales

    @model_validator(mode="after")
    def _names_differ(self) -> "HardnessSettings":
        if len({asperity.name for asperity in self.asperities}) < len(self.asperities):
            raise ValueError(
                "asperities: two have the same name; their results would be the same files"
            )
        return self
