"""The compact law: its curve with spread, its fits and their gate."""

import numpy as np

from mesoscale.law.compact import Law
from mesoscale.law.compact import pressure as law_pressure
from mesoscale.law.parameters import PARAMETERS
from mesoscale.law.wells import MOST_MISSED, missed_wells
from workflow.report.available import Results, Row
from workflow.report.drawing import BLUE, ORANGE, SOFT, draw
from workflow.report.numbers import column, number
from workflow.report.page import Gate

COLORS = {"closing": BLUE, "opening": ORANGE}
HIGHEST_MPA = 15.0  # pressures of interest to a contact switch
MOST_MISSING = 0.05  # share of curves without a law beyond which the rest is no fair sample


def gates(results: Results) -> list[Gate]:
    """Whether enough curves gave a law."""
    if not results.has("law/parameters.csv"):
        return []
    rows = results.csv("law/parameters.csv")
    poor = [row for row in rows if row["status"] == "poor_fit"]
    missing = [row for row in rows if row["status"] not in ("ok", "poor_fit")]
    reasons = []
    if poor:
        worst = column(poor, "residual").max()
        reasons.append(
            f"{len(poor)} of {len(rows)} fits miss their curve by up to {worst:.0%} of its largest pressure; they are "
            "used as they are, so C_r and ρ_r carry that error."
        )
    if missing:
        kinds = sorted({row["status"].partition(":")[0].replace("_", " ") for row in missing})
        reasons.append(
            f"{len(missing)} of {len(rows)} curves gave no law ({', '.join(kinds)}); their surfaces are left out of "
            "the mean, which favours the surfaces that could be fitted."
        )
    if results.has("law/wells.csv"):
        missed, known = missed_wells(results.csv("law/wells.csv"))
        if missed:
            reasons.append(
                f"{missed} of {known} laws miss the depth of their curve's adhesion well by more than "
                f"{MOST_MISSED:.0%} (law/wells.csv, column attraction_status): take release and stiction from the pad."
            )
    checks = results.csv("uq/validation.csv") if results.has("uq/validation.csv") else []
    lost = max((int(row["missing"]) for row in checks), default=0)
    if lost:
        runs = checks[0]["runs"]
        reasons.append(f"{lost} of {runs} direct runs gave no law; they are left out of the response and its check.")
    return [Gate("law", len(missing) <= MOST_MISSING * len(rows), reasons)]


def band(results: Results) -> str:
    """Median and spread of the law over the samples of the inputs; the adhesion well apart, where contact begins."""
    rows = results.csv("device/law.csv")
    spread, wells = {}, _wells(results)
    for name in COLORS:
        part = [row for row in rows if row["branch"] == name]
        spread[name] = column(part, "gap_nm"), *(column(part, f"pressure_q{q}_GPa") * 1e3 for q in ("05", "50", "95"))
    # separations between the pressure of interest and the last contact
    reach = max(float(gap[high > 0].max(initial=0)) for gap, _, _, high in spread.values())
    near = min(float(gap[middle < HIGHEST_MPA].min()) for gap, _, middle, _ in spread.values())

    def plot(axis, well):
        for name, color in COLORS.items():
            for panel, (x, low, middle, high) in ((axis, spread[name]), (well, wells[name])):
                panel.fill_between(x, low, high, color=color, alpha=0.16, linewidth=0)
                panel.plot(x, middle, color=color, label=f"{name}, median")
                panel.axhline(0, color=SOFT, linewidth=0.8)
        axis.set(xlim=(max(0.0, 2 * near - reach), 1.05 * reach), ylim=(-0.05 * HIGHEST_MPA, HIGHEST_MPA))
        axis.set(xlabel="mean separation (nm)", ylabel="contact pressure (MPa)", title="repulsion")
        deepest = -min(float(low.min()) for _, low, _, _ in wells.values())
        well.set(ylim=(-1.05 * deepest, 0.3 * deepest), title="adhesion well")
        well.set(xlabel="mean separation less d_c (nm)", ylabel="contact pressure (kPa)")
        axis.fill_between([], [], [], color=SOFT, alpha=0.3, label="5 to 95 %")
        axis.legend()

    label = "Contact pressure against separation with the spread over uncertain inputs, and its adhesion well"
    return draw("law", label, plot, (4.6, 5.2), rows=2)


def _wells(results: Results) -> dict[str, tuple[np.ndarray, ...]]:
    """By branch: separation less d_c (nm) and the 5, 50 and 95 % quantiles of the samples' pressure there (kPa)."""
    rows, bands = results.csv("uq/samples.csv"), {}
    rho_a, shield = constants(results)
    scale = number(results.json("device/switch.json")["adhesion_scale"])
    for branch in COLORS:
        d_c, C_a, C_r, rho_r = (column(rows, f"{branch}_{name}")[:, None] for name in PARAMETERS)
        beyond = np.linspace(-6 * float(np.nanmedian(rho_r)), 1.3 * rho_a, 241)
        hamaker = column(rows, "hamaker")[:, None]
        attractive, repulsive = law_pressure(d_c + beyond, Law(d_c, C_a, C_r, rho_r, hamaker, rho_a, shield))
        quantiles = np.nanquantile(1e6 * (repulsive + scale * attractive), [0.05, 0.5, 0.95], axis=0)
        # up to where half of the samples push
        start = int(np.flatnonzero(quantiles[1] > 0).max(initial=0))
        bands[branch] = (beyond[start:], *quantiles[:, start:])
    return bands


def pressure(h: np.ndarray, row: Row, hamaker: float, rho_a: float, shield: float) -> np.ndarray:
    """Total pressure of a fitted row (GPa), eqs 10 to 13."""
    parameters = {name: number(row[name]) for name in PARAMETERS}
    attractive, repulsive = law_pressure(h, Law(**parameters, hamaker=hamaker, rho_a_nm=rho_a, shield_nm=shield))
    return attractive + repulsive


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
