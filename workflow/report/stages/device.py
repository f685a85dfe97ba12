"""The law in a switch: pull-in, release, stiction."""

from typing import Any

import numpy as np

from workflow.report.available import Results
from workflow.report.drawing import BLUE, ORANGE, PURPLE, RED, SOFT, draw
from workflow.report.numbers import column, number, show
from workflow.report.page import COMPUTED, Gate, Section, Table


def describe(results: Results) -> Section | None:
    """The switch, its release and its stiction."""
    if not results.has("device/switch.json", "device/release.csv", "device/stiction.csv"):
        return None
    switches = results.json("device/switch.json")
    switch = switches["switch"]
    section = Section(
        "device",
        "The law in a switch",
        "An electrostatic switch that lands on the rough dielectric: closing law on the way down, "
        f"opening law on the way up; stiffness {show(switch['spring_N_per_m'])} N/m, gap "
        f"{show(switch['gap_nm'] / 1e3)} µm. It lands flat, and {switch['last_share']:.2%} of it come off last.",
        COMPUTED,
    )
    section.add(
        release_distribution(results),
        "Left: release voltage over the samples of the law. Right: probability that the switch stays closed at 0 V.",
        wide=True,
    )
    section.blocks.append(
        Table("The switch", ("quantity", "with adhesion", "without adhesion"), _switch_lines(switches))
    )
    without = switches["samples"]["used"] - switches["with_adhesion"]["pull_in_V"]["samples"]
    if without:
        section.notes.append(
            f"{without} of {switches['samples']['used']} samples have no pull-in voltage: the switch closes without "
            "snapping, as contact begins before the fold."
        )
    section.notes += [
        f"{switches['samples']['dropped']} of {switches['samples']['dropped'] + switches['samples']['used']} "
        "samples of the law were left out because their repulsion or adhesion had the wrong sign (a "
        "limit of the response).",
        "Numerical folds against the analytic ones without adhesion: relative error "
        f"{show(switches['checks']['pull_in_relative_error'], 2)} (pull-in), "
        f"{show(switches['checks']['release_relative_error'], 2)} (release).",
    ]
    section.files += ["device/switch.json", "device/law.csv", "device/law.json"]
    section.files += ["device/asperity_contact.sub", "device/asperity_contact.va"]
    section.gates.append(_gate(switches))
    return section


def _switch_lines(switches: dict[str, Any]) -> list[tuple[str, ...]]:
    cases = [switches["with_adhesion"], switches["without_adhesion"]]

    def spread(case: dict[str, Any], key: str) -> str:
        quantiles = case[key]["quantiles"]
        if not quantiles:
            return "–"
        return f"{show(quantiles['0.5'])} [{show(quantiles['0.05'])}, {show(quantiles['0.95'])}]"

    def stiction(case: dict[str, Any]) -> str:
        p = case["stiction_probability"]
        return f"{p['value']:.3f} [{p['low']:.3f}, {p['high']:.3f}]"

    lines = [
        ("pull-in (V), median and 5 to 95 %", *(spread(case, "pull_in_V") for case in cases)),
        ("release (V) of those that release", *(spread(case, "release_V") for case in cases)),
        ("probability of stiction, 95 % interval", *(stiction(case) for case in cases)),
        ("share in contact beyond which it sticks", *(spread(case, "critical_share") for case in cases)),
        ("separation held closed (nm)", *(spread(case, "hold_nm") for case in cases)),
        ("pressure held closed (MPa)", *(spread(case, "hold_pressure_MPa") for case in cases)),
    ]
    capacitance = switches["capacitance_fF"]
    up = show(capacitance["up"], 4)
    down = {key: spread(capacitance, key) for key in ("down_plate", "down_rough")}
    return [
        *lines,
        ("capacitance open (fF)", up, up),
        ("capacitance closed, rough (fF)", down["down_rough"], "–"),
        ("capacitance closed, flat plate (fF)", down["down_plate"], "–"),
    ]


def release_distribution(results: Results) -> str:
    """Release voltage over the samples, with and without adhesion, and stiction against the share in contact."""
    rows = results.csv("device/release.csv")
    curve = results.csv("device/stiction.csv")
    chosen = number(results.json("device/switch.json")["switch"]["last_share"])

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
                axis.annotate(f" {stuck:.0%} stuck", (bins[1], free_top), va="top", ha="left", color=RED)
        axis.set(xlabel="release voltage (V)", ylabel="share of samples per bin")
        axis.legend()
        fraction = column(curve, "share")
        other.fill_between(fraction, column(curve, "low"), column(curve, "high"), color=PURPLE, alpha=0.2, linewidth=0)
        other.plot(fraction, column(curve, "stiction_probability"), color=PURPLE)
        other.axvline(chosen, color=SOFT, linestyle=":")
        other.annotate("this scene  ", (chosen, 0.5), ha="right", va="top", color=SOFT, fontsize=9)
        other.set(xscale="log", ylim=(0, 1), xlabel="share of the electrode in contact")
        other.set_ylabel("probability of stiction")

    return draw("release", "Release voltage and probability of stiction", plot, (9.4, 3.7), columns=2)


def _gate(switches: dict[str, Any]) -> Gate:
    errors = switches["checks"].items()
    off = [f"{name.replace('_', ' ')} {show(value)}" for name, value in errors if not number(value) < 1e-6]
    return Gate("device", not off, (*off, *switches["warnings"]))
