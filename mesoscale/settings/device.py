"""Settings of the switch."""

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, model_validator
from pydantic.config import JsonDict

from mesoscale.settings.base import Settings
from mesoscale.settings.inputs import DistributionRow

UM: JsonDict = {"unit": "um"}
NM: JsonDict = {"unit": "nm"}
GPA: JsonDict = {"unit": "GPa"}
MPA: JsonDict = {"unit": "MPa"}
SHARE: JsonDict = {"unit": "share of the length"}
LARGEST_BOW_NM = 1e5
PLACES_AT_REST = 1000
"""Parts of the beam among whose ends the lowest place at rest is sought."""
REFERENCE_C = 20.0
"""Temperature at which stress and shape at rest are stated."""
WIDE = 5.0
"""A beam at least this many times as wide as thick bends as a plate (Osterberg and Senturia, J. MEMS 6 (1997) 107)."""
Part = tuple[float, float]


class SpreadRow(DistributionRow):
    """By how much one property of the device departs from its stated value."""

    relative: bool = Field(default=False, description="whether departures are shares of the stated value")
    varies: Literal["common", "each"] = Field(
        default="each", description="one unknown value for all devices (common), or another for each of them"
    )


ASSUMED = "assumption, to be replaced by a measurement"


def _departs(name: str, row: SpreadRow | None) -> Any:
    return Field(default=row, description=f"departures of device.{name}; null: exactly known")


def _normal(deviation: float, source: str = ASSUMED, **what: Any) -> SpreadRow:
    return SpreadRow(distribution="normal", values=(0.0, deviation), source=source, **what)


class SpreadSettings(Settings):
    """Departures of a device from its stated properties, uncertain inputs of the answer (docs/device.md)."""

    thickness_um: SpreadRow | None = _departs("thickness_um", _normal(0.02, relative=True))
    gap_um: SpreadRow | None = _departs("gap_um", _normal(0.02, relative=True))
    youngs_modulus_GPa: SpreadRow | None = _departs(
        "youngs_modulus_GPa",
        _normal(
            0.05,
            f"{ASSUMED}; plated nickel has 85 to 205 GPa (Luo et al., Mater. Lett. 58 (2004) 2306)",
            relative=True,
            varies="common",
        ),
    )
    residual_stress_MPa: SpreadRow | None = _departs("residual_stress_MPa", _normal(5.0))
    dielectric_nm: SpreadRow | None = _departs(
        "dielectric_nm",
        _normal(
            0.03,
            "nitride over a wafer: 2.5 % by LPCVD, 7 % by PECVD (MEMS Exchange, processes P3684 and P3822)",
            relative=True,
        ),
    )
    permittivity: SpreadRow | None = _departs("permittivity", _normal(0.05, relative=True, varies="common"))
    bow_nm: SpreadRow | None = _departs("bow_nm", _normal(200.0))
    tilt_nm: SpreadRow | None = _departs("tilt_nm", _normal(200.0))
    temperature_C: SpreadRow | None = _departs("temperature_C", None)


SPREAD = tuple(SpreadSettings.model_fields)
OF_A_PLATE = ("gap_um", "dielectric_nm", "permittivity")
"""What can vary of a plate on a spring."""
"""The properties of a device that can be uncertain."""


class DeviceSettings(Settings):
    """Switch driven by the force-separation law (docs/device.md).

    The defaults are the published fixed-fixed beam of the PRISM capacitive switch.
    """

    ends: Literal["clamped", "cantilever"] = Field(
        default="clamped", description="beam clamped at both ends, or at its first end only"
    )
    length_um: float = Field(default=510.0, ge=0.01, le=1e4, description="length of the beam", json_schema_extra=UM)
    width_um: float = Field(default=123.0, ge=0.01, le=1e5, description="width of the beam", json_schema_extra=UM)
    thickness_um: float = Field(
        default=4.0, ge=0.001, le=1e3, description="thickness of the beam", json_schema_extra=UM
    )
    gap_um: float = Field(
        default=3.49,
        gt=0.01,
        le=1e3,
        description="distance from the beam at rest to the mean plane of the dielectric",
        json_schema_extra=UM,
    )
    youngs_modulus_GPa: float = Field(
        default=89.3, ge=1e-3, le=2000, description="Young's modulus of the beam", json_schema_extra=GPA
    )
    poisson_ratio: float = Field(default=0.3, ge=0, lt=0.5, description="Poisson's ratio of the beam")
    bends_as: Literal["beam", "plate"] | None = Field(
        default=None,
        description="bends with E (beam) or E/(1 - nu^2) (plate); null: as a plate from a width of 5 thicknesses on",
    )
    residual_stress_MPa: float = Field(
        default=0.0,
        ge=-2000,
        le=2000,
        description="residual stress of the beam at rest at 20 C; negative: compressive, and beyond Euler's it buckles",
        json_schema_extra=MPA,
    )
    buckled: Literal["up", "down"] = Field(
        default="up", description="side to which a beam stands that its stress buckles; up: away from the dielectric"
    )
    temperature_C: float = Field(
        default=REFERENCE_C, ge=-270, le=2000, description="temperature of the switch", json_schema_extra={"unit": "C"}
    )
    expansion_ppm_C: float = Field(
        default=13.4,
        ge=-100,
        le=1000,
        description="thermal expansion of the beam; the default is nickel's",
        json_schema_extra={"unit": "1e-6/C"},
    )
    substrate_expansion_ppm_C: float = Field(
        default=2.6,
        ge=-100,
        le=1000,
        description="thermal expansion of the substrate between the anchors; the default is silicon's",
        json_schema_extra={"unit": "1e-6/C"},
    )
    anchor_um_per_N: float = Field(
        default=0.0,
        ge=0,
        le=1e9,
        description="by how much both anchors together give way to the axial force; 0: rigid",
        json_schema_extra={"unit": "um/N"},
    )
    spring_N_per_m: float | None = Field(
        default=None,
        ge=1e-3,
        le=1e6,
        description="stiffness of a parallel-plate switch; null computes it from the beam",
        json_schema_extra={"unit": "N/m"},
    )
    electrode_um2: float | None = Field(
        default=None,
        ge=1e-4,
        le=1e9,
        description="electrode area of a parallel-plate switch; null is length times width",
        json_schema_extra={"unit": "um^2"},
    )
    electrode: Part = Field(
        default=(0.0, 1.0),
        description="part of the beam over the electrode that pulls it, from and to",
        json_schema_extra=SHARE,
    )
    contact: Part = Field(
        default=(0.0, 1.0),
        description="part of the beam over the rough pad, from and to; elsewhere it lands on stoppers",
        json_schema_extra=SHARE,
    )
    dimple_nm: float = Field(
        default=0.0, ge=0, le=1e5, description="height of a dimple under the contact part", json_schema_extra=NM
    )
    stopper_nm: float = Field(
        default=0.0,
        ge=0,
        le=1e5,
        description="height of the stoppers, rigid, where the beam has no contact part; 0: the dielectric itself",
        json_schema_extra=NM,
    )
    fringe: float = Field(
        default=0.64,
        ge=0,
        le=10,
        description="pull of the field at the sides, as this many gaps of more width; 0.64 of a thin strip over a "
        "plane (Palmer, Trans. AIEE 56 (1937) 363)",
    )
    bow_nm: float = Field(
        default=0.0,
        ge=-LARGEST_BOW_NM,
        le=LARGEST_BOW_NM,
        description="how much farther from the dielectric the beam is in its middle (of a cantilever: at its tip) than "
        "at its anchors, at rest",
        json_schema_extra=NM,
    )
    tilt_nm: float = Field(
        default=0.0,
        ge=-1e5,
        le=1e5,
        description="how much farther from the dielectric the last end of the beam is than the first",
        json_schema_extra=NM,
    )
    spread: SpreadSettings = Field(
        default=SpreadSettings(), description="departures from these properties, as uncertain inputs"
    )
    dielectric_nm: float = Field(
        default=200.0, ge=0, le=1e5, description="thickness of the dielectric", json_schema_extra=NM
    )
    permittivity: float = Field(default=7.9, ge=1, le=1e5, description="relative permittivity of the dielectric")
    adhesion_scale: float = Field(
        default=1.0,
        ge=0,
        le=10,
        description="factor on the attraction of the law; 0.1 brings it near measured dry adhesion",
    )
    density_g_cm3: float = Field(
        default=8.9,
        ge=0.01,
        le=30,
        description="density of the electrode, for its motion; the default is nickel's",
        json_schema_extra={"unit": "g/cm^3"},
    )
    gas_kPa: float = Field(
        default=101.325,
        ge=1e-6,
        le=1e4,
        description="pressure of the air around the electrode, for its motion",
        json_schema_extra={"unit": "kPa"},
    )
    hold_voltage_V: float | None = Field(
        default=None,
        ge=1e-3,
        le=1e4,
        description="voltage of the closed switch; null is its own pull-in voltage",
        json_schema_extra={"unit": "V"},
    )

    @model_validator(mode="after")
    def _parts_of_the_beam(self) -> "DeviceSettings":
        for name in ("electrode", "contact"):
            start, end = getattr(self, name)
            if not 0.0 <= start < end <= 1.0:
                raise ValueError(f"{name} = [{start:g}, {end:g}]: accepted are two rising shares of the length, 0 to 1")
        return self

    @property
    def bends(self) -> bool:
        """Whether the electrode is a beam; else a plate on a spring."""
        return self.spring_N_per_m is None

    @property
    def area_um2(self) -> float:
        """Area of the electrode, um^2."""
        return self.electrode_um2 or (self.electrode[1] - self.electrode[0]) * self.length_um * self.width_um

    @property
    def pad_um2(self) -> float:
        """Area of the rough pad, um^2."""
        if not self.bends:
            return self.area_um2
        return (self.contact[1] - self.contact[0]) * self.length_um * self.width_um

    @property
    def bending_GPa(self) -> float:
        """Modulus of bending: E, or E / (1 - nu^2) of a wide beam, whose edges cannot curl."""
        wide = self.width_um >= WIDE * self.thickness_um
        plate = wide if self.bends_as is None else self.bends_as == "plate"
        return self.youngs_modulus_GPa / (1.0 - self.poisson_ratio**2 if plate else 1.0)

    @property
    def heating_MPa(self) -> float:
        """Axial stress by the temperature, -E (alpha_beam - alpha_substrate) (T - 20 C)."""
        strain = 1e-6 * (self.expansion_ppm_C - self.substrate_expansion_ppm_C) * (self.temperature_C - REFERENCE_C)
        return -1e3 * self.youngs_modulus_GPa * strain

    def shape_at_rest_nm(self, share: ArrayLike) -> NDArray[np.float64]:
        """Height of the bending electrode at rest over its flat place (nm), at shares of its length from one end."""
        x = np.asarray(share, float)
        if self.ends == "cantilever":
            return self.bow_nm * x**2 + self.tilt_nm * x
        return self.bow_nm * 0.5 * (1.0 - np.cos(2.0 * np.pi * x)) + self.tilt_nm * (x - 0.5)

    def slope_at_rest_nm(self, share: ArrayLike) -> NDArray[np.float64]:
        """Derivative of `shape_at_rest_nm` by the share."""
        x = np.asarray(share, float)
        if self.ends == "cantilever":
            return 2.0 * self.bow_nm * x + self.tilt_nm
        return self.bow_nm * np.pi * np.sin(2.0 * np.pi * x) + self.tilt_nm

    @property
    def touching_at_rest(self) -> str:
        """One line on a bending electrode that touches at rest; empty where it does not."""
        shares = np.linspace(0.0, 1.0, PLACES_AT_REST + 1)
        height = 1e3 * self.gap_um + self.shape_at_rest_nm(shares)
        within = (self.contact[0] <= shares) & (shares <= self.contact[1])
        lowest_nm = float((height - np.where(within, self.dimple_nm, self.stopper_nm)).min())
        if not self.bends or lowest_nm > 0.0:
            return ""
        return (
            f"device: at rest the electrode is {lowest_nm:.4g} nm above what it lands on at its lowest; "
            "lower bow_nm, tilt_nm, dimple_nm or stopper_nm, or raise gap_um"
        )

    @property
    def varied(self) -> list[str]:
        """The properties that are not exactly known."""
        names = SPREAD if self.bends else OF_A_PLATE
        return [name for name in names if getattr(self.spread, name) is not None]

    @property
    def without_lumps(self) -> str:
        """One line on a beam that has no lumps, which are those of a symmetric one; empty where it has."""
        if self.ends == "clamped" and self.electrode == self.contact == (0.0, 1.0):
            return ""
        return (
            "device.ends, electrode, contact: circuits are made of beams clamped at both ends, with electrode and pad "
            "all along; take clamped, [0, 1] and [0, 1], or leave the circuit out"
        )


def unit_of(name: str) -> str:
    """Unit of a key of the device; 1 where it has none."""
    extra = DeviceSettings.model_fields[name].json_schema_extra
    return str(extra["unit"]) if isinstance(extra, dict) and "unit" in extra else "1"
