"""Effective modulus E* from density functional theory (docs/elastic.md)."""

from pydantic import field_validator

from asperity.guards.settings import Settings, key


class NitrideGlassSettings(Settings):
    """Melt and quench of a small amorphous Si3N4 cell (Tersoff potential and soft cores)."""

    formula_units: int = key(4, "formula units of 7 atoms per cell", "[2, 64]")
    max_defects: int = key(
        0,
        "atoms of a quenched cell that may lack or exceed their valence; large models have 3 of 28",
        "[0, 1000]",
    )


class DftSettings(Settings):
    """The density functional calculations (PySCF)."""

    cutoff_Ha: float = key(
        100, "plane-wave cutoff of the density; forces take at most 80", "[20, 1000] hartree"
    )
    relaxation_steps: int = key(
        15, "most steps in which ions of a glass come to rest; 0: none", "[0, 500]"
    )

    @property
    def forces_cutoff_Ha(self) -> float:
        """Cutoff of forces: 80 Ha are within 0.5 eV/Å of 140; no volumes are compared."""
        return min(self.cutoff_Ha, 80.0)


class ElasticSettings(Settings):
    """Effective modulus E* from density functional theory (docs/elastic.md)."""

    material: str = key(
        "silicon_nitride",
        "file in config/materials: the computed body",
        pattern=r"^[A-Za-z0-9_-]{1,60}$",
    )
    counter_body: str = key(
        "titanium",
        "file in config/materials: the other body, from experiment",
        pattern=r"^[A-Za-z0-9_-]{1,60}$",
    )
    structures: int = key(
        8, "glasses whose E(V) is computed with GGA, half of them also with LDA", "[1, 1000]"
    )
    crystals: tuple[str, ...] = key(
        ("beta",), "crystals of the material, scanned to anchor the engine"
    )
    poisson_ratio: tuple[float, float] = key(
        (0.15, 0.25), "range of the glass's Poisson ratio; the default is that of Kim et al. (2013)"
    )
    seed: int = key(1, "seed of the glasses and of the samples of E*", "[0, 1_000_000]")
    glass: NitrideGlassSettings = NitrideGlassSettings()
    dft: DftSettings = DftSettings()

    @field_validator("poisson_ratio")
    @classmethod
    def _stable_solid(cls, value: tuple[float, float]) -> tuple[float, float]:
        if not -1 < value[0] < value[1] < 0.5:
            raise ValueError(
                "two increasing numbers between -1 and 0.5: at 0.5 a solid has no finite E ="
                " 3B(1-2ν)"
            )
        return value
