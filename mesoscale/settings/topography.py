"""Settings of the topography stage."""

from typing import Literal

from pydantic import Field

from mesoscale.settings.base import Settings


class SyntheticScanSettings(Settings):
    """Synthetic AFM scans with known truth, used when no scans are given (docs/topography.md)."""

    small_scans: int = Field(default=8, ge=0, le=100, description="number of small scans, of 1 um")
    large_scans: int = Field(default=3, ge=0, le=100, description="number of large scans")
    large_length_nm: float = Field(
        default=10000.0, gt=0, le=1e6, description="side of a large scan", json_schema_extra={"unit": "nm"}
    )
    pixels: int = Field(default=1024, ge=32, le=8192, description="pixels per side of a scan")


class InstrumentSettings(Settings):
    """What an instrument can see, for the measurements of a name; what is null is taken from the file."""

    files: str = Field(
        min_length=1,
        max_length=200,
        description="names of files, or of measurements in a container, that it applies to; * stands for any text",
    )
    tip_radius_nm: float | None = Field(
        default=None,
        ge=0,
        le=1e5,
        description="radius of its tip, bounds the wave vectors that are trusted; 0: no tip (a side view)",
        json_schema_extra={"unit": "nm"},
    )
    shortest_wave_nm: float | None = Field(
        default=None,
        gt=0,
        le=1e6,
        description="shortest wavelength that it passes (filter, resolution)",
        json_schema_extra={"unit": "nm"},
    )
    noise_nm: float | None = Field(
        default=None, ge=0, le=1e4, description="RMS noise of a height", json_schema_extra={"unit": "nm"}
    )
    channel: str | None = Field(default=None, description="name of its height channel; null: topography.channel")
    unit: Literal["m", "mm", "um", "nm", "pm"] | None = Field(
        default=None, description="length unit of positions and heights, for text that states none"
    )


class TopographySettings(Settings):
    """AFM scans to spectrum and roughness parameters (docs/topography.md)."""

    scans: tuple[str, ...] = Field(
        default=(),
        max_length=200,
        description="measurements of one surface: scans, line profiles (any format of SurfaceTopography), containers "
        "of contact.engineering, folders of these; relative to the working directory or to the scene; empty: synthetic "
        "scans with known truth",
    )
    instruments: tuple[InstrumentSettings, ...] = Field(
        default=(), max_length=100, description="limits of the instruments, the first that fits a name"
    )
    channel: str | None = Field(
        default=None,
        description="name of the height channel; null takes the only one (or the first of trace and retrace)",
    )
    tip_radius_nm: float = Field(
        default=5.0,
        ge=0,
        le=1000,
        description="radius of the AFM tip where neither `instruments` nor the file states one, bounds the range of "
        "wave vectors that is trusted; 0: no bound",
        json_schema_extra={"unit": "nm"},
    )
    detrend: Literal["none", "plane", "quadratic"] = Field(
        default="plane", description="what is subtracted from each scan as tilt and scanner bow"
    )
    line_alignment: Literal["none", "median"] = Field(
        default="median", description="what is subtracted from each scan line"
    )
    max_missing: float = Field(
        default=0.05,
        ge=0,
        le=0.5,
        description="largest share of missing pixels that is filled from neighbours; above, the scan is refused",
    )
    ranges: Literal["scatter", "interval"] = Field(
        default="scatter",
        description="range that feeds the inputs: scatter between scans (as the paper), or the confidence "
        "interval of the typical value",
    )
    convention: Literal["profile", "areal"] = Field(
        default="areal",
        description="how H follows from the slope of the two-dimensional spectrum: profile 2H+1 (as the paper "
        "prints it), areal 2H+2; contact.reading.convention must be the same",
    )
    description: Literal["auto", "power_law", "measured_spectrum", "measured_heights"] = Field(
        default="auto",
        description="how random surfaces follow the measurements: eq. 9, the measured spectrum, or the measured "
        "spectrum with the measured heights; auto: the first that the measurements do not contradict",
    )
    on_doubt: Literal["stop", "warn"] = Field(
        default="stop",
        description="what happens to measurements that no description fits: stop before they are used, or warn in the "
        "report and use them",
    )
    synthetic: SyntheticScanSettings = SyntheticScanSettings()
