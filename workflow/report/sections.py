"""The page's sections, one per stage that has results."""

from typing import Any

import numpy as np

from workflow.report import figures_contact as contact
from workflow.report.available import Results, Row, number, show
from workflow.report.beyond import coupling, history
from workflow.report.figures_contact import OUTPUTS, SYMBOLS
from workflow.report.page import COMPUTED, Section, Table
from workflow.report.sources import elastic, hardness, topography
from workflow.report.studies import studies


def all_sections(results: Results) -> list[Section]:
    """Every section whose results exist, in the order of the data's flow."""
    builders = (
        (("inputs.csv",), inputs),
        (("hardness/points.csv",), hardness),
        (("elastic/bulk_moduli.csv", "elastic/e_star.json"), elastic),
        (("topography/spectra.h5", "topography/parameters.json"), topography),
        (("curves/nominal.h5",), curves),
        (("uq/outputs.csv", "uq/samples.csv"), uncertainty),
        (("uq/sensitivity.csv",), sensitivity),
        (("device/switch.json", "device/release.csv", "device/path.csv", "device/stiction.csv"), device),
        (("history/cycles.csv", "history/dwell.csv", "history/curves.h5"), history),
        (("coupling/comparison.csv",), coupling),
    )
    sections = [build(results) for needs, build in builders if results.has(*needs)]
    return sections + studies(results)


def inputs(results: Results) -> Section:
    """Table 1 in use."""
    rows = results.csv("inputs.csv")
    section = Section(
        "inputs",
        "Inputs",
        "What the contact model is fed with: each input with its distribution and where it comes from.",
    )
    lines = [
        (
            SYMBOLS.get(row["parameter"], row["parameter"]),
            row["unit"],
            _distribution(row),
            row["origin"],
            row.get("file", ""),
        )
        for row in rows
    ]
    section.blocks.append(
        Table(
            "Inputs in use (the paper's Table 1)",
            ("input", "unit", "distribution", "origin", "source"),
            lines,
        )
    )
    section.files.append("inputs.csv")
    return section


def curves(results: Results) -> Section:
    """Figures 4 and 11."""
    reading = contact.reading_of(results)
    section = Section(
        "curves",
        "Contact curves at central inputs",
        f"Closing and opening of one surface of {reading['length_nm']:g} nm with {reading['pixels']}² "
        "grid points at central inputs.",
        COMPUTED,
    )
    section.add(
        contact.nominal_models(results),
        "Three models of the single asperity. Elastic and non-linear elastic contacts reopen along their "
        "closing line; plastic ones do not.",
        "Figure 4",
    )
    section.add(
        contact.nominal_loads(results),
        "Closing (solid) and opening (dashed) up to several largest loads; thin lines: the fitted law.",
        "Figure 11",
        wide=True,
    )
    words = {
        "convention": "slope convention",
        "prefactor": "Hertz prefactor",
        "radius": "asperity radius",
        "area": "contact area",
        "touching_attracts": "sites in contact attract",
        "flow": "flow rule",
        "flow_pair": "pair of Gaussians",
        "gap_cutoff_nm": "smallest gap of the attraction (nm)",
    }
    used = [
        (label, ("no", "yes")[value] if isinstance(value := reading[key], bool) else str(value))
        for key, label in words.items()
        if key in reading
    ]
    if used:
        section.blocks.append(Table("Readings of the paper in use", ("reading", "value"), used))
    section.files += ["curves/nominal.h5", "law/nominal.csv"]
    return section


def uncertainty(results: Results) -> Section:
    """Table 2."""
    rows = {row["output"]: row for row in results.csv("uq/outputs.csv")}
    section = Section(
        "uncertainty",
        "Uncertainty of the law",
        "The distributions of the inputs sent through response surfaces of the contact model, beside the "
        "paper's Table 2.",
        COMPUTED,
    )
    lines = []
    for name, (symbol, unit, factor) in OUTPUTS.items():
        if name not in rows:
            continue
        row = rows[name]
        values = {key: number(row.get(key)) * factor for key in row if key not in ("output", "unit")}
        exchanged = ""
        if values.get("paper_mean_exchanged", values["paper_mean"]) != values["paper_mean"]:
            exchanged = f"{show(values['paper_mean_exchanged'])} ± {show(values['paper_dev_exchanged'])}"
        lines.append(
            (
                f"{symbol} ({unit})",
                f"{show(values['mean'])} ± {show(values['dev'])}",
                f"{show(values['paper_mean'])} ± {show(values['paper_dev'])}",
                exchanged or "–",
                show(number(row.get("mean_difference_in_seed_sd"))),
                show(values.get("centre")),
                show(values.get("centre_seed_sd")),
                f"{number(row.get('seed_share')):.0%}" if np.isfinite(number(row.get("seed_share"))) else "–",
            )
        )
    header = (
        "output",
        "here (mean ± dev)",
        "paper",
        "paper, labels exchanged",
        "mean less the paper's, in scatters of one surface",
        "at central inputs",
        "its scatter over surfaces",
        "surface's share of variance",
    )
    section.blocks.append(
        Table("Law parameters on closing and their change on opening (the paper's Table 2)", header, lines)
    )
    section.add(
        contact.output_distributions(results),
        "Distributions of the outputs; circles: mean and deviation here, diamonds: in the paper.",
        "Table 2",
        wide=True,
    )
    if results.has("uq/ratios.csv") and results.csv("uq/ratios.csv"):
        header = ("quantity", "from", "here", "scatter of one surface", "paper")
        keys = ("value", "seed_sd", "paper")
        ratios = [
            (row["quantity"], row["from"], *(show(number(row[key])) for key in keys))
            for row in results.csv("uq/ratios.csv")
        ]
        section.blocks.append(Table("Numbers per RMS roughness", header, ratios))
        section.files.append("uq/ratios.csv")
        section.notes.append(
            "The readings of the contact model and the definition of d_c were chosen by their nearness to the paper's "
            "Tables 2 and 3 (reproduction audit), so that part of the agreement is built in."
        )
    if results.has("uq/validation.csv"):
        section.add(
            contact.validation_points(results),
            "How well the response surfaces predict independent runs: 1 is perfect, 0 no better than the mean.",
        )
        section.files.append("uq/validation.csv")
    section.files += ["uq/outputs.csv", "uq/samples.csv", "uq/surrogate.json"]
    return section


def sensitivity(results: Results) -> Section:
    """Table 3."""
    rows = results.csv("uq/sensitivity.csv")
    names = list(dict.fromkeys(row["input"] for row in rows))
    section = Section(
        "sensitivity",
        "What matters",
        "Mean elementary effect µ* of every input over its full range, beside the paper's Table 3.",
        COMPUTED,
    )
    outputs = [name for name in OUTPUTS if any(row["output"] == name for row in rows)]
    part = {(row["output"], row["input"]): row for row in rows}
    lines = []
    for name in names:
        cells = [SYMBOLS.get(name, name)]
        for output in outputs:
            factor = OUTPUTS[output][2]
            row = part.get((output, name), {})
            ours, paper = number(row.get("mu_star")) * factor, number(row.get("paper_mu_star")) * factor
            cells.append(f"{show(ours, 2)} ({show(paper, 2)})")
        lines.append(cells)
    header = ("input", *(f"{OUTPUTS[name][0]} ({OUTPUTS[name][1]})" for name in outputs))
    section.blocks.append(Table("Elementary effects µ* here (and in the paper)", header, lines))
    section.add(
        contact.sensitivity_bars(results),
        "The same as bars; lines: scatter over surfaces.",
        "Table 3",
        wide=True,
    )
    section.notes.append(
        "For the closing columns C_a and C_r the paper's Table 3 is read with its two labels exchanged, "
        "the only reading consistent with its Table 2."
    )
    section.files.append("uq/sensitivity.csv")
    return section


def device(results: Results) -> Section:
    """Pull-in, release, stiction."""
    found = results.json("device/switch.json")
    switch = found["switch"]
    section = Section(
        "device",
        "The law in a switch",
        "An electrostatic switch that lands on the rough dielectric: closing law on the way down, "
        f"opening law on the way up; stiffness {show(switch['spring_N_per_m'])} N/m, gap "
        f"{show(switch['gap_nm'] / 1e3)} µm, landed fraction {switch['landed_fraction']:g}.",
        COMPUTED,
    )
    section.add(
        contact.release_distribution(results),
        "Left: release voltage over the samples of the law. Right: probability that the switch stays closed at 0 V.",
        wide=True,
    )
    section.add(
        contact.switch_path(results),
        "Voltage at which the switch is in balance, from the law at central inputs.",
        wide=True,
    )
    section.blocks.append(Table("The switch", ("quantity", "with adhesion", "without adhesion"), _switch_lines(found)))
    section.notes += [
        f"{found['samples']['dropped']} of {found['samples']['dropped'] + found['samples']['used']} "
        "samples of the law were left out because their repulsion or adhesion had the wrong sign (a "
        "limit of the response surface).",
        "Numerical folds against the analytic ones without adhesion: relative error "
        f"{show(found['checks']['pull_in_relative_error'], 2)} (pull-in), "
        f"{show(found['checks']['release_relative_error'], 2)} (release).",
    ]
    section.files += ["device/switch.json", "device/law.csv", "device/law.json"]
    section.files += ["device/asperity_contact.sub", "device/asperity_contact.va"]
    return section


def _switch_lines(found: dict[str, Any]) -> list[tuple[str, ...]]:
    cases = [found["with_adhesion"], found["without_adhesion"]]

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
        ("critical landed fraction", *(spread(case, "critical_landed_fraction") for case in cases)),
        ("separation held closed (nm)", *(spread(case, "hold_nm") for case in cases)),
        ("pressure on the landed part (MPa)", *(spread(case, "hold_pressure_MPa") for case in cases)),
    ]
    capacitance = found["capacitance_fF"]
    up = show(capacitance["up"], 4)
    down = {key: spread(capacitance, key) for key in ("down_plate", "down_rough")}
    return [
        *lines,
        ("capacitance open (fF)", up, up),
        ("capacitance closed, rough (fF)", down["down_rough"], "–"),
        ("capacitance closed, flat plate (fF)", down["down_plate"], "–"),
    ]


def _distribution(row: Row) -> str:
    a, b = f"{number(row['a']):.4g}", f"{number(row['b']):.4g}"
    if row["distribution"] == "uniform":
        return f"uniform from {a} to {b}"
    text = f"normal, {a} ± {b}"
    if row["distribution"] == "truncated_normal":
        text += f" within {show(row.get('low'))} to {show(row.get('high'))}"
    return text
