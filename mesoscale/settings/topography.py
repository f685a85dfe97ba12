"""Settings of the topography stage."""

from typing import Literal

from pydantic import Field

from mesoscale.settings.base import Settings


class SyntheticScanSettings(Settings):
    """Synthetic AFM scans with known truth, used when no scans are given (docs/topography.md)."""

    seed: int = Field(default=1, ge=0, description="seed of surfaces and artefacts")
    small_scans: int = Field(default=8, ge=0, le=100, description="number of small scans")
    small_length_nm: float = Field(
        default=1000.0, gt=0, le=1e6, description="side of a small scan", json_schema_extra={"unit": "nm"}
    )
    large_scans: int = Field(default=3, ge=0, le=100, description="number of large scans")
    large_length_nm: float = Field(
        default=10000.0, gt=0, le=1e6, description="side of a large scan", json_schema_extra={"unit": "nm"}
    )
    pixels: int = Field(default=1024, ge=32, le=8192, description="pixels per side of a scan")
    q0: float = Field(
        default=0.025,
        gt=0,
        le=10,
        description="true roll-off wave vector (middle of the paper's range)",
        json_schema_extra={"unit": "1/nm"},
    )
    q1: float = Field(
        default=3.2, gt=0, le=100, description="true end of the power law", json_schema_extra={"unit": "1/nm"}
    )
    slope: float = Field(
        default=2.84,
        gt=0.5,
        le=6,
        description="true fall of the two-dimensional spectrum, C ~ q^-slope (the paper's H 0.92 as 2H+1)",
    )
    rms_nm: float = Field(
        default=6.0, gt=0, le=1e4, description="true RMS height of a typical place", json_schema_extra={"unit": "nm"}
    )
    rms_variation: float = Field(
        default=0.4,
        ge=0,
        le=2,
        description="standard deviation of ln(RMS) from place to place; the paper's scans span 1.8 to 14 nm",
    )
    tip_radius_nm: float = Field(
        default=5.0, ge=0, le=1000, description="radius of the paraboloidal tip", json_schema_extra={"unit": "nm"}
    )
    noise_nm: float = Field(
        default=0.03, ge=0, le=100, description="white detector noise per pixel", json_schema_extra={"unit": "nm"}
    )
    line_noise_nm: float = Field(
        default=0.3, ge=0, le=1000, description="random offset of each scan line", json_schema_extra={"unit": "nm"}
    )
    tilt_deg: float = Field(
        default=0.5, ge=0, le=45, description="largest tilt of sample to scanner", json_schema_extra={"unit": "deg"}
    )
    drift_nm: float = Field(
        default=5.0, ge=0, le=1e4, description="slow vertical drift over a scan", json_schema_extra={"unit": "nm"}
    )
    step_nm: float = Field(
        default=0.01, ge=0, le=100, description="height of one digital step", json_schema_extra={"unit": "nm"}
    )


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
    spike_threshold: float = Field(
        default=12.0,
        ge=0,
        le=1e6,
        description="pixels that differ from the median of their neighbours by more than this many robust "
        "standard deviations are replaced by it; 0 keeps all",
    )
    max_missing: float = Field(
        default=0.05,
        ge=0,
        le=0.5,
        description="largest share of missing pixels that is filled from neighbours; above, the scan is refused",
    )
    sections: int = Field(
        default=100,
        ge=1,
        le=10000,
        description="overlapping sections per scan (a square number)",
    )
    section_fraction: float = Field(
        default=0.75,
        ge=0.1,
        le=1,
        description="side of a section over side of its scan",
    )
    window_flat: float = Field(
        default=0.99,
        ge=0,
        le=1,
        description="flat share of the window of the paper's procedure",
    )
    method: Literal["likelihood", "lines"] = Field(
        default="likelihood",
        description="estimate that feeds the inputs: maximum likelihood, or the paper's line fits made precise",
    )
    ranges: Literal["scatter", "interval"] = Field(
        default="scatter",
        description="range that feeds the inputs: scatter between scans (as the paper), or the confidence "
        "interval of the typical value",
    )
    confidence: float = Field(
        default=0.9,
        ge=0.5,
        le=0.999,
        description="level of the confidence intervals",
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
    press_scans: bool = Field(
        default=False,
        description="close the contact on the scans themselves too, beside random surfaces of their statistics",
    )
    study_repeats: int = Field(
        default=3,
        ge=1,
        le=1000,
        description="surfaces per point of error against run time",
    )
    study_sets: int = Field(
        default=10,
        ge=1,
        le=10000,
        description="sets of scans with random truth and artefacts in the recovery study",
    )
    scans_per_job: int = Field(default=6, ge=1, le=200, description="scans analysed by one job")
    synthetic: SyntheticScanSettings = SyntheticScanSettings()
