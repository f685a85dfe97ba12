"""A scene: everything a run depends on, as the documented defaults and what a YAML file states
instead.
"""

from typing import Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from atomistic.settings import ElasticSettings, HardnessSettings
from mesoscale.settings import (
    DeviceSettings,
    FailureSettings,
    HistorySettings,
    InputsSettings,
    LifetimeSettings,
    MeasurementsSettings,
    PadSettings,
    SceneContact,
    Settings,
    TopographySettings,
    UncertaintySettings,
)

COMPUTED = ("hardness", "elastic", "topography")


class Scene(Settings):
    """Everything a run depends on."""

    name: str = Field(
        default="reduced",
        pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,99}$",
        description="name of the scene; results go to results/<name>/ (default: the file's name)",
    )
    extends: str | None = Field(
        default=None,
        description=(
            "scene whose keys this one takes where it has none of its own, by name or by path"
        ),
    )
    compute: tuple[Literal["hardness", "elastic", "topography"], ...] = Field(
        default=(), description="stages to run and report although no input is taken from them"
    )
    tails: tuple[Literal["law", "switch"], ...] = Field(
        default=("law", "switch"),
        description=(
            "what is made of the inputs and shown: the law of one cell with its uncertainty, as in"
            " the paper; the pad of many cells and the switch on it; none: the inputs alone"
        ),
    )
    inputs: InputsSettings = InputsSettings()
    hardness: HardnessSettings = HardnessSettings()
    elastic: ElasticSettings = ElasticSettings()
    topography: TopographySettings = TopographySettings()
    contact: SceneContact = SceneContact()
    pad: PadSettings = PadSettings()
    uncertainty: UncertaintySettings = UncertaintySettings()
    device: DeviceSettings = DeviceSettings()
    failure: FailureSettings = FailureSettings()
    history: HistorySettings = HistorySettings()
    lifetime: LifetimeSettings = LifetimeSettings()
    measurements: MeasurementsSettings = MeasurementsSettings()

    @model_serializer(mode="wrap")
    def _without_life(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """A life that nobody asks for is left out, so that results without it stay as they were."""
        asked = self.lifetime.years is not None
        return {name: of for name, of in dump(self).items() if asked or name != "lifetime"}

    def stages(self) -> set[str]:
        """The stages among hardness, elastic and topography that this scene computes."""
        return (set(self.inputs.origins()) & set(COMPUTED)) | set(self.compute)

    @property
    def cell_follows_film(self) -> bool:
        """Is the side of a cell chosen with the description of measured scans: does the scene not
        state it?
        """
        return bool(self.topography.scans) and "length_nm" not in self.contact.model_fields_set

    @property
    def humid(self) -> bool:
        """Can liquid condense: is there a humidity as an input, or in the air?"""
        return "humidity" in self.inputs.rows() or bool(
            self.contact.air and self.contact.air.humidity
        )

    @property
    def unequal_places(self) -> bool:
        """Do the places of the film have RMS heights of their own, by topography or by
        `pad.rms_scatter`?
        """
        return (
            self.pad.rms_scatter is not None
            or self.inputs.prior_origins().get("rms") == "topography"
        )

    @model_validator(mode="after")
    def _measurements_for_a_calibration(self) -> "Scene":
        if self.measurements.drift is not None and self.lifetime.years is None:
            raise ValueError(
                "measurements.tables: a drift narrows the rates of lifetime, but lifetime.years ="
                " null; give the life that is asked for, or leave the table out"
            )
        if "calibration" in self.inputs.origins() and not self.measurements.of_inputs:
            other = " but for a drift" if self.measurements.tables else ""
            names = [
                name for name, row in self.inputs.rows().items() if row.origin == "calibration"
            ]
            raise ValueError(
                f"inputs: {', '.join(names)} of origin calibration, but measurements.tables is"
                f" empty{other}; name the tables of measurements, or take another origin"
            )
        return self

    @model_validator(mode="after")
    def _cutoff_on_the_grid(self) -> "Scene":
        resolved = self.contact.nyquist_per_nm
        cut_offs = {"contact.q1_per_nm": self.contact.q1_per_nm}
        row = self.inputs.rows().get("q1")
        if row is not None and row.origin == "literature":
            cut_offs["inputs.q1"] = row.reaches
        for key, q1 in cut_offs.items():
            if q1 is not None and q1 > resolved * (1 + 1e-9):
                raise ValueError(
                    f"{key} reaches {q1:g} 1/nm: beyond what contact.pixels = {self.contact.pixels}"
                    f" on {self.contact.length_nm:g} nm resolve, {resolved:.4g} 1/nm; raise"
                    " contact.pixels or lower it"
                )
        return self

    @model_validator(mode="after")
    def _one_exponent_convention(self) -> "Scene":
        if (
            "topography" in self.inputs.origins()
            and self.topography.convention != self.contact.reading.convention
        ):
            raise ValueError(
                f"topography.convention = {self.topography.convention}, contact.reading.convention"
                f" = {self.contact.reading.convention}: a Hurst exponent measured by one convention"
                " must be used by the same; make them equal"
            )
        return self
