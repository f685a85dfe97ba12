"""Settings of the contacting surface beyond q0, Hurst exponent and RMS of Table 1."""

from typing import Annotated

from pydantic import Field, model_validator

from asperity.guards.settings import Settings, key

Positive = Annotated[float, Field(ge=1e-30, le=1e12)]
PsdValue = Annotated[float, Field(ge=1e-60, le=1e60)]
"""As far apart as logarithms of single precision are: of a spectrum by points only the shape
counts.
"""


class SpectrumSettings(Settings):
    """A spectrum by points instead of eq. 9; only its shape counts, the RMS is that of Table 1."""

    q: tuple[Positive, ...] = key(
        ..., "wave vectors in rising order", "1/nm", min_length=2, max_length=10000
    )
    psd: tuple[PsdValue, ...] = key(
        ..., "C at these, of the two-dimensional spectrum", "nm^4", min_length=2, max_length=10000
    )

    q0: float | None = key(
        None,
        "with `hurst`: eq. 9 nearest to the points; the inputs' q0 and hurst then bend the spectrum"
        " by the ratio of their eq. 9 to this one; null: they are unused",
        "[1e-7, 1000] 1/nm",
    )
    hurst: float | None = key(
        None, "its Hurst exponent, in contact.reading.convention", "[1e-6, 2]"
    )

    @model_validator(mode="after")
    def _a_function(self) -> "SpectrumSettings":
        if len(self.psd) != len(self.q):
            raise ValueError(
                f"psd has {len(self.psd)} values, q has {len(self.q)}; accepted are lists of one"
                " length"
            )
        pairs = zip(self.q, self.q[1:], strict=False)
        if any(later <= earlier for earlier, later in pairs):
            raise ValueError("q is not in rising order")
        if (self.q0 is None) != (self.hurst is None):
            raise ValueError("q0 and hurst go together; give both or neither")
        return self


class SurfaceSettings(Settings):
    """The contacting surface (docs/topography.md, Surfaces)."""

    spectrum: SpectrumSettings | None = key(None, "spectrum by points; null: eq. 9")
    heights: tuple[Annotated[float, Field(ge=-1000, le=1000)], ...] = key(
        (),
        "measured heights: their values in units of the RMS at the normal variables -5, -4.9, ... 6"
        " (as topography/parameters.json has them); empty: a normal distribution",
        max_length=111,
    )

    @model_validator(mode="after")
    def _one_distribution(self) -> "SurfaceSettings":
        if self.heights and len(self.heights) != 111:
            raise ValueError("heights: accepted are 111 values")
        return self
