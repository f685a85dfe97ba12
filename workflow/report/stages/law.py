"""The compact law: its curve with spread, its fits and their gate."""

import numpy as np

from workflow.report.available import Results, Row
from workflow.report.drawing import BLUE, ORANGE, SOFT, draw
from workflow.report.numbers import column, number
from workflow.report.page import Gate


def gates(results: Results) -> list[Gate]:
    """Whether enough curves gave a law."""
    if not results.has("law/parameters.csv"):
        return []
    rows = results.csv("law/parameters.csv")
    counts: dict[str, int] = {}
    for row in rows:
        status = row.get("status", "ok").partition(":")[0]
        counts[status] = counts.get(status, 0) + 1
    bad = {status: count for status, count in counts.items() if status != "ok"}
    reasons = [f"{count} of {len(rows)} fits: {status.replace('_', ' ')}" for status, count in sorted(bad.items())]
    missing = sum(count for status, count in bad.items() if status != "poor_fit")
    return [Gate("law", missing <= 0.05 * len(rows), reasons)]


def band(results: Results) -> str:
    """The exported law with its spread, closing and opening."""
    rows = results.csv("device/law.csv")
    highest = max(column(rows, "pressure_q50_GPa").max() * 1e3, 1e-3)
    top = min(highest, 15.0)

    def plot(axis):
        for branch, color in (("closing", BLUE), ("opening", ORANGE)):
            part = [row for row in rows if row["branch"] == branch]
            gap = column(part, "gap_nm")
            low, high = (column(part, f"pressure_q{q}_GPa") * 1e3 for q in ("05", "95"))
            axis.fill_between(gap, low, high, color=color, alpha=0.16, linewidth=0)
            axis.plot(gap, column(part, "pressure_GPa") * 1e3, color=color, label=f"{branch}, at central inputs")
        axis.axhline(0, color=SOFT, linewidth=0.8)
        axis.set(xlim=(0, 80), ylim=(-0.2 * top, top), xlabel="mean separation (nm)")
        axis.set_ylabel("contact pressure (MPa)")
        axis.fill_between([], [], [], color=SOFT, alpha=0.3, label="5 to 95 % of the samples")
        axis.legend()

    return draw("law", "Contact pressure against separation with the spread over uncertain inputs", plot, (6.4, 3.7))


def pressure(h: np.ndarray, row: Row, hamaker: float, rho_a: float, shield: float) -> np.ndarray:
    """Total pressure of a fitted row (GPa), eqs 10 to 13."""
    d_c, C_a, C_r, rho_r = (number(row[key]) for key in ("d_c_nm", "C_a_GPa_nm", "C_r_GPa", "rho_r_nm"))
    attraction = hamaker / (6 * np.pi * (np.maximum(h, 0) ** 3 + shield**3)) + C_a * np.maximum(d_c + rho_a - h, 0)
    return C_r * np.expm1(np.maximum(d_c - h, 0) / rho_r) - attraction


def fit_of(rows: list[Row], curve: str, branch: str) -> Row | None:
    for row in rows:
        if row["curve"] == curve and row["branch"] == branch and row["C_r_GPa"]:
            return row
    return None


def constants(results: Results) -> tuple[float, float]:
    """rho_a and the shield of eq. 12 as this scene's fits used them."""
    if results.has("uq/surrogate.json"):
        law = results.json("uq/surrogate.json")["law"]
        return float(law["rho_a_nm"]), float(law["alpha_nm"])
    return 2.0, 2.0
