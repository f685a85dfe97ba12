"""The models that `asperity serve` offers over UM-Bridge: contact cycle, law and pad
(docs/umbridge.md).

A model takes lists of numbers in stated units and a configuration, and gives lists of numbers. It
calls the library and changes nothing: the same inputs give the same digits.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from typing import Any

import numpy as np

from mesoscale.calibration.observables import LEVELS, force_levels_nN, separations_at
from mesoscale.checks import check_seed
from mesoscale.contact import ContactInputs, Cycle, run_cycle
from mesoscale.errors import InputError
from mesoscale.law.branches import laws_of
from mesoscale.law.parameters import PARAMETERS
from mesoscale.pad.cells import sample_cells
from mesoscale.pad.closing import press_cells
from mesoscale.pad.grid import PadGrid
from mesoscale.settings import ContactSettings, Settings

Config = Mapping[str, Any]

MOST_POINTS = 1 << 26
"""Grid points of all cells of one request."""
INPUTS = tuple(field.name for field in fields(ContactInputs) if field.default is MISSING)
"""What the numbers of the only input list are."""


@dataclass(frozen=True)
class ServedModel:
    """One model of the server.

    Attributes
    ----------
    config : keys that the configuration may have.
    evaluate : output lists, from the inputs and the configuration.
    output_sizes : lengths of the output lists.
    """

    name: str
    config: tuple[str, ...]
    evaluate: Callable[[ContactInputs, Config], Sequence[Any]]
    output_sizes: Callable[[Config], list[int]]

    def __call__(self, parameters: Any, config: Any) -> list[list[float]]:
        """Evaluate.

        Raises
        ------
        InputError : wrong shape, unknown key of the configuration, values out of range, no finite
            result.
        """
        checked = self.checked_config(config)
        named = ", ".join(INPUTS)
        values = parameters[0] if isinstance(parameters, list) and len(parameters) == 1 else None
        if (
            not isinstance(values, list)
            or len(values) != len(INPUTS)
            or not all(map(_is_number, values))
        ):
            raise InputError(
                f"{self.name}: input must be one list of {len(INPUTS)} numbers: {named}"
            )
        try:
            inputs = ContactInputs(**dict(zip(INPUTS, map(float, values), strict=True)))
        except OverflowError:
            raise InputError(f"{self.name}: a number too large; inputs are {named}") from None
        result = [np.asarray(output, float) for output in self.evaluate(inputs, checked)]
        if not all(np.isfinite(output).all() for output in result):
            raise InputError(
                f"{self.name}: no finite result at these inputs (JSON has no NaN); look at {named}"
            )
        return [output.tolist() for output in result]

    def checked_config(self, config: Any) -> Config:
        """The configuration, with its keys checked.

        Raises
        ------
        InputError
        """
        if not isinstance(config, dict):
            raise InputError(
                f"{self.name}: config must be a mapping with keys of {', '.join(self.config)}"
            )
        if unknown := sorted(set(config) - set(self.config)):
            raise InputError(
                f"{self.name}: config.{unknown[0]}: unknown key; accepted: {', '.join(self.config)}"
            )
        return config


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _settings(kind: type[Settings], config: Config, key: str) -> Any:
    stated = config.get(key, {})
    if not isinstance(stated, dict):
        raise InputError(f"config.{key}: must be a mapping of settings")
    return kind(**stated)


def _contact(config: Config, cells: int = 1) -> ContactSettings:
    """Settings of the contact, for a number of cells that a server can afford."""
    contact = _settings(ContactSettings, config, "contact")
    if cells * contact.pixels**2 > MOST_POINTS:
        raise InputError(
            f"config.contact.pixels = {contact.pixels}, {cells} cells: accepted are {MOST_POINTS}"
            " grid points in all"
        )
    return contact


def _seed(config: Config, default: int) -> int:
    seed = config.get("seed", default)
    check_seed(seed)
    return seed


def _cycle(inputs: ContactInputs, config: Config) -> Cycle:
    return run_cycle(inputs, _contact(config), _seed(config, 1))


def _contact_cycle(inputs: ContactInputs, config: Config) -> Sequence[Any]:
    """First and last contact (nm) and pull-off (nN); separations (nm) at forces, closing and
    opening.
    """
    cycle = _cycle(inputs, config)
    forces = force_levels_nN(_contact(config).max_force_nN)
    scalars = [cycle.first_contact_nm, cycle.last_contact_nm, -cycle.opening.net_nN.min()]
    return [scalars, separations_at(cycle.closing, forces), separations_at(cycle.opening, forces)]


def _law(inputs: ContactInputs, config: Config) -> Sequence[Any]:
    """Parameters of the law, closing and opening."""
    laws = laws_of(_cycle(inputs, config))
    return [[getattr(law, name) for name in PARAMETERS] for law in laws]


def _separations(config: Config) -> list[float]:
    stated = config.get("separations_nm", (40.0, 35.0, 30.0, 28.0))
    limit = 1000
    listed = isinstance(stated, (list, tuple)) and 0 < len(stated) <= limit
    if not listed or not all(map(_is_number, stated)):
        raise InputError(
            f"config.separations_nm: must be a list of 1 .. {limit} falling separations in nm"
        )
    return [float(x) for x in stated]


def _pad(inputs: ContactInputs, config: Config) -> Sequence[Any]:
    """Mean net pressure (MPa) at the separations, of closing and of opening from the last one."""
    count = config.get("cells", 16)
    first = _seed(config, 1000)
    limit = 100_000
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= limit:
        raise InputError(f"config.cells = {count!r}: accepted is a whole number, 1 .. {limit}")
    contact = _contact(config, count)
    separations = np.array(_separations(config))
    grid = PadGrid(separations, np.array([separations.size - 1]))
    cells = sample_cells(inputs, count, first)
    curves = press_cells(inputs, contact, grid, cells).curves
    return [1e3 * branch.sum(axis=0)[::-1] for branch in (curves.closing, curves.opening[0])]


MODELS = {
    model.name: model
    for model in (
        ServedModel(
            "contact_cycle", ("seed", "contact"), _contact_cycle, lambda config: [3, LEVELS, LEVELS]
        ),
        ServedModel("law", ("seed", "contact"), _law, lambda config: [len(PARAMETERS)] * 2),
        ServedModel(
            "pad",
            ("seed", "cells", "separations_nm", "contact"),
            _pad,
            lambda config: [len(_separations(config))] * 2,
        ),
    )
}
"""All models by name."""
