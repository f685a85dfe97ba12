"""Settings of the topography stage."""

from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le

from asperity.guards.settings import Settings, key

LengthUnit = Literal["m", "mm", "um", "nm", "Å", "pm"]


Positive = Annotated[float, Gt(0)]
Place = Annotated[int, Ge(0), Le(100_000)]
Places = Annotated[int, Ge(2), Le(100_000)]


class SyntheticScanSettings(Settings):
    """Synthetic AFM scans with known truth, used when no scans are given (docs/topography.md)."""

    small_scans: int = key(8, "number of small scans, of 1 um", "[0, 100]")
    large_scans: int = key(3, "number of large scans, of 10 um", "[0, 100]")
    pixels: int = key(1024, "pixels per side of a scan", "[32, 8192]")


class InstrumentSettings(Settings):
    """What an instrument can see; what is null is taken from the file of the measurement."""

    files: str = key(
        ...,
        "names of files, or of measurements in a container, that it applies to; * stands for any"
        " text",
        min_length=1,
        max_length=200,
    )
    tip_radius_nm: float | None = key(
        None,
        "radius of its tip, bounds the wave vectors that are trusted; 0: no tip (a side view)",
        "[0, 1e5] nm",
    )
    shortest_wave_nm: float | None = key(
        None, "shortest wavelength that it passes (filter, resolution)", "(0, 1e6] nm"
    )
    noise_nm: float | None = key(None, "RMS noise of a height", "[0, 1e4] nm")
    channel: str | None = key(None, "name of its height channel; null: topography.channel")
    unit: LengthUnit | None = key(
        None, "length unit of positions and heights, for files that state none"
    )
    height_unit: LengthUnit | None = key(
        None, "length unit of heights, where it differs from that of positions"
    )
    size: tuple[Positive, ...] | None = key(
        None,
        "physical size of a map along x and y in `unit`, or the length of a line of heights alone,"
        " for files that state none",
        min_length=1,
        max_length=2,
    )
    crop: Literal["largest"] | tuple[Place, Place, Place, Place] | None = key(
        None,
        "part of a map to take: the largest rectangle without missing points, or [from, to, from,"
        " to] in pixels along x and y",
    )
    points: tuple[Places, Places] | None = key(
        None,
        "places along x and y into which points x, y, z are sorted that lie on no regular grid",
    )


class TopographySettings(Settings):
    """AFM scans to spectrum and roughness parameters (docs/topography.md)."""

    scans: tuple[str, ...] = key(
        (),
        "measurements of one surface: scans, line profiles (any format of SurfaceTopography),"
        " containers of contact.engineering, folders of these; relative to the working directory or"
        " to the scene; empty: synthetic scans with known truth",
        max_length=200,
    )
    instruments: tuple[InstrumentSettings, ...] = key(
        (), "limits of the instruments, the first that fits a name", max_length=100
    )
    channel: str | None = key(
        None, "name of the height channel; null: the only one, or the first of trace and retrace"
    )
    tip_radius_nm: float | None = key(
        None,
        "radius of the tip where neither `instruments` nor the file states one, bounds the range of"
        " wave vectors that is trusted; 0: no bound; null: 5 nm, with a doubt where it matters",
        "[0, 1e5] nm",
    )
    detrend: Literal["auto", "none", "plane", "quadratic"] = key(
        "auto",
        "what is subtracted as tilt and form; auto: a quadratic where form is clearly more than"
        " roughness",
    )
    line_alignment: Literal["none", "median"] = key(
        "median", "what is subtracted from each scan line"
    )
    ranges: Literal["scatter", "interval"] = key(
        "scatter",
        "range of the inputs: scatter between scans (the paper's), or interval of the typical"
        " value",
    )
    convention: Literal["profile", "areal"] = key(
        "areal",
        "slope of the spectrum: profile 2H+1 (the paper's), areal 2H+2; as"
        " contact.reading.convention",
    )
    description: Literal["auto", "power_law", "measured_spectrum", "measured_heights"] = key(
        "auto",
        "how random surfaces follow the measurements: eq. 9, the measured spectrum, or the measured"
        " spectrum with the measured heights; auto: the first that the measurements do not"
        " contradict",
    )
    on_doubt: Literal["stop", "warn"] = key(
        "stop", "measurements that no description fits: stop, or use them and warn"
    )
    synthetic: SyntheticScanSettings = SyntheticScanSettings()

    @property
    def tip_nm(self) -> float:
        """Radius of the tip, nm, where nothing else states it."""
        if self.tip_radius_nm is None:
            return 5.0
        return self.tip_radius_nm
