"""Figures of the contact, its law, its uncertainty and the device."""

import json

import numpy as np

from workflow.report.available import Results, Row, column, number
from workflow.report.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, RED, SERIES, SKY, SOFT, draw

MODELS = {
    "elastic": ("elastic", ":"),
    "nonlinear": ("non-linear elastic", "--"),
    "plastic": ("asperity plasticity", "-"),
}
SYMBOLS = {
    "hamaker": "A_H",
    "e_star": "E*",
    "h_macro": "H_macro",
    "h_prime": "H′",
    "q0": "q₀",
    "hurst": "Hurst",
    "rms": "RMS",
    "gap_cutoff": "D₀",
}
OUTPUTS = {  # shown name, unit shown, factor from the file's unit
    "d_c_nm": ("d_c", "nm", 1.0),
    "C_a_GPa_nm": ("C_a", "10⁻⁵ GPa/nm", 1e5),
    "C_r_GPa": ("C_r", "10⁻⁴ GPa", 1e4),
    "rho_r_nm": ("ρ_r", "nm", 1.0),
}
OUTPUTS |= {f"delta_{name}": (f"δ{symbol}", unit, factor) for name, (symbol, unit, factor) in OUTPUTS.items()}


def nominal_models(results: Results) -> str | None:
    """Figure 4: the three models of plasticity up to 1e4 nN."""
    groups, _, facts = results.h5("curves/nominal.h5")
    present = [model for model in MODELS if f"{model}/closing" in groups]
    if not present:
        return None
    top = max(float(facts[model]["max_force_nN"]) for model in present) / 1e3

    def plot(axis):
        for model in present:
            label, style = MODELS[model]
            for branch, color in (("closing", BLUE), ("opening", ORANGE)):
                separation, force = _total(groups[f"{model}/{branch}"])
                if model != "plastic" and branch == "opening":
                    continue  # reversible: the same line
                name = label if model != "plastic" else f"{label}, {branch}"
                color = color if model == "plastic" else SOFT
                axis.plot(separation, force, style, color=color, label=name)
        axis.axhline(0, color=SOFT, linewidth=0.8)
        reach = float(facts[present[-1]]["first_contact_nm"])
        axis.set(xlim=(None, reach + 8), ylim=(-0.12 * top, 1.04 * top))
        axis.set(xlabel="mean separation (nm)", ylabel="force on 1 µm² (µN)")
        axis.legend()

    return draw("fig4", "Force against mean separation for three models of plasticity", plot)


def nominal_loads(results: Results) -> str | None:
    """Figure 11: cycles to various largest loads, with the fitted law as thin lines."""
    groups, attributes, facts = results.h5("curves/nominal.h5")
    loads = sorted({name.split("/")[0] for name in groups if name.startswith("load_")}, key=_load)
    if not loads:
        return None
    area = float(attributes["cell_area_nm2"])
    fits = results.csv("law/nominal.csv") if results.has("law/nominal.csv") else []
    constants = _constants(results)

    def plot(axis, zoom):
        for panel in (axis, zoom):
            for i, load in enumerate(loads):
                color = SERIES[i % len(SERIES)]
                for branch, style in (("closing", "-"), ("opening", "--")):
                    separation, force = _total(groups[f"{load}/{branch}"])
                    label = f"{_load(load) / 1e3:g} µN" if branch == "closing" else None
                    panel.plot(separation, force, style, color=color, label=label, linewidth=1.6)
                    row = _fit(fits, load, branch)
                    if row is not None:
                        h = np.linspace(separation.min(), separation.max(), 300)
                        law = area * law_pressure(h, row, number(facts[load]["hamaker"]), *constants) / 1e3
                        panel.plot(h, law, "-", color=INK, linewidth=0.6)
            panel.axhline(0, color=SOFT, linewidth=0.8)
            panel.set(xlabel="mean separation (nm)", ylabel="force on 1 µm² (µN)")
        contact = float(facts[loads[0]]["first_contact_nm"])
        highest = max(_load(load) for load in loads) / 1e3
        axis.set(xlim=(None, contact + 8), ylim=(-0.06 * highest, 1.03 * highest))
        zoom.set(xlim=(None, contact + 8), ylim=(-2.5, 7.5), title="near zero force")
        axis.set_title("full range")
        axis.legend(title="largest load", fontsize=8, title_fontsize=8)

    return draw("fig11", "Closing and opening curves up to several largest loads", plot, (9.4, 4.0), columns=2)


def law_band(results: Results) -> str:
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


def output_distributions(results: Results) -> str:
    """Closing parameters and their change, with the paper's mean and deviation."""
    samples = results.csv("uq/samples.csv")
    table = {row["output"]: row for row in results.csv("uq/outputs.csv")}
    names = [name for name in OUTPUTS if name in table]

    def plot(*axes):
        for axis, name in zip(axes, names, strict=False):
            symbol, unit, factor = OUTPUTS[name]
            base = name.removeprefix("delta_")
            values = column(samples, f"closing_{base}")
            if name.startswith("delta_"):
                values = column(samples, f"opening_{base}") - values
            values = values[np.isfinite(values)] * factor
            low, high = np.quantile(values, [0.002, 0.998])
            axis.hist(values, bins=50, range=(low, high), density=True, color=BLUE, alpha=0.55, linewidth=0)
            mean, dev = (number(table[name][f"paper_{key}"]) * factor for key in ("mean", "dev"))
            height = axis.get_ylim()[1]
            if np.isfinite(mean):
                axis.errorbar(mean, 1.08 * height, xerr=dev, fmt="D", color=ORANGE, markersize=4, capsize=3)
            own_mean, own_dev = (number(table[name][key]) * factor for key in ("mean", "dev"))
            axis.errorbar(own_mean, 1.2 * height, xerr=own_dev, fmt="o", color=BLUE, markersize=4, capsize=3)
            axis.set(ylim=(0, 1.3 * height), yticks=[], xlabel=f"{symbol} ({unit})")
            axis.grid(False)

    return draw(
        "table2fig",
        "Distributions of the eight outputs beside the paper's mean and deviation",
        plot,
        (9.4, 4.4),
        4,
        2,
    )


def sensitivity_bars(results: Results) -> str:
    """Table 3 as bars: elementary effects relative to the largest of each output, ours and the paper's."""
    rows = results.csv("uq/sensitivity.csv")
    names = [name for name in OUTPUTS if any(row["output"] == name for row in rows)]
    inputs = list(dict.fromkeys(row["input"] for row in rows))

    def plot(*axes):
        places = np.arange(len(inputs))
        for axis, name in zip(axes, names, strict=False):
            symbol, unit, factor = OUTPUTS[name]
            part = {row["input"]: row for row in rows if row["output"] == name}
            ours = np.array([number(part[key]["mu_star"]) for key in inputs]) * factor
            spread = np.array([number(part[key].get("mu_star_seed_sd")) for key in inputs]) * factor
            paper = np.array([number(part[key].get("paper_mu_star")) for key in inputs]) * factor
            bars = {"xerr": np.nan_to_num(spread), "error_kw": {"ecolor": SOFT, "elinewidth": 1}}
            axis.barh(places - 0.2, ours, 0.38, color=BLUE, label="here", **bars)
            axis.barh(places + 0.2, np.nan_to_num(paper), 0.38, color=ORANGE, label="paper")
            axis.set(title=f"{symbol} ({unit})", yticks=places, ylim=(len(inputs) - 0.5, -0.5))
            axis.set_yticklabels([SYMBOLS.get(key, key) for key in inputs])
            axis.grid(axis="y", visible=False)
            axis.set_xlim(left=0)
        axes[0].legend(fontsize=8)

    return draw("table3fig", "Elementary effects of each input on each output", plot, (9.8, 5.6), 4, 2, sharey=True)


def switch_path(results: Results) -> str:
    """Voltage against separation: folds of the switch with and without adhesion."""
    rows = results.csv("device/path.csv")

    def plot(axis, zoom):
        for case, color, label in (
            ("with_adhesion", BLUE, "with adhesion"),
            ("without_adhesion", ORANGE, "without adhesion"),
        ):
            for branch, style in (("closing", "-"), ("opening", "--")):
                part = [row for row in rows if row["case"] == case and row["branch"] == branch]
                s, w = column(part, "separation_nm"), column(part, "voltage_squared_V2")
                volts = np.where(w >= 0, np.sqrt(np.maximum(w, 0)), np.nan)
                if branch == "closing" and case == "with_adhesion":
                    axis.plot(s / 1e3, volts, color=color)
                zoom.plot(s, volts, style, color=color, label=f"{label}, {branch}")
        highest = axis.get_lines()[0].get_ydata()
        s = axis.get_lines()[0].get_xdata()
        away = s > 0.2
        axis.set(ylim=(0, 1.15 * np.nanmax(highest[away])), title="way down: the fold is pull-in")
        axis.set(xlabel="separation (µm)", ylabel="voltage at balance (V)")
        zoom.set(xlim=(0, 90), ylim=(0, 8), title="way up: the lowest point is release")
        zoom.set(xlabel="separation (nm)")
        zoom.legend(fontsize=8)

    return draw("path", "Voltage at balance against separation of the switch", plot, (9.4, 3.8), columns=2)


def release_distribution(results: Results) -> str:
    """Release voltage over the samples, with and without adhesion, and stiction against landed fraction."""
    rows = results.csv("device/release.csv")
    curve = results.csv("device/stiction.csv")
    chosen = number(results.json("device/switch.json")["switch"]["landed_fraction"])

    def plot(axis, other):
        volts = {
            case: column([row for row in rows if row["case"] == case], "release_V")
            for case in ("with_adhesion", "without_adhesion")
        }
        bins = np.linspace(0, max(np.nanquantile(volts["without_adhesion"], 0.999), 0.1), 45)
        for case, color, label in (
            ("without_adhesion", ORANGE, "without adhesion"),
            ("with_adhesion", BLUE, "with adhesion"),
        ):
            free = volts[case][volts[case] > 0]
            weights = np.full(free.size, 1 / max(volts[case].size, 1))
            axis.hist(free, bins=bins, weights=weights, color=color, alpha=0.5, label=label, linewidth=0)
        stuck = float(np.mean(volts["with_adhesion"] == 0))
        if stuck > 0:
            axis.bar(0, stuck, width=bins[1], align="edge", color=RED, label="stuck at 0 V")
            free_top = max(axis.get_ylim()[1] if stuck < 0.3 else 0, 0.15)
            if stuck > 2 * free_top:
                axis.set_ylim(0, free_top)
                axis.annotate(f"{stuck:.0%} stuck", (bins[1], free_top), va="top", ha="left", color=RED)
        axis.set(xlabel="release voltage (V)", ylabel="share of samples per bin")
        axis.legend(fontsize=8.5)
        fraction = column(curve, "landed_fraction")
        other.fill_between(fraction, column(curve, "low"), column(curve, "high"), color=PURPLE, alpha=0.2, linewidth=0)
        other.plot(fraction, column(curve, "stiction_probability"), color=PURPLE)
        other.axvline(chosen, color=SOFT, linestyle=":")
        other.annotate("this scene ", (chosen, 0.97), ha="right", va="top", color=SOFT, fontsize=9)
        other.set(xscale="log", ylim=(0, 1), xlabel="landed fraction of the electrode")
        other.set_ylabel("probability of stiction")

    return draw("release", "Release voltage and probability of stiction", plot, (9.4, 3.7), columns=2)


def validation_points(results: Results) -> str | None:
    """Response surfaces against independent runs: quantiles of both."""
    rows = [row for row in results.csv("uq/validation.csv") if row.get("q2")]
    if not rows:
        return None

    def plot(axis):
        places = np.arange(len(rows))
        q2 = column(rows, "q2")
        low, high = column(rows, "q2_low"), column(rows, "q2_high")
        axis.errorbar(np.maximum(q2, -1), places, xerr=[q2 - low, high - q2], fmt="o", color=GREEN, capsize=3)
        axis.axvline(1, color=SOFT, linewidth=0.8)
        axis.axvline(0, color=SKY, linewidth=0.8)
        labels = [OUTPUTS.get(row["output"], (row["output"],))[0] for row in rows]
        axis.set(yticks=places, ylim=(len(rows) - 0.5, -0.5), xlim=(-1.05, 1.05), xlabel="Q² on independent runs")
        axis.set_yticklabels(labels)

    return draw("validation", "Predictive quality of the response surfaces", plot, (5.2, 3.2))


def law_pressure(h: np.ndarray, row: Row, hamaker: float, rho_a: float, shield: float) -> np.ndarray:
    """Total pressure of a fitted row (GPa), eqs 10 to 13."""
    d_c, C_a, C_r, rho_r = (number(row[key]) for key in ("d_c_nm", "C_a_GPa_nm", "C_r_GPa", "rho_r_nm"))
    attraction = hamaker / (6 * np.pi * (np.maximum(h, 0) ** 3 + shield**3)) + C_a * np.maximum(d_c + rho_a - h, 0)
    return C_r * np.expm1(np.maximum(d_c - h, 0) / rho_r) - attraction


def _total(curve: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Separation (nm) and total force (µN)."""
    return curve["separation_nm"], (curve["repulsive_nN"] + curve["attractive_nN"]) / 1e3


def _load(name: str) -> float:
    return float(name.removeprefix("load_"))


def _fit(rows: list[Row], curve: str, branch: str) -> Row | None:
    for row in rows:
        if row["curve"] == curve and row["branch"] == branch and row["C_r_GPa"]:
            return row
    return None


def _constants(results: Results) -> tuple[float, float]:
    """rho_a and the shield of eq. 12 as this scene's fits used them."""
    if results.has("uq/surrogate.json"):
        law = results.json("uq/surrogate.json")["law"]
        return float(law["rho_a_nm"]), float(law["alpha_nm"])
    return 2.0, 2.0


def reading_of(results: Results) -> dict[str, object]:
    """The contact settings that a curve file was made with."""
    return json.loads(results.h5("curves/nominal.h5")[1]["contact"])
