"""Settings of the switch."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field
from pydantic.config import JsonDict

from mesoscale.settings.base import Settings

UM: JsonDict = {"unit": "um"}
NM: JsonDict = {"unit": "nm"}
GPA: JsonDict = {"unit": "GPa"}
LARGEST_BOW_NM = 1e5
PLACES_AT_REST = 1000
"""Parts of the beam among whose ends the lowest place at rest is sought."""


class DeviceSettings(Settings):
    """Switch driven by the force-separation law (docs/device.md).

    The defaults are the published fixed-fixed beam of the PRISM capacitive switch.
    """

    length_um: float = Field(
        default=510.0, ge=0.01, le=1e5, description="length of the fixed-fixed beam", json_schema_extra=UM
    )
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
    residual_stress_MPa: float = Field(
        default=0.0,
        ge=0,
        le=2000,
        description="tensile residual stress of the beam; stiffens it",
        json_schema_extra={"unit": "MPa"},
    )
    spring_N_per_m: float | None = Field(
        default=None,
        ge=1e-9,
        le=1e6,
        description="stiffness of a parallel-plate switch; null computes it from the beam",
        json_schema_extra={"unit": "N/m"},
    )
    electrode_um2: float | None = Field(
        default=None,
        ge=1e-4,
        le=1e9,
        description="electrode area; null is the whole beam, length times width",
        json_schema_extra={"unit": "um^2"},
    )
    bow_nm: float = Field(
        default=0.0,
        ge=-LARGEST_BOW_NM,
        le=LARGEST_BOW_NM,
        description="how much farther from the dielectric the beam is in its middle than at its ends, at rest",
        json_schema_extra=NM,
    )
    tilt_nm: float = Field(
        default=0.0,
        ge=0,
        le=1e5,
        description="how much farther from the dielectric one end of the beam is than the other",
        json_schema_extra=NM,
    )
    bow_deviation_nm: float = Field(
        default=200.0,
        ge=0,
        le=1e5,
        description="standard deviation of the bow; the default is an assumption without a source, an uncertain "
        "input of the answer",
        json_schema_extra=NM,
    )
    tilt_deviation_nm: float = Field(
        default=200.0,
        ge=0,
        le=1e5,
        description="standard deviation of the tilt; the default is an assumption without a source, an uncertain "
        "input of the answer",
        json_schema_extra=NM,
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
        gt=0,
        le=1e5,
        description="voltage of the closed switch; null is its own pull-in voltage",
        json_schema_extra={"unit": "V"},
    )

    @property
    def area_um2(self) -> float:
        """Area of the electrode, um^2."""
        return self.electrode_um2 or self.length_um * self.width_um

    def shape_at_rest_nm(self, share: ArrayLike) -> NDArray[np.float64]:
        """Height of the bending electrode at rest over its flat place (nm), at shares of its length from one end."""
        share = np.asarray(share, float)
        return self.bow_nm * 0.5 * (1.0 - np.cos(2.0 * np.pi * share)) + self.tilt_nm * (share - 0.5)

    @property
    def touching_at_rest(self) -> str:
        """One line on a bending electrode that touches the dielectric at rest; empty where it does not."""
        shares = np.arange(PLACES_AT_REST + 1) / PLACES_AT_REST
        lowest_nm = 1e3 * self.gap_um + float(self.shape_at_rest_nm(shares).min())
        if self.spring_N_per_m is not None or lowest_nm > 0.0:
            return ""
        return (
            f"device: at rest the electrode is {lowest_nm:.4g} nm above the dielectric at its lowest; "
            "lower bow_nm or tilt_nm, or raise gap_um"
        )
