"""Settings of the contact model."""

import math
from collections.abc import Sequence
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from asperity.guards.settings import Settings, key
from mesoscale.settings.surface import SurfaceSettings

AttractionLaw = Literal["clamped", "offset"]
Opening = Literal["balance", "volume"]
FilmThickness = Annotated[float, Field(ge=0.0, le=1000.0)]
WORK_FACTOR: dict[AttractionLaw, float] = {"clamped": 4.0, "offset": 12.0}
"""Work that separates two flats from touch: w = A_H / (this pi D0^2)."""
RANGE_IN_D0: dict[AttractionLaw, float] = {"clamped": 1.5, "offset": 0.5}
"""That work over the largest attraction A_H / (6 pi D0^3), in units of D0."""
WATER_CM3 = 18.07
"""Molar volume of water at 25 C, 18.015 g/mol over 0.99705 g/cm^3."""
MOST_PIXELS = 16_384
"""Sites a side that a grid may have."""
NOMINAL_SEED = 1
"""Seed of the surface of the nominal curves (figures 4 and 11)."""
NOMINAL_FORCE_NN = 1e4
"""Largest force of the comparison of models, nN (figure 4)."""
NOMINAL_LOADS_NN = (1e3, 3e3, 7e3, 1e4, 2e4, 5e4)
"""Largest forces of the series of loads, nN (figure 11)."""


def advised_grid(pixels: int) -> str:
    """Advice for a message to take so many sites a side, up to its comma; empty beyond the most."""
    if pixels > MOST_PIXELS:
        return ""
    return f"contact.pixels >= {pixels}, "


class ReadingSettings(Settings):
    """What the paper leaves open; the defaults are physical and nearest to its Tables 2 and 3."""

    convention: Literal["profile", "areal"] = key(
        "areal",
        "slope of the two-dimensional PSD: -(2H+1), as the paper prints it, or -(2H+2), an"
        " isotropic surface's",
    )
    prefactor: Literal["paper", "hertz"] = key(
        "hertz", "p of eq. 3: 2/3 as printed, or Hertz's 4/3"
    )
    radius: Literal["curvature", "truncation"] = key(
        "curvature", "asperity radius: mean curvature of the sites (eq. 2), or R = A/(2 pi delta)"
    )
    area: Literal["sites", "hertz"] = key(
        "sites", "asperity area in eq. 4: its sites, or Hertz's pi R delta"
    )
    flow_pair: Literal["paper", "wide"] = key(
        "wide",
        "second Gaussian of a flow: 3 times the radius of curvature (s2 = 3^(1/4) s1), or the"
        " width",
    )
    touching_attracts: bool = key(
        False, "whether sites in contact attract (with the gap D0) or are left out of eq. 1"
    )


class MaterialSettings(Settings):
    """An elastic layer of one of the two bodies, or its base."""

    # the table of influences resolves the ratios of these bounds
    # (tests/mesoscale/contact/test_layers.py)
    young_GPa: float = key(..., "Young's modulus", "[1e-6, 1e6] GPa")
    poisson: float = key(..., "Poisson's ratio", "[0, 0.5)")
    thickness_nm: float | None = key(None, "thickness, above 0; null: the base", "[0, 1e6] nm")


Body = tuple[MaterialSettings, ...]
"""A body from its surface down."""


def base_modulus(bodies: Sequence[Body]) -> float:
    """E* of the bases together, GPa: 1 / E* is the sum of (1 - nu^2) / E."""
    compliances = ((1.0 - body[-1].poisson ** 2) / body[-1].young_GPa for body in bodies)
    return 1.0 / sum(compliances)


class AirSettings(Settings):
    """Humid air around the contact, whose vapour condenses in narrow gaps (docs/humidity.md)."""

    humidity: float = key(0.0, "relative humidity of the liquid's vapour; 0: dry", "[0, 1)")
    temperature_C: float = key(20.0, "temperature of air and liquid", "[-100, 2000] C")
    surface_tension_mN_m: float | None = key(
        None, "surface tension of the liquid; null: water's at the temperature", "[0.001, 1e5] mN/m"
    )
    molar_volume_cm3: float | None = key(
        None, f"its molar volume; null: water's, {WATER_CM3:g}", "[0.1, 1e5] cm^3"
    )
    contact_angles_deg: tuple[float, float] = key(
        (0.0, 0.0), "contact angles of the liquid on both walls, 0 to 180"
    )
    film_nm: FilmThickness | Literal["balance", "adsorbed"] = key(
        0.0,
        "thickness of the adsorbed film on each wall, nm; balance: where its disjoining pressure is"
        " that of the menisci; adsorbed: of water as on silicates (docs/humidity.md)",
    )
    hamaker_share: float = key(
        0.3,
        "Hamaker constant across the liquid over that across air; in water 0.29 for silicon"
        " nitride, 0.35 for titanium oxide, 0.07 for silica (Bergstrom 1997,"
        " doi:10.1016/S0001-8686(97)00003-1)",
        "[0, 1]",
    )
    opening: Opening = key(
        "balance",
        "menisci open in balance with the vapour, or at constant volume (not mechanics: adhesive)",
    )

    @model_validator(mode="after")
    def _liquid_is_known(self) -> "AirSettings":
        for angle in self.contact_angles_deg:
            if not 0.0 <= angle <= 180.0:
                raise ValueError(
                    f"contact_angles_deg: {angle:g} is no contact angle; accepted are 0 to 180"
                    " degrees"
                )
        if (self.surface_tension_mN_m is None) != (self.molar_volume_cm3 is None):
            raise ValueError(
                "surface_tension_mN_m and molar_volume_cm3 go together: both of another liquid, or"
                " neither"
            )
        if self.film_nm == "adsorbed" and self.molar_volume_cm3 is not None:
            raise ValueError(
                "film_nm = adsorbed: the isotherm is that of water; give the film of another liquid"
                " in nm, or balance"
            )
        return self


class SceneContact(Settings):
    """Mesoscale contact model (docs/contact.md)."""

    mechanics: Literal["asperity", "coupled", "adhesive"] = key(
        "coupled",
        "asperities each on its own (the paper's), on one elastic half-space, or one that"
        " attraction deforms",
    )
    model: Literal["elastic", "nonlinear", "plastic"] = key(
        "plastic",
        "asperities: eq. 3 alone; eq. 4 as a cap of the force; eq. 4 with plastic flow of the"
        " surface",
    )
    pixels: int = key(1024, "grid points per side", f"[32, {MOST_PIXELS}]")
    length_nm: float = key(
        1000.0,
        "side of the square, periodic cell; with measured scans left out: it holds the shortest"
        " measured waves and most of the RMS height (docs/topography.md, Cells), and max_force_nN"
        " grows with its area",
        "[1, 1e6] nm",
    )
    max_force_nN: float = key(
        7000.0, "repulsive force at which closing turns into opening", "[1e-6, 1e12] nN"
    )
    q1_per_nm: float | None = key(
        None, "short-wave cut-off of the spectrum; null: Nyquist limit", "[1e-6, 1000] 1/nm"
    )
    attraction: AttractionLaw = key(
        "offset",
        "eq. 1: A_H/(6 pi (g + D0)^3), or the paper's A_H/(6 pi max(g, D0)^3), of twice more work"
        " within D0",
    )
    gap_cutoff_nm: float = key(
        0.165,
        "D0: distance of the walls at touch (offset), or least gap (clamped)",
        "[1e-6, 30] nm",
    )
    retardation_nm: float | None = key(
        None, "wavelength of Gregory's retardation, about 100 nm; null: none", "[1, 1e6] nm"
    )
    air: AirSettings | None = key(None, "humid air around the contact; null: dry")
    bodies: tuple[Body, ...] = key(
        (),
        "elastic layers of the two bodies, each from its surface down to its base; e_star is then"
        " that of the bases together, and scales all layers; empty: e_star alone (mechanics:"
        " coupled or adhesive)",
        max_length=2,
    )
    reading: ReadingSettings = ReadingSettings()

    @model_validator(mode="after")
    def _bodies_and_air_suit(self) -> Self:
        if any(material.thickness_nm == 0.0 for body in self.bodies for material in body):
            raise ValueError("bodies: a layer with thickness_nm = 0 is none; leave it out")
        for body in self.bodies:
            endless = [material.thickness_nm is None for material in body]
            if not body or endless != [False] * (len(body) - 1) + [True]:
                raise ValueError(
                    "bodies: each is a list of layers with thickness_nm, and at its end a base"
                    " without one"
                )
        if self.air and self.air.opening == "volume" and self.mechanics == "adhesive":
            raise ValueError(
                "air.opening = volume: an adhesive contact opens in balance; take mechanics:"
                " coupled"
            )
        if self.bodies and self.mechanics == "asperity":
            raise ValueError(
                "bodies: single asperities know one modulus; accepted with mechanics: coupled or"
                " adhesive"
            )
        return self

    @property
    def nyquist_per_nm(self) -> float:
        """Largest wave vector that the grid resolves, 1/nm."""
        return math.pi * self.pixels / self.length_nm


class ContactSettings(SceneContact):
    """The contact model with what its surface is made of, which the topography stage finds."""

    surface: SurfaceSettings = SurfaceSettings()

    def on_cell(self, length_nm: float) -> "ContactSettings":
        """The same at the same mean pressure on a cell of another side (nm)."""
        force = self.max_force_nN * (length_nm / self.length_nm) ** 2
        return ContactSettings(**{**dict(self), "length_nm": length_nm, "max_force_nN": force})
