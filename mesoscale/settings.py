"""Settings of the mesoscale stages: every key with its default, unit and accepted range."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator


class Settings(BaseModel):
    """Base of all settings: unknown keys, infinities and NaN are refused; instances are frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class SyntheticScanSettings(Settings):
    """Synthetic AFM scans with known truth, used when no scans are given (docs/topography.md)."""

    seed: int = Field(1, ge=0, description="seed of surfaces and artefacts", json_schema_extra={"unit": "1"})
    small_scans: int = Field(
        8, ge=0, le=100, description="number of small scans", json_schema_extra={"unit": "1"}
    )
    small_length_nm: float = Field(
        1000.0, gt=0, le=1e6, description="side of a small scan", json_schema_extra={"unit": "nm"}
    )
    large_scans: int = Field(
        3, ge=0, le=100, description="number of large scans", json_schema_extra={"unit": "1"}
    )
    large_length_nm: float = Field(
        10000.0, gt=0, le=1e6, description="side of a large scan", json_schema_extra={"unit": "nm"}
    )
    pixels: int = Field(
        1024, ge=32, le=8192, description="pixels per side of a scan", json_schema_extra={"unit": "1"}
    )
    q0: float = Field(
        0.025,
        gt=0,
        le=10,
        description="true roll-off wave vector (middle of the paper's range)",
        json_schema_extra={"unit": "1/nm"},
    )
    q1: float = Field(
        3.2, gt=0, le=100, description="true end of the power law", json_schema_extra={"unit": "1/nm"}
    )
    slope: float = Field(
        2.84,
        gt=0.5,
        le=6,
        description="true fall of the two-dimensional spectrum, C ~ q^-slope (the paper's H 0.92 as 2H+1)",
        json_schema_extra={"unit": "1"},
    )
    rms_nm: float = Field(
        6.0, gt=0, le=1e4, description="true RMS height of a typical place", json_schema_extra={"unit": "nm"}
    )
    rms_variation: float = Field(
        0.4,
        ge=0,
        le=2,
        description="standard deviation of ln(RMS) from place to place; the paper's scans span 1.8 to 14 nm",
        json_schema_extra={"unit": "1"},
    )
    tip_radius_nm: float = Field(
        5.0, ge=0, le=1000, description="radius of the paraboloidal tip", json_schema_extra={"unit": "nm"}
    )
    noise_nm: float = Field(
        0.03, ge=0, le=100, description="white detector noise per pixel", json_schema_extra={"unit": "nm"}
    )
    line_noise_nm: float = Field(
        0.3, ge=0, le=1000, description="random offset of each scan line", json_schema_extra={"unit": "nm"}
    )
    tilt_deg: float = Field(
        0.5, ge=0, le=45, description="largest tilt of sample to scanner", json_schema_extra={"unit": "deg"}
    )
    drift_nm: float = Field(
        5.0, ge=0, le=1e4, description="slow vertical drift over a scan", json_schema_extra={"unit": "nm"}
    )
    step_nm: float = Field(
        0.01, ge=0, le=100, description="height of one digital step", json_schema_extra={"unit": "nm"}
    )


class TopographySettings(Settings):
    """AFM scans to spectrum and roughness parameters (docs/topography.md)."""

    scans: tuple[str, ...] = Field(
        (),
        max_length=200,
        description="AFM files of your own (any format of SurfaceTopography), relative to the working "
        "directory; empty: synthetic scans with known truth",
    )
    channel: str | None = Field(
        None,
        description="name of the height channel; null takes the only one (or the first of trace and retrace)",
    )
    tip_radius_nm: float = Field(
        5.0,
        ge=0,
        le=1000,
        description="radius of the AFM tip, bounds the range of wave vectors that is trusted; 0: no bound",
        json_schema_extra={"unit": "nm"},
    )
    detrend: Literal["none", "plane", "quadratic"] = Field(
        "plane", description="what is subtracted from each scan as tilt and scanner bow"
    )
    line_alignment: Literal["none", "median"] = Field(
        "median", description="what is subtracted from each scan line"
    )
    spike_threshold: float = Field(
        12.0,
        ge=0,
        le=1e6,
        description="pixels that differ from the median of their neighbours by more than this many robust "
        "standard deviations are replaced by it; 0 keeps all",
        json_schema_extra={"unit": "1"},
    )
    max_missing: float = Field(
        0.05,
        ge=0,
        le=0.5,
        description="largest share of missing pixels that is filled from neighbours; above, the scan is "
        "refused",
        json_schema_extra={"unit": "1"},
    )
    sections: int = Field(
        100,
        ge=1,
        le=10000,
        description="overlapping sections per scan (a square number)",
        json_schema_extra={"unit": "1"},
    )
    section_fraction: float = Field(
        0.75,
        ge=0.1,
        le=1,
        description="side of a section over side of its scan",
        json_schema_extra={"unit": "1"},
    )
    window_flat: float = Field(
        0.99,
        ge=0,
        le=1,
        description="flat share of the window of the paper's procedure",
        json_schema_extra={"unit": "1"},
    )
    method: Literal["likelihood", "lines"] = Field(
        "likelihood",
        description="estimate that feeds the inputs: maximum likelihood, or the paper's line fits made "
        "precise",
    )
    ranges: Literal["scatter", "interval"] = Field(
        "scatter",
        description="range that feeds the inputs: scatter between scans (as the paper), or the confidence "
        "interval of the typical value",
    )
    confidence: float = Field(
        0.9,
        ge=0.5,
        le=0.999,
        description="level of the confidence intervals",
        json_schema_extra={"unit": "1"},
    )
    convention: Literal["profile", "areal"] = Field(
        "profile",
        description="how H follows from the slope of the two-dimensional spectrum: profile 2H+1 (the paper), "
        "areal 2H+2; contact.convention must be the same",
    )
    on_doubt: Literal["stop", "warn"] = Field(
        "stop",
        description="what happens to parameters that the scans do not determine well: stop before they are "
        "used, or warn in the report and use them",
    )
    study_repeats: int = Field(
        3,
        ge=1,
        le=1000,
        description="surfaces per point of error against run time",
        json_schema_extra={"unit": "1"},
    )
    study_sets: int = Field(
        10,
        ge=1,
        le=10000,
        description="sets of scans with random truth and artefacts in the recovery study",
        json_schema_extra={"unit": "1"},
    )
    scans_per_job: int = Field(
        6, ge=1, le=200, description="scans analysed by one job", json_schema_extra={"unit": "1"}
    )
    synthetic: SyntheticScanSettings = SyntheticScanSettings()


class ContactSettings(Settings):
    """Mesoscale contact model (docs/contact.md)."""

    model: Literal["elastic", "nonlinear", "plastic"] = Field(
        "plastic",
        description="single asperities: eq. 3 alone; eq. 4 as a cap of the force; eq. 4 with plastic flow of the surface",
        json_schema_extra={"unit": "1"},
    )
    pixels: int = Field(
        1024, ge=32, le=16384, description="grid points per side", json_schema_extra={"unit": "1"}
    )
    length_nm: float = Field(
        1000.0,
        gt=0,
        le=1e6,
        description="side of the square, periodic cell",
        json_schema_extra={"unit": "nm"},
    )
    max_force_nN: float = Field(
        7000.0,
        gt=0,
        le=1e12,
        description="repulsive force at which closing turns into opening",
        json_schema_extra={"unit": "nN"},
    )
    convention: Literal["profile", "areal"] = Field(
        "profile",
        description="slope of the two-dimensional PSD: -(2H+1), the paper's, or -(2H+2), an isotropic surface's",
        json_schema_extra={"unit": "1"},
    )
    q1_per_nm: float | None = Field(
        None,
        gt=0,
        description="short-wave cut-off of the spectrum; null: the grid's Nyquist limit",
        json_schema_extra={"unit": "1/nm"},
    )
    gap_cutoff_nm: float = Field(
        0.165,
        gt=0,
        le=10,
        description="D0 of eq. 1: smaller gaps attract as if they were D0",
        json_schema_extra={"unit": "nm"},
    )
    touching_attracts: bool = Field(
        True,
        description="whether sites in contact attract (with the gap D0) or are left out of eq. 1",
        json_schema_extra={"unit": "1"},
    )
    prefactor: Literal["paper", "hertz"] = Field(
        "paper", description="p of eq. 3: 2/3 as printed, or Hertz's 4/3", json_schema_extra={"unit": "1"}
    )
    radius: Literal["curvature", "truncation"] = Field(
        "curvature",
        description="asperity radius: mean curvature of the sites (eq. 2), or R = A/(2 pi delta)",
        json_schema_extra={"unit": "1"},
    )
    area: Literal["sites", "hertz"] = Field(
        "sites",
        description="asperity area in eq. 4: its contacting sites, or Hertz's pi R delta",
        json_schema_extra={"unit": "1"},
    )
    neighbours: Literal[4, 8] = Field(
        8,
        description="neighbours through which contacting sites are connected",
        json_schema_extra={"unit": "1"},
    )
    flow: Literal["increment", "return"] = Field(
        "return",
        description="plastic flow: fixed increments, or the amplitude that returns the asperity to its yield surface",
        json_schema_extra={"unit": "1"},
    )
    flow_pair: Literal["paper", "wide"] = Field(
        "wide",
        description="second Gaussian: 3 times the radius of curvature (s2 = 3^(1/4) s1), or 3 times the width",
        json_schema_extra={"unit": "1"},
    )
    flow_increment_nm: float = Field(
        0.3,
        gt=0,
        le=10,
        description="amplitude of one increment (flow: increment)",
        json_schema_extra={"unit": "nm"},
    )
    flow_width_nm: float = Field(
        0.3,
        gt=0,
        le=10,
        description="a1 in the width s1 = sqrt(a1 R) of the first Gaussian",
        json_schema_extra={"unit": "nm"},
    )
    flow_floor_pixels: float = Field(
        1.0,
        ge=0,
        le=10,
        description="smallest s1, so that the grid resolves the flow; 0: none",
        json_schema_extra={"unit": "pixel"},
    )
    flow_tolerance: float = Field(
        1e-3,
        ge=1e-9,
        le=0.1,
        description="an asperity yields above its hardness times 1 + this (flow: return)",
        json_schema_extra={"unit": "1"},
    )
    max_sweeps: int = Field(
        500,
        ge=1,
        le=100000,
        description="bound on the flow sweeps of one separation; reaching it raises a flag",
        json_schema_extra={"unit": "1"},
    )
    force_steps: int = Field(
        40,
        ge=4,
        le=10000,
        description="force steps from contact to the largest force; separations follow from them",
        json_schema_extra={"unit": "1"},
    )
    gap_bins: int = Field(
        4096,
        ge=16,
        le=1048576,
        description="bins of the gap histogram behind the far part of the attraction",
        json_schema_extra={"unit": "1"},
    )
    nominal_seed: int = Field(
        1,
        ge=0,
        description="surface seed of the nominal curves (figures 4 and 11)",
        json_schema_extra={"unit": "1"},
    )
    nominal_force_nN: float = Field(
        1e4,
        gt=0,
        le=1e12,
        description="largest force of the model comparison (figure 4)",
        json_schema_extra={"unit": "nN"},
    )
    nominal_loads_nN: list[float] = Field(
        [1e3, 3e3, 7e3, 1e4, 2e4, 5e4],
        min_length=1,
        description="largest forces of the load series (figure 11)",
        json_schema_extra={"unit": "nN"},
    )
    study_seeds: int = Field(
        3,
        ge=1,
        le=1000,
        description="surfaces per case of the accuracy study",
        json_schema_extra={"unit": "1"},
    )
    study_draws: int = Field(
        60,
        ge=0,
        le=100000,
        description="random draws from Table 1 of the stability study, on three surfaces each",
        json_schema_extra={"unit": "1"},
    )


class InputRow(Settings):
    """One uncertain input: where its distribution comes from and, for literature, what it is."""

    origin: Literal["literature", "hardness", "elastic", "topography"] = Field(
        "literature", description="where the distribution comes from: this file, or the result of that stage"
    )
    distribution: Literal["uniform", "normal", "truncated_normal", "samples", "fixed"] = Field(
        "uniform",
        description="form of a literature distribution: uniform a..b; normal with mean a and deviation b; "
        "the same truncated to low..high; samples read from `file`; fixed at a",
    )
    a: float | None = Field(None, description="lower end, mean, or fixed value, in the input's unit")
    b: float | None = Field(None, description="upper end or standard deviation, in the input's unit")
    low: float | None = Field(None, description="lower truncation of truncated_normal")
    high: float | None = Field(None, description="upper truncation of truncated_normal")
    file: str | None = Field(None, description="CSV with one sample a row in a column named like the input")
    source: str = Field("", description="where the literature values come from, shown in the report")

    @model_validator(mode="after")
    def _complete(self) -> "InputRow":
        given = {key for key in ("a", "b", "low", "high", "file") if getattr(self, key) is not None}
        if self.origin != "literature":
            if given:
                raise ValueError(
                    f"origin {self.origin} takes no {', '.join(sorted(given))}; that stage gives them"
                )
            return self
        wanted = {
            "uniform": {"a", "b"},
            "normal": {"a", "b"},
            "truncated_normal": {"a", "b", "low", "high"},
            "samples": {"file"},
            "fixed": {"a"},
        }[self.distribution]
        if given != wanted:
            raise ValueError(f"distribution {self.distribution} takes exactly {', '.join(sorted(wanted))}")
        if self.distribution == "uniform" and not (self.a or 0.0) <= (self.b or 0.0):
            raise ValueError(f"uniform from a = {self.a} to b = {self.b}: a must not exceed b")
        if "normal" in self.distribution and not (self.b or 0.0) >= 0:
            raise ValueError(f"deviation b = {self.b} must be >= 0")
        if self.distribution == "truncated_normal" and not (self.low or 0.0) < (self.high or 0.0):
            raise ValueError(f"truncation {self.low} .. {self.high}: low must lie below high")
        return self


class Correlation(Settings):
    """Dependence of two inputs."""

    first: str = Field(description="name of an input")
    second: str = Field(description="name of another input")
    rank: float = Field(gt=-1, lt=1, description="Spearman's rank correlation of the two")


TABLE_1 = "Kim et al. (2013), Table 1"


class InputsSettings(Settings):
    """Origin and distribution of the uncertain inputs (docs/uncertainty.md)."""

    hamaker: InputRow = Field(
        InputRow(a=0.18, b=0.25, source=TABLE_1), description="Hamaker constant (1e-18 J)"
    )
    e_star: InputRow = Field(InputRow(origin="elastic"), description="effective elastic modulus E* (GPa)")
    h_macro: InputRow = Field(
        InputRow(a=0.7, b=3.2, source=TABLE_1), description="hardness of large asperities H_macro (GPa)"
    )
    h_prime: InputRow = Field(
        InputRow(origin="hardness"), description="size effect of hardness H' (GPa nm^0.5)"
    )
    q0: InputRow = Field(InputRow(origin="topography"), description="roll-off wave vector (1/nm)")
    hurst: InputRow = Field(InputRow(origin="topography"), description="Hurst exponent (1)")
    rms: InputRow = Field(InputRow(origin="topography"), description="RMS roughness (nm)")
    gap_cutoff: InputRow | None = Field(
        None, description="optional eighth input: smallest gap of the attraction D0 (nm)"
    )
    correlations: tuple[Correlation, ...] = Field(
        (), description="rank correlations between inputs, besides those that a stage reports itself"
    )

    @model_validator(mode="after")
    def _known_names(self) -> "InputsSettings":
        names = list(self.rows())
        for pair in self.correlations:
            for name in (pair.first, pair.second):
                if name not in names:
                    raise ValueError(f"correlations: unknown input {name}; accepted: {', '.join(names)}")
            if pair.first == pair.second:
                raise ValueError(f"correlations: {pair.first} with itself; name two inputs")
        for name, row in self.rows().items():
            if name in ("hamaker", "h_macro", "gap_cutoff") and row.origin != "literature":
                raise ValueError(f"{name}: no stage computes it; origin must be literature")
            if row.origin != "literature" and row.origin != STAGE_OF_INPUT[name]:
                raise ValueError(f"{name}: origin {row.origin}; accepted: literature, {STAGE_OF_INPUT[name]}")
        return self

    def rows(self) -> dict[str, InputRow]:
        """The inputs in use, by name."""
        named = {name: getattr(self, name) for name in (*STAGE_OF_INPUT, "gap_cutoff")}
        return {name: row for name, row in named.items() if row is not None}

    def origins(self) -> set[str]:
        """Where the inputs come from; cheap, so that a workflow can decide which stages to run."""
        return {row.origin for row in self.rows().values()}


STAGE_OF_INPUT = {
    "hamaker": "literature",
    "e_star": "elastic",
    "h_macro": "literature",
    "h_prime": "hardness",
    "q0": "topography",
    "hurst": "topography",
    "rms": "topography",
}


class LawSettings(Settings):
    """Fit of the compact force-separation law (docs/law.md)."""

    contact_definition: Literal["first_contact", "force_fraction", "free_fit"] = Field(
        "force_fraction",
        description="what d_c is: where the first (on opening the last) asperity touches; where the "
        "repulsion reaches `force_fraction` of its maximum; or fitted to attraction and repulsion together",
    )
    force_fraction: float = Field(
        0.03,
        gt=0,
        lt=0.5,
        description="share of the largest repulsion that counts as contact",
        json_schema_extra={"unit": "1"},
    )
    rho_a_nm: float = Field(
        2.0,
        ge=0,
        le=100,
        description="attraction length rho_a (the paper fixes 2 nm)",
        json_schema_extra={"unit": "nm"},
    )
    shield_nm: float = Field(
        2.0, gt=0, le=1000, description="shielding distance alpha of eq. 12", json_schema_extra={"unit": "nm"}
    )
    weights: Literal["uniform", "relative"] = Field(
        "uniform", description="misfit of the repulsion: absolute, or relative above `relative_floor`"
    )
    relative_floor: float = Field(
        0.01,
        gt=0,
        le=1,
        description="floor of relative weights, share of the largest repulsion",
        json_schema_extra={"unit": "1"},
    )
    points: int = Field(
        200, ge=20, le=10000, description="even points in separation that a branch is resampled to"
    )
    min_points: int = Field(4, ge=3, le=1000, description="fewest points of the curve in contact for a fit")
    min_depth_ratio: float = Field(
        0.2,
        gt=0,
        lt=1,
        description="smallest (window / rho_r) that counts as identified",
        json_schema_extra={"unit": "1"},
    )
    max_depth_ratio: float = Field(
        200.0,
        gt=1,
        le=600,
        description="largest (window / rho_r) that counts as identified",
        json_schema_extra={"unit": "1"},
    )
    max_relative_error: float = Field(
        1.0,
        gt=0,
        le=100,
        description="largest relative error of C_r and rho_r that counts as identified",
        json_schema_extra={"unit": "1"},
    )
    max_residual: float = Field(
        0.15,
        gt=0,
        le=1,
        description="misfit above which a fit is marked poor, share of the largest repulsion",
        json_schema_extra={"unit": "1"},
    )


class UncertaintySettings(Settings):
    """Propagation of uncertainty and sensitivity (docs/uncertainty.md)."""

    surrogate: Literal["level1", "level2"] = Field(
        "level1",
        description="response surface: level1 is the paper's (2n+1 nodes, linear); level2 is the next "
        "Smolyak level with quadratic and interaction terms (113 nodes for seven inputs)",
    )
    surface: Literal["linear", "polynomial", "regression"] = Field(
        "regression",
        description="surface behind samples, Sobol' indices and surrogate.json: the paper's linear one; the "
        "polynomial through all nodes; or sparse polynomial chaos fitted to the direct runs. The last two "
        "take C_a, C_r and rho_r in logarithm, so that they stay positive. Table 2 always has the linear one",
    )
    chaos_degree: int = Field(3, ge=1, le=6, description="highest total degree of the regression surface")
    seeds: int = Field(8, ge=1, le=10000, description="surfaces per node, the same ones at every node")
    first_seed: int = Field(0, ge=0, le=2**31, description="seed of the first surface")
    central_share: float = Field(
        0.999,
        gt=0.5,
        lt=1,
        description="central share of an unbounded distribution that the nodes span",
        json_schema_extra={"unit": "1"},
    )
    chunk_runs: int = Field(60, ge=1, le=100000, description="contact cycles per job and file")
    samples: int = Field(10000, ge=10, le=10**7, description="samples of the inputs sent through the surface")
    sample_seed: int = Field(1, ge=0, le=2**31, description="seed of those samples")
    sobol_samples: int = Field(
        2048, ge=64, le=10**6, description="size of each of the n + 2 samples behind the Sobol' indices"
    )
    audit_seeds: int = Field(
        4, ge=1, le=1000, description="surfaces per reading of the reproduction audit (target `audit`)"
    )
    audit_readings: tuple[str, ...] = Field(
        (),
        description="readings of the contact model to audit, named as in audit/ranking.csv; empty: all that "
        "differ in more than the attraction of touching sites",
    )
    sobol_bootstrap: int = Field(
        40, ge=0, le=10000, description="resamplings for the intervals of Sobol' indices"
    )
    bootstrap: int = Field(200, ge=20, le=100000, description="resamplings for intervals")
    direct_runs: int = Field(
        200,
        ge=0,
        le=10**6,
        description="independent cycles, each with its own inputs and surface: they train the regression "
        "surface and validate all of them; 10000 or more make a brute-force reference",
    )


class DeviceSettings(Settings):
    """Switch driven by the force-separation law (docs/device.md).

    The defaults are the published fixed-fixed beam of the PRISM capacitive switch.
    """

    length_um: float = Field(
        510.0, gt=0, le=1e5, description="length of the fixed-fixed beam", json_schema_extra={"unit": "um"}
    )
    width_um: float = Field(
        123.0, gt=0, le=1e5, description="width of the beam", json_schema_extra={"unit": "um"}
    )
    thickness_um: float = Field(
        4.0, gt=0, le=1e3, description="thickness of the beam", json_schema_extra={"unit": "um"}
    )
    gap_um: float = Field(
        3.49,
        gt=0.01,
        le=1e3,
        description="distance from the beam at rest to the mean plane of the dielectric",
        json_schema_extra={"unit": "um"},
    )
    youngs_modulus_GPa: float = Field(
        89.3, gt=0, le=2000, description="Young's modulus of the beam", json_schema_extra={"unit": "GPa"}
    )
    poisson_ratio: float = Field(
        0.3, ge=0, lt=0.5, description="Poisson's ratio of the beam", json_schema_extra={"unit": "1"}
    )
    residual_stress_MPa: float = Field(
        0.0,
        ge=0,
        le=2000,
        description="tensile residual stress of the beam; stiffens it",
        json_schema_extra={"unit": "MPa"},
    )
    spring_N_per_m: float | None = Field(
        None,
        gt=0,
        le=1e6,
        description="stiffness of a parallel-plate switch; null computes it from the beam",
        json_schema_extra={"unit": "N/m"},
    )
    electrode_um2: float | None = Field(
        None,
        gt=0,
        le=1e9,
        description="electrode area; null is the whole beam, length times width",
        json_schema_extra={"unit": "um^2"},
    )
    dielectric_nm: float = Field(
        200.0, ge=0, le=1e5, description="thickness of the dielectric", json_schema_extra={"unit": "nm"}
    )
    permittivity: float = Field(
        7.9,
        ge=1,
        le=1e5,
        description="relative permittivity of the dielectric",
        json_schema_extra={"unit": "1"},
    )
    landed_fraction: float = Field(
        0.01,
        ge=0,
        le=1,
        description="share of the electrode area that meets the dielectric as in the law; a bowed or "
        "tilted beam lands on little of it",
        json_schema_extra={"unit": "1"},
    )
    adhesion_scale: float = Field(
        1.0,
        ge=0,
        le=10,
        description="factor on the attraction of the law; 0.1 brings it near measured dry adhesion",
        json_schema_extra={"unit": "1"},
    )
    hold_voltage_V: float | None = Field(
        None,
        gt=0,
        le=1e5,
        description="voltage of the closed switch; null is its own pull-in voltage",
        json_schema_extra={"unit": "V"},
    )
    samples: int = Field(
        4000,
        ge=10,
        le=1_000_000,
        description="samples of the law taken from the propagation of uncertainty",
        json_schema_extra={"unit": "1"},
    )
