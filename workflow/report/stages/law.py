"""The compact law with its spread over the inputs."""

import numpy as np

from mesoscale.law.compact import Law
from mesoscale.law.compact import pressure as law_pressure
from mesoscale.law.parameters import PARAMETERS
from workflow.report.available import Results, Row
from workflow.report.drawing import BLUE, ORANGE, SOFT, draw
from workflow.report.numbers import column, number

COLORS = {"closing": BLUE, "opening": ORANGE}


def band(results: Results) -> str:
    """Median and spread of the law over the samples of the inputs, up to the pressure that it was fitted to."""
    rows = results.csv("uq/law.csv")
    highest = results.fitted_MPa
    spread = {}
    for name in COLORS:
        part = [row for row in rows if row["branch"] == name]
        spread[name] = column(part, "gap_nm"), *(column(part, f"pressure_q{q}_GPa") * 1e3 for q in ("05", "50", "95"))
    # separations between the largest pressure and the last contact
    reach = max(float(gap[high > 0].max(initial=0)) for gap, _, _, high in spread.values())
    near = min(float(gap[middle < highest].min()) for gap, _, middle, _ in spread.values())

    def plot(axis):
        for name, color in COLORS.items():
            x, low, middle, high = spread[name]
            inside = middle <= highest
            axis.fill_between(x, low, np.minimum(high, highest), color=color, alpha=0.16, linewidth=0)
            axis.plot(x[inside], middle[inside], color=color, label=f"{name}, median")
        axis.axhline(0, color=SOFT, linewidth=0.8)
        axis.set(xlim=(max(0.0, 2 * near - reach), 1.05 * reach), ylim=(-0.05 * highest, highest))
        axis.set(xlabel="mean separation (nm)", ylabel="contact pressure (MPa)")
        axis.fill_between([], [], [], color=SOFT, alpha=0.3, label="5 to 95 %")
        axis.legend()

    return draw("law", "Contact pressure against separation with the spread over uncertain inputs", plot)


def pressure(h: np.ndarray, row: Row, hamaker: float, rho_a: float, shield: float) -> np.ndarray:
    """Total pressure of a fitted row (GPa), eqs 10 to 13."""
    parameters = {name: number(row[name]) for name in PARAMETERS}
    attractive, repulsive = law_pressure(h, Law(**parameters, hamaker=hamaker, rho_a_nm=rho_a, shield_nm=shield))
    return attractive + repulsive


def fit_of(rows: list[Row], curve: str, branch: str) -> Row | None:
    """The fit of a curve; None where it gave no law."""
    return next((row for row in rows if row["curve"] == curve and row["branch"] == branch and row["C_r_GPa"]), None)


def constants(results: Results) -> tuple[float, float]:
    """rho_a and the shield of eq. 12 as this scene's fits used them."""
    if results.has("uq/surrogate.json"):
        law = results.json("uq/surrogate.json")["law"]
        return float(law["rho_a_nm"]), float(law["alpha_nm"])
    return 2.0, 2.0
