"""The models that `asperity serve` offers over UM-Bridge: contact cycle, law and pad (docs/umbridge.md).

A model takes lists of numbers in stated units and a configuration, and gives lists of numbers. It calls the library
and changes nothing: the same inputs give the same digits.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from typing import Any

import numpy as np

from mesoscale.calibration.observables import LEVELS, force_levels_nN
from mesoscale.calibration.observed import separations_at
from mesoscale.checks import check_seed
from mesoscale.contact import ContactInputs, Cycle, run_cycle
from mesoscale.errors import InputError
from mesoscale.law.branches import laws_of
from mesoscale.law.parameters import PARAMETERS
from mesoscale.pad.cells import PadGrid, close_cells, sample_cells
from mesoscale.pad.curves import assemble
from mesoscale.settings import ContactSettings, LawSettings, Settings

Numbers = Sequence[Sequence[float]]
Config = Mapping[str, Any]

MOST_POINTS = 1 << 26
"""Grid points of all cells of one request."""
MOST_SEPARATIONS = 1000
INPUTS = tuple(field.name for field in fields(ContactInputs) if field.default is MISSING)
PAD_SEPARATIONS_NM = (40.0, 35.0, 30.0, 28.0)


@dataclass(frozen=True)
class Model:
    """One model of the server.

    Attributes
    ----------
    name, about, inputs : what the numbers of the only input list are.
    outputs : what each output list is.
    config : keys that the configuration may have.
    """

    name: str
    about: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    config: tuple[str, ...]
    evaluate: Callable[[Sequence[float], Config], list[list[float]]]
    output_sizes: Callable[[Config], list[int]]

    def __call__(self, parameters: Any, config: Any) -> list[list[float]]:
        """Evaluate.

        Raises
        ------
        InputError : wrong shape, unknown key of the configuration, values out of range, no finite result.
        """
        checked = self.checked_config(config)
        if not isinstance(parameters, list) or len(parameters) != 1 or not isinstance(parameters[0], list):
            raise InputError(f"{self.name}: input must be one list of {len(self.inputs)} numbers: {self._named()}")
        values = parameters[0]
        good = all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in values)
        if len(values) != len(self.inputs) or not good:
            raise InputError(f"{self.name}: input must be one list of {len(self.inputs)} numbers: {self._named()}")
        try:
            numbers = [float(x) for x in values]
        except OverflowError:
            raise InputError(f"{self.name}: a number too large; inputs are {self._named()}") from None
        result = self.evaluate(numbers, checked)
        if not all(np.isfinite(part).all() for part in result):
            raise InputError(
                f"{self.name}: no finite result at these inputs (JSON has no NaN); look at {self._named()}"
            )
        return result

    def checked_config(self, config: Any) -> Config:
        """The configuration, with its keys checked.

        Raises
        ------
        InputError
        """
        if not isinstance(config, dict):
            raise InputError(f"{self.name}: config must be a mapping with keys of {', '.join(self.config)}")
        unknown = sorted(set(config) - set(self.config))
        if unknown:
            raise InputError(f"{self.name}: config.{unknown[0]}: unknown key; accepted: {', '.join(self.config)}")
        return config

    def _named(self) -> str:
        return ", ".join(self.inputs)


def _settings(kind: type[Settings], config: Config, key: str) -> Any:
    given = config.get(key, {})
    if not isinstance(given, dict):
        raise InputError(f"config.{key}: must be a mapping of settings")
    return kind(**given)


def _contact(config: Config, cells: int = 1) -> ContactSettings:
    """Settings of the contact, for a number of cells that a server can afford."""
    contact = _settings(ContactSettings, config, "contact")
    if cells * contact.pixels**2 > MOST_POINTS:
        raise InputError(
            f"config.contact.pixels = {contact.pixels}, {cells} cells: accepted are {MOST_POINTS} grid points in all"
        )
    return contact


def _cycle(values: Sequence[float], config: Config) -> Cycle:
    seed = config.get("seed", 1)
    check_seed(seed)
    contact = _contact(config)
    return run_cycle(ContactInputs(**dict(zip(INPUTS, values, strict=True))), contact, seed)


def _contact_cycle(values: Sequence[float], config: Config) -> list[list[float]]:
    cycle = _cycle(values, config)
    forces = force_levels_nN(_settings(ContactSettings, config, "contact").max_force_nN)
    return [
        [float(cycle.first_contact_nm), float(cycle.last_contact_nm), float(-cycle.opening.net_nN.min())],
        separations_at(cycle.closing, forces).tolist(),
        separations_at(cycle.opening, forces).tolist(),
    ]


def _law(values: Sequence[float], config: Config) -> list[list[float]]:
    laws = laws_of(_cycle(values, config), _settings(LawSettings, config, "law"))
    return [[float(np.asarray(getattr(law, name))) for name in PARAMETERS] for law in laws]


def _separations(config: Config) -> list[float]:
    given = config.get("separations_nm", PAD_SEPARATIONS_NM)
    listed = isinstance(given, (list, tuple)) and 0 < len(given) <= MOST_SEPARATIONS
    if not listed or not all(isinstance(x, (int, float)) for x in given):
        raise InputError(f"config.separations_nm: must be a list of 1 .. {MOST_SEPARATIONS} falling separations in nm")
    return [float(x) for x in given]


def _pad(values: Sequence[float], config: Config) -> list[list[float]]:
    count, first = config.get("cells", 16), config.get("seed", 1000)
    check_seed(first)
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= 100_000:
        raise InputError(f"config.cells = {count!r}: accepted is a whole number, 1 .. 100000")
    contact = _contact(config, count)
    separations = np.array(_separations(config))
    grid = PadGrid(separations, np.array([len(separations) - 1]))
    inputs = ContactInputs(**dict(zip(INPUTS, values, strict=True)))
    cells = sample_cells(inputs, count, first)
    pad = assemble(grid, cells, list(close_cells(inputs, contact, grid, cells)), contact.length_nm**2)
    return [
        (1e3 * pad.mean(pad.closing).sum(axis=0)).tolist(),
        (1e3 * pad.mean(pad.opening[:, 0]).sum(axis=0)).tolist(),
    ]


MODELS = {
    model.name: model
    for model in (
        Model(
            "contact_cycle",
            "one surface closed and opened",
            INPUTS,
            (
                "first contact (nm), last contact (nm), pull-off (nN)",
                "separations (nm) of closing at net forces from 2 to 50 % of the largest, evenly in logarithm",
                "the same of opening",
            ),
            ("seed", "contact"),
            _contact_cycle,
            lambda config: [3, LEVELS, LEVELS],
        ),
        Model(
            "law",
            "the compact law fitted to a cycle",
            INPUTS,
            tuple(f"{branch}: {', '.join(PARAMETERS)}" for branch in ("closing", "opening")),
            ("seed", "contact", "law"),
            _law,
            lambda config: [len(PARAMETERS)] * 2,
        ),
        Model(
            "pad",
            "cells under one plane",
            INPUTS,
            (
                "mean net pressure (MPa) of closing at separations_nm",
                "the same of opening from the last separation",
            ),
            ("seed", "cells", "separations_nm", "contact"),
            _pad,
            lambda config: [len(_separations(config))] * 2,
        ),
    )
}
"""All models by name."""


def evaluate(name: str, parameters: Any, config: Any) -> list[list[float]]:
    """Evaluate a model by its name; what a worker process runs.

    Raises
    ------
    InputError : see `Model`.
    """
    return MODELS[name](parameters, config)
