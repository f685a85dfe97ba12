"""The one table of the uncertain inputs. Light to import: settings and workflow plan by it."""

from dataclasses import dataclass

from asperity.guards.foreign_text import did_you_mean
from mesoscale.errors import InputError


@dataclass(frozen=True)
class InputDefinition:
    """What an uncertain input is, and how it enters the contact model.

    Attributes
    ----------
    name : key in the settings and in result files.
    label : in words.
    symbol : as the report shows it.
    unit : unit of its values; 1 where there is none.
    low : smallest value that is accepted.
    high : largest value that is accepted.
    zero : whether 0 is accepted besides.
    stage : stage that can compute it (hardness, elastic, topography), or literature.
    literature : default range where no stage computes it, uniform, from the paper's Table 1.
    setting : field of `ContactSettings`, or of one of its sections, that it replaces; empty: a
        field of `ContactInputs` of its name.
    optional : left out unless a scene gives it.
    hardness : law of hardness that has it (`inputs.hardness`); empty: not an input of one.
    """

    name: str
    label: str
    symbol: str
    unit: str
    low: float
    high: float
    zero: bool = False
    stage: str = "literature"
    literature: tuple[float, float] | None = None
    setting: str = ""
    optional: bool = False
    hardness: str = ""

    @property
    def accepted(self) -> str:
        """The accepted values in words."""
        accepted = f"{self.low:g} .. {self.high:g}"
        if self.zero:
            return f"0 or {accepted}"
        return accepted

    @property
    def may_lack(self) -> bool:
        """Whether scenes can go without it."""
        return self.optional or bool(self.hardness)

    def accepts(self, value: float) -> bool:
        """Is this a physical value?"""
        return self.low <= value <= self.high or (self.zero and value == 0)


INPUTS = (
    InputDefinition(
        "hamaker",
        "Hamaker constant",
        "A_H",
        "1e-18 J",
        1e-6,
        1e4,
        zero=True,
        literature=(0.18, 0.25),
    ),
    InputDefinition("e_star", "effective modulus", "E*", "GPa", 1e-6, 2e3, stage="elastic"),
    InputDefinition(
        "h_macro",
        "macroscopic hardness",
        "H_macro",
        "GPa",
        1e-9,
        1e6,
        zero=True,
        literature=(0.7, 3.2),
    ),
    InputDefinition(
        "h_prime",
        "size effect of hardness",
        "H′",
        "GPa nm^0.5",
        1e-9,
        1e6,
        True,
        stage="hardness",
        hardness="paper",
    ),
    InputDefinition("q0", "roll-off wave vector", "q₀", "1/nm", 1e-7, 1e3, stage="topography"),
    InputDefinition("hurst", "Hurst exponent", "Hurst", "1", 1e-6, 2.0, stage="topography"),
    InputDefinition("rms", "RMS roughness", "RMS", "nm", 1e-5, 1e6, zero=True, stage="topography"),
    InputDefinition(
        "gap_cutoff",
        "gap cutoff",
        "D₀",
        "nm",
        1e-6,
        30.0,
        stage="hardness",
        setting="gap_cutoff_nm",
        optional=True,
    ),
    InputDefinition(
        "q1",
        "short-wave cut-off",
        "q₁",
        "1/nm",
        1e-6,
        1e3,
        stage="topography",
        setting="q1_per_nm",
        optional=True,
    ),
    InputDefinition(
        "h_film",
        "hardness of the film",
        "H_film",
        "GPa",
        1e-9,
        1e6,
        True,
        "hardness",
        optional=True,
        hardness="film",
    ),
    InputDefinition(
        "t_film",
        "thickness of the film",
        "t_film",
        "nm",
        1e-3,
        1e6,
        True,
        optional=True,
        hardness="film",
    ),
    InputDefinition(
        "k_film",
        "softening by the base",
        "k",
        "1",
        1e-6,
        1e3,
        True,
        "hardness",
        optional=True,
        hardness="film",
    ),
    InputDefinition(
        "m_film",
        "exponent of softening",
        "m",
        "1",
        1e-2,
        10.0,
        True,
        "hardness",
        optional=True,
        hardness="film",
    ),
    InputDefinition(
        "humidity",
        "relative humidity",
        "RH",
        "1",
        1e-6,
        1.0 - 1e-6,
        True,
        setting="air.humidity",
        optional=True,
    ),
)
"""The inputs of the paper's Table 1 in its order, then the optional ones.

Their bounds are wide, from the softest gels to diamond (E* of 1150 GPa on a rigid flat), yet narrow
enough to refuse metres, megapascals of stiff solids and joules. """

RMS_SCATTER = InputDefinition(
    "rms_scatter",
    "scatter of ln RMS between places",
    "s_RMS",
    "1",
    1e-6,
    2.0,
    zero=True,
    stage="topography",
)
"""Input of pads alone: a single cell has the RMS height of its place."""

BY_NAME = {row.name: row for row in (*INPUTS, RMS_SCATTER)}


def definition(name: str) -> InputDefinition:
    """The row of an input.

    Raises
    ------
    InputError : there is no input of this name.
    """
    if name not in BY_NAME:
        raise InputError(
            f"{name}: no such input of the contact model{did_you_mean(name, BY_NAME)} (accepted:"
            f" {', '.join(BY_NAME)})"
        )
    return BY_NAME[name]
