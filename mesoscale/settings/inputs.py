"""Settings of the uncertain inputs."""

import math
from typing import Any, Literal, cast

from pydantic import Field, create_model, model_validator

from mesoscale.inputs.definitions import BY_NAME, INPUTS, InputDefinition
from mesoscale.settings.base import Settings


class InputRow(Settings):
    """One uncertain input: where its distribution comes from and, for literature, what it is."""

    origin: Literal["literature", "hardness", "elastic", "topography", "calibration"] = Field(
        default="literature",
        description="where the distribution comes from: this file, the result of that stage, or the calibration with "
        "the scene's measurements",
    )
    prior: Literal["literature", "hardness", "elastic", "topography"] = Field(
        default="literature", description="origin calibration: where its prior comes from: this file, or that stage"
    )
    distribution: Literal["uniform", "normal", "truncated_normal", "samples", "fixed"] = Field(
        default="uniform",
        description="form of a literature distribution: uniform a..b; normal with mean a and deviation b; "
        "the same truncated to low..high; samples read from `file`; fixed at a",
    )
    a: float | None = Field(default=None, description="lower end, mean, or fixed value, in the input's unit")
    b: float | None = Field(default=None, description="upper end or standard deviation, in the input's unit")
    low: float | None = Field(default=None, description="lower truncation of truncated_normal")
    high: float | None = Field(default=None, description="upper truncation of truncated_normal")
    file: str | None = Field(default=None, description="CSV with one sample a row in a column named like the input")
    source: str = Field(
        default="", max_length=500, description="where the literature values come from, shown in the report"
    )

    @property
    def prior_origin(self) -> str:
        """Where the distribution comes from, before any calibration."""
        return self.prior if self.origin == "calibration" else self.origin

    @model_validator(mode="after")
    def _complete(self) -> "InputRow":
        given = {key for key in ("a", "b", "low", "high", "file") if getattr(self, key) is not None}
        if self.prior != "literature" and self.origin != "calibration":
            raise ValueError(f"prior {self.prior} with origin {self.origin}; only origin calibration has a prior")
        if self.prior_origin != "literature":
            if given:
                raise ValueError(
                    f"origin {self.prior_origin} takes no {', '.join(sorted(given))}; that stage gives them"
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


class WorkAndRangeSettings(Settings):
    """The attraction of two flats by its work and range, which stand for A_H and D0 (docs/contact.md, Attraction)."""

    work_mJ_m2: float = Field(
        gt=0,
        le=1e5,
        description="work that separates two flats from touch, A_H / (4 pi D0^2); a third of it is beyond D0",
        json_schema_extra={"unit": "mJ/m^2"},
    )
    range_nm: float = Field(
        ge=1e-3,
        le=15,
        description="that work over the largest attraction, 3/2 D0",
        json_schema_extra={"unit": "nm"},
    )

    @property
    def gap_cutoff_nm(self) -> float:
        """D0."""
        return self.range_nm / 1.5

    @property
    def hamaker(self) -> float:
        """A_H in 1e-18 J; 1 mJ/m^2 is 1e-3 nN/nm."""
        return 4.0 * math.pi * self.gap_cutoff_nm**2 * self.work_mJ_m2 * 1e-3


def _key(row: InputDefinition) -> Any:
    """Type, default and description of the key of an input."""
    symbol = "" if row.symbol in row.label else f" {row.symbol}"
    about = f"{row.label}{symbol} ({row.unit})"
    if row.optional:
        return InputRow | None, Field(default=None, description=f"optional input: {about}")
    if row.literature is None:
        return InputRow, Field(default=InputRow(origin=cast(Any, row.stage)), description=about)
    low, high = row.literature
    return InputRow, Field(default=InputRow(a=low, b=high, source=TABLE_1), description=about)


class InputsSettings(create_model("InputsSettings", __base__=Settings, **{row.name: _key(row) for row in INPUTS})):
    """Origin and distribution of the uncertain inputs (docs/uncertainty.md)."""

    adhesion: WorkAndRangeSettings | None = Field(
        default=None, description="work and range of the attraction, in place of hamaker and gap_cutoff; null: by these"
    )
    correlations: tuple[Correlation, ...] = Field(
        default=(), description="rank correlations between inputs, besides those that a stage reports itself"
    )

    @model_validator(mode="after")
    def _one_attraction(self) -> "InputsSettings":
        fields = type(self).model_fields
        given = [name for name in ("hamaker", "gap_cutoff") if getattr(self, name) != fields[name].default]
        if self.adhesion and given:
            raise ValueError(f"adhesion and {' and '.join(given)} give the same attraction; leave one of them out")
        return self

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
            stage = BY_NAME[name].stage
            if row.prior_origin not in ("literature", stage):
                if stage == "literature":
                    raise ValueError(f"{name}: no stage computes it; origin must be literature or calibration")
                raise ValueError(f"{name}: origin {row.prior_origin}; accepted: literature, {stage}, calibration")
        return self

    def rows(self) -> dict[str, InputRow]:
        """The inputs in use, by name."""
        named = {name: getattr(self, name) for name in BY_NAME}
        if self.adhesion:
            stated = {"hamaker": self.adhesion.hamaker, "gap_cutoff": self.adhesion.gap_cutoff_nm}
            for name, value in stated.items():
                named[name] = InputRow(distribution="fixed", a=value, source="inputs.adhesion")
        return {name: row for name, row in named.items() if row is not None}

    def origins(self) -> set[str]:
        """Where the inputs come from; cheap, so that a workflow can decide which stages to run."""
        return {origin for row in self.rows().values() for origin in (row.origin, row.prior_origin)}

    def priors(self) -> "InputsSettings":
        """The inputs before any calibration."""
        rows = {
            name: row.model_copy(update={"origin": row.prior_origin, "prior": "literature"})
            for name, row in self.rows().items()
        }
        return self.model_copy(update=rows)
