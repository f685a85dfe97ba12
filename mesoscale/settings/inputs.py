"""Settings of the uncertain inputs."""

import math
from typing import Any, Literal, Self, cast

from pydantic import Field, create_model, field_validator, model_validator

from asperity.guards.settings import Settings, key
from mesoscale.settings.contact import RANGE_IN_D0, WORK_FACTOR, AttractionLaw
from mesoscale.settings.definitions import BY_NAME, INPUTS, InputDefinition

NUMBERS = {"uniform": 2, "log_uniform": 2, "normal": 2, "truncated_normal": 4, "fixed": 1}
"""How many numbers state a distribution; `samples` has a file instead."""
FORMS = (
    "uniform [low, high], log_uniform [low, high], normal [mean, deviation], "
    "truncated_normal [mean, deviation, low, high], fixed [value], samples file.csv"
)


class DistributionRow(Settings):
    """A distribution as a scene states it."""

    distribution: Literal[
        "uniform", "log_uniform", "normal", "truncated_normal", "samples", "fixed"
    ] = key("uniform", "form of the distribution that `values` state")
    values: tuple[float, ...] | str | None = Field(
        default=None,
        description=(
            f"its numbers, in the input's unit: {FORMS} (one sample a row, in a column named like"
            " the input)"
        ),
    )
    source: str = key("", "where the values come from, shown in the report", max_length=500)
    varies: Literal["common", "each"] = key(
        "common", "one unknown value for all devices (common), or another for each of them"
    )

    @field_validator("values", mode="before")
    @classmethod
    def _numbers_or_path(cls, stated: Any) -> Any:
        if stated is None or isinstance(stated, str):
            return stated
        numbers = [None]
        if isinstance(stated, (list, tuple)):
            numbers = stated
        if not all(
            isinstance(item, (int, float)) and not isinstance(item, bool) for item in numbers
        ):
            raise ValueError(f"accepted are {FORMS}")
        return tuple(numbers)

    @model_validator(mode="after")
    def _complete(self) -> Self:
        self._check_values()
        return self

    def _check_values(self) -> None:
        values, kind = self.values, self.distribution
        if values is None:
            raise ValueError(f"origin literature needs values: {FORMS}")
        if kind == "samples" and isinstance(values, str):
            return
        if kind == "samples" or isinstance(values, str) or len(values) != NUMBERS[kind]:
            raise ValueError(
                f"values = {values!r:.60} are none of distribution {kind}; accepted are {FORMS}"
            )
        if kind == "log_uniform" and not values[0] > 0:
            raise ValueError(f"log_uniform values [{values[0]:g}, {values[1]:g}]: both must be > 0")
        if "uniform" in kind and not values[0] <= values[1]:
            raise ValueError(
                f"{kind} values [{values[0]:g}, {values[1]:g}]: the first must not exceed the"
                " second"
            )
        if "normal" in kind and not values[1] >= 0:
            raise ValueError(f"{kind} with deviation {values[1]:g}: it must be >= 0")
        if kind == "truncated_normal" and not values[2] < values[3]:
            raise ValueError(f"truncation {values[2]:g} .. {values[3]:g}: low must lie below high")
        flat = (
            kind == "fixed"
            or (kind == "uniform" and values[0] == values[1])
            or ("normal" in kind and not values[1])
        )
        if flat and self.varies == "each" and "varies" in self.model_fields_set:
            raise ValueError(
                "varies: each, but its values have no spread; give a distribution, or leave"
                " varies out"
            )

    @property
    def reaches(self) -> float | None:
        """The largest number that it states as an end, or its mean; None of samples or a stage."""
        place = {"uniform": 1, "log_uniform": 1, "truncated_normal": 3}.get(self.distribution, 0)
        if not isinstance(self.values, tuple):
            return None
        return self.values[place]


class InputRow(DistributionRow):
    """One uncertain input: where its distribution comes from and, for literature, what it is."""

    origin: Literal["literature", "hardness", "elastic", "topography", "calibration"] = key(
        "literature",
        "where the distribution comes from: this file; the result of that stage; or the calibration"
        " with the scene's measurements, whose prior is stated here or, without values, by the"
        " stage that computes the input",
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if self.values is None and self.origin != "literature":
            return self._check_calibrated()
        if self.origin not in ("literature", "calibration"):
            raise ValueError(f"origin {self.origin} takes no values; that stage gives them")
        self._check_values()
        return self._check_calibrated()

    def _check_calibrated(self) -> Self:
        if self.origin == "calibration" and self.varies == "each":
            raise ValueError(
                "origin calibration narrows one unknown value; varies: each needs another origin"
            )
        return self


HardnessLawName = Literal["constant", "paper", "film"]
TABLE_1 = "Kim et al. (2013), Table 1"


class WorkAndRangeSettings(Settings):
    """Attraction of two flats by its work and range, in place of A_H and D0 (docs/contact.md)."""

    work_mJ_m2: float = key(..., "work that separates two flats from touch", "(0, 100000] mJ/m^2")
    range_nm: float = key(
        ...,
        "that work over the largest attraction: D0/2 (offset), 3/2 D0 (clamped)",
        "[0.001, 15] nm",
    )

    def gap_cutoff_nm(self, law: AttractionLaw) -> float:
        """D0."""
        return self.range_nm / RANGE_IN_D0[law]

    def hamaker(self, law: AttractionLaw) -> float:
        """A_H in 1e-18 J; 1 mJ/m^2 is 1e-3 nN/nm."""
        return WORK_FACTOR[law] * math.pi * self.gap_cutoff_nm(law) ** 2 * self.work_mJ_m2 * 1e-3


def _key(row: InputDefinition) -> Any:
    """Type, default and description of the key of an input."""
    symbol = "" if row.symbol in row.label else f" {row.symbol}"
    about = f"{row.label}{symbol} ({row.unit})"
    if row.optional:
        return InputRow | None, Field(default=None, description=f"optional input: {about}")
    if row.literature is None:
        kind = InputRow | None if row.hardness else InputRow
        return kind, Field(default=InputRow(origin=cast(Any, row.stage)), description=about)
    return InputRow, Field(
        default=InputRow(values=row.literature, source=TABLE_1), description=about
    )


class InputsSettings(
    create_model("InputsSettings", __base__=Settings, **{row.name: _key(row) for row in INPUTS})
):
    """Origin and distribution of the uncertain inputs (docs/inputs.md)."""

    hardness: HardnessLawName = key(
        "paper",
        "hardness by contact area: constant, eq. 4 (h_prime), or film on a base (h_film, t_film,"
        " k_film, m_film)",
    )
    adhesion: WorkAndRangeSettings | None = key(
        None, "work and range in place of hamaker and gap_cutoff"
    )
    accepted_gates: tuple[Literal["hardness", "elastic", "topography"], ...] = key(
        (),
        "stages whose inputs are taken although their gate failed: to test the chain, for no"
        " prediction",
    )
    correlations: dict[str, dict[str, float]] = key(
        {},
        "rank correlations besides those that a stage reports, such as {rms: {q0: -0.4, hurst:"
        " 0.2}}; -1 < each < 1",
    )

    @model_validator(mode="after")
    def _one_attraction(self) -> "InputsSettings":
        defaults = type(self).model_fields
        names = ("hamaker", "gap_cutoff")
        stated = [name for name in names if getattr(self, name) != defaults[name].default]
        if self.adhesion and stated:
            raise ValueError(
                f"adhesion and {' and '.join(stated)} give the same attraction; leave one of"
                " them out"
            )
        return self

    @model_validator(mode="after")
    def _inputs_of_the_hardness(self) -> "InputsSettings":
        for row in INPUTS:
            stated = getattr(self, row.name)
            default = type(self).model_fields[row.name].default
            if row.hardness == self.hardness and stated is None:
                raise ValueError(
                    f"hardness: {row.hardness} needs {row.name}, {row.label} ({row.unit}); give"
                    " its row"
                )
            if row.hardness not in ("", self.hardness) and stated not in (None, default):
                raise ValueError(
                    f"{row.name} belongs to hardness: {row.hardness}, but hardness is"
                    f" {self.hardness}; set {row.name} to null, or take that law"
                )
        return self

    @model_validator(mode="after")
    def _known_names(self) -> "InputsSettings":
        names = list(self.rows())
        for pair in self.pairs:
            if unknown := [name for name in pair if name not in names]:
                raise ValueError(
                    f"correlations: unknown input {unknown[0]}; accepted: {', '.join(names)}"
                )
            if pair[0] == pair[1]:
                raise ValueError(f"correlations: {pair[0]} with itself; name two inputs")
            if len({self.rows()[name].varies for name in pair}) > 1:
                raise ValueError(
                    f"correlations: of {' and '.join(pair)} one is common and one varies with each"
                    " device"
                )
            if pair[::-1] in self.pairs:
                raise ValueError(
                    f"correlations: {pair[0]} with {pair[1]} is stated twice; leave one of them out"
                )
            if not -1 < (rank := self.pairs[pair]) < 1:
                raise ValueError(
                    f"correlations: {pair[0]} with {pair[1]} = {rank:g}; accepted is more than -1"
                    " and less than 1; where one input follows from the other, give both the same"
                    " file of joint samples"
                )
        for name, row in self.rows().items():
            stage = BY_NAME[name].stage
            accepted = dict.fromkeys(("literature", stage, "calibration"))
            if row.origin not in accepted:
                raise ValueError(f"{name}: origin {row.origin}; accepted: {', '.join(accepted)}")
            if row.origin == "calibration" and row.values is None and stage == "literature":
                raise ValueError(
                    f"{name}: no stage computes it, so that its prior must be stated: give its"
                    " values"
                )
        return self

    @property
    def pairs(self) -> dict[tuple[str, str], float]:
        """The stated rank correlations (Spearman's) of two inputs."""
        pairs = {}
        for first, ranks in self.correlations.items():
            for second, rank in ranks.items():
                pairs[first, second] = rank
        return pairs

    def rows(self, law: AttractionLaw = "offset") -> dict[str, InputRow]:
        """The inputs in use, by name; `law` of the attraction that `adhesion` states."""
        used = [row.name for row in INPUTS if row.hardness in ("", self.hardness)]
        named = {name: getattr(self, name) for name in used}
        if self.adhesion:
            stated = {
                "hamaker": self.adhesion.hamaker(law),
                "gap_cutoff": self.adhesion.gap_cutoff_nm(law),
            }
            for name, value in stated.items():
                named[name] = InputRow(
                    distribution="fixed", values=(value,), source="inputs.adhesion"
                )
        return {name: row for name, row in named.items() if row is not None}

    def prior_origins(self) -> dict[str, str]:
        """Where the distribution of each input comes from, before any calibration."""
        origins = {}
        for name, row in self.rows().items():
            origins[name] = row.origin
            if row.origin == "calibration":
                origins[name] = BY_NAME[name].stage if row.values is None else "literature"
        return origins

    def origins(self) -> set[str]:
        """Where the inputs come from; cheap, so that a workflow can decide which stages to run."""
        used = {row.origin for row in self.rows().values()}
        return used | set(self.prior_origins().values())

    def priors(self) -> "InputsSettings":
        """The inputs before any calibration."""
        origins = self.prior_origins()
        priors = {}
        for name, row in self.rows().items():
            priors[name] = row.model_copy(update={"origin": origins[name]})
        return self.model_copy(update=priors)
