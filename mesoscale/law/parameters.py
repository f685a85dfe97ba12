"""The one table of the law's parameters, and of the outputs made of them. Light to import."""

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class LawParameter:
    """One number of the law, or its change on opening.

    Attributes
    ----------
    name : column of result files and field of `Law` and `LawFit`, with its unit as suffix.
    short : name in the paper's tables.
    symbol : as the report shows it.
    meaning : in words.
    power : the report and the paper show it in units of 10^power.
    any_sign : whether it may be zero or negative; other responses are fitted to the logarithm.
    """

    name: str
    short: str
    symbol: str
    unit: str
    meaning: str
    power: int = 0
    any_sign: bool = False


LAW = (
    LawParameter("d_c_nm", "d_c", "d_c", "nm", "mean separation at initial contact", any_sign=True),
    LawParameter("C_a_GPa_nm", "C_a", "C_a", "GPa/nm", "adhesion per nm of approach", power=-5),
    LawParameter("C_r_GPa", "C_r", "C_r", "GPa", "scale of the repulsion", power=-4),
    LawParameter("rho_r_nm", "rho_r", "ρ_r", "nm", "decay length of the repulsion"),
)
"""The parameters of one branch (docs/law.md)."""

CHANGES = tuple(
    replace(
        row,
        name=f"delta_{row.name}",
        short=f"delta_{row.short}",
        symbol=f"δ{row.symbol}",
        meaning=f"{row.meaning}, change on opening",
        any_sign=True,
    )
    for row in LAW
)
LAW_OUTPUTS = (*LAW, *CHANGES)
"""Closing parameters and their change on opening, in the order of the paper's Table 2."""

PARAMETERS = tuple(row.name for row in LAW)
OUTPUTS = tuple(row.name for row in LAW_OUTPUTS)
BRANCHES = ("closing", "opening")
FITTED = tuple(f"{branch}_{name}" for branch in BRANCHES for name in PARAMETERS)
"""Parameters of both branches as columns; each has a response."""

CLOSING = slice(0, len(LAW))
"""Where the closing parameters stand in an array of FITTED or OUTPUTS."""
OPENING = slice(len(LAW), 2 * len(LAW))
"""Where the opening parameters (in OUTPUTS: the changes on opening) stand."""
