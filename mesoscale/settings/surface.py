"""Settings of the contacting surface beyond q0, Hurst exponent and RMS of Table 1."""

from typing import Annotated

from pydantic import Field, model_validator

from mesoscale.settings.base import Settings

Positive = Annotated[float, Field(ge=1e-30, le=1e12)]


class CounterfaceSettings(Settings):
    """A second rough surface: the flat meets the sum of both spectra, the effective roughness."""

    q0: float = Field(ge=1e-7, le=10, description="its roll-off wave vector", json_schema_extra={"unit": "1/nm"})
    hurst: float = Field(ge=1e-6, le=2, description="its Hurst exponent, in contact.reading.convention")
    rms_nm: float = Field(ge=1e-5, le=1e4, description="its RMS height", json_schema_extra={"unit": "nm"})


class SpectrumSettings(Settings):
    """A spectrum by points instead of the form of eq. 9; only its shape counts, the RMS is that of Table 1."""

    q: tuple[Positive, ...] = Field(
        min_length=2, max_length=10000, description="wave vectors in rising order", json_schema_extra={"unit": "1/nm"}
    )
    psd: tuple[Positive, ...] = Field(
        min_length=2,
        max_length=10000,
        description="C at these, of the two-dimensional spectrum",
        json_schema_extra={"unit": "nm^4"},
    )

    q0: float | None = Field(
        default=None,
        ge=1e-7,
        le=1e3,
        description="with `hurst`: eq. 9 nearest to the points; the inputs' q0 and hurst then bend the spectrum by the "
        "ratio of their eq. 9 to this one; null: they are unused",
        json_schema_extra={"unit": "1/nm"},
    )
    hurst: float | None = Field(
        default=None, ge=1e-6, le=2, description="its Hurst exponent, in contact.reading.convention"
    )

    @model_validator(mode="after")
    def _a_function(self) -> "SpectrumSettings":
        if len(self.psd) != len(self.q):
            raise ValueError(f"psd has {len(self.psd)} values, q has {len(self.q)}; accepted are lists of one length")
        if any(later <= earlier for earlier, later in zip(self.q, self.q[1:], strict=False)):
            raise ValueError("q is not in rising order")
        if (self.q0 is None) != (self.hurst is None):
            raise ValueError("q0 and hurst go together; give both or neither")
        return self


class SurfaceSettings(Settings):
    """The contacting surface (docs/topography.md, Surfaces)."""

    spectrum: SpectrumSettings | None = Field(
        default=None, description="spectrum by points (q0 and hurst of Table 1 are then unused); null: eq. 9"
    )
    counterface: CounterfaceSettings | None = Field(
        default=None, description="second rough surface; null: the counterface is flat"
    )
    heights: tuple[Annotated[float, Field(ge=-1000, le=1000)], ...] = Field(
        default=(),
        max_length=111,
        description="measured heights: their values in units of the RMS at the normal variables -5, -4.9, ... 6 (as "
        "topography/parameters.json has them); empty: a normal distribution",
    )

    @model_validator(mode="after")
    def _one_distribution(self) -> "SurfaceSettings":
        if self.heights and len(self.heights) != 111:
            raise ValueError("heights: accepted are 111 values")
        return self
