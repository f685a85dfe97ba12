"""Sections of the stages behind the inputs: hardness, elastic modulus, topography."""

from typing import Any

import numpy as np

from workflow.report import figures_atoms as atoms
from workflow.report import figures_topography as scans
from workflow.report.available import Results, Row, number, show
from workflow.report.figures_contact import SYMBOLS
from workflow.report.page import COMPUTED, LITERATURE, SYNTHETIC, Section, Table


def hardness(results: Results) -> Section:
    """Figures 7 and 8."""
    points = results.csv("hardness/points.csv")
    fit = results.json("hardness/fit.json") if results.has("hardness/fit.json") else {}
    section = Section(
        "hardness",
        "Hardness of single asperities",
        "Molecular dynamics of one asperity pressed against a flat, with full and with halved energies; "
        "hardness is the contact stress beyond the onset of plastic flow.",
        _used(results, "hardness"),
    )
    section.add(
        atoms.contact_stress(results),
        "Contact stress against contact length of every closing run. Circles: where plastic flow was first witnessed "
        "by exchanged bonds; diamonds: the hardness of runs that yielded.",
        "Figure 7",
    )
    section.add(
        atoms.hardness_size(results),
        "Hardness against contact length. Grey: the range that the paper's Table 1 spans; crosses: the "
        "two values its text gives.",
        "Figure 8",
    )
    section.add(
        atoms.contact_pictures(results),
        "A slice of 0.5 nm through a contact, relaxed without the counterface; dark: cations, light: oxygen.",
        wide=True,
    )
    lines = [
        (
            row["run"],
            show(row.get("energy_scale")),
            row.get("geometry", ""),
            show(row.get("wavelength_nm")),
            show(row.get("contact_length_nm")),
            _range(row, "hardness"),
            " → ".join(show(row.get(key)) for key in ("exchanges_before", "exchanges_at_onset", "exchanges_after")),
            show(row.get("onset_p_value")),
            row.get("status", ""),
        )
        for row in points
    ]
    header = (
        "run", "energy scale", "geometry", "λ (nm)", "contact length (nm)", "hardness (GPa)",
        "bond exchanges per 0.1 nm: before → onset → after", "p of the onset", "status",
    )  # fmt: skip
    section.blocks.append(Table("Every run and what became of it", header, lines))
    section.notes += _fit_notes(fit)
    section.files += ["hardness/points.csv", "hardness/fit.json"]
    return section


def elastic(results: Results) -> Section:
    """Figure 5."""
    summary = results.json("elastic/e_star.json")
    section = Section(
        "elastic",
        "Effective elastic modulus",
        "Density functional theory on an ensemble of Si₃N₄ structures: E* = "
        f"{show(summary.get('mean_GPa'))} ± {show(summary.get('std_GPa'))} GPa (the paper: 91 ± 3.8 GPa).",
        _used(results, "elastic"),
    )
    section.add(
        atoms.elastic_distribution(results),
        "Left: bulk moduli of the glasses; dashed: a crystal. Right: the modulus E* of the contact, variability and "
        "model-form error included.",
        "Figure 5",
        wide=True,
    )
    if results.has("elastic/points.csv"):
        section.add(atoms.energy_volume(results), "Energy of every structure under isotropic strain.")
    lines = [
        (
            row["structure"],
            row["xc"],
            row.get("ions", ""),
            show(row.get("B_GPa"), 4),
            show(row.get("B_prime")),
            show(row.get("V0_A3"), 4),
            row.get("flags", "") or "–",
        )
        for row in results.csv("elastic/bulk_moduli.csv")
    ]
    header = ("structure", "functional", "ions", "B (GPa)", "B′", "V₀ (Å³)", "flags")
    section.blocks.append(Table("Equation of state of every structure", header, lines))
    section.notes += summary.get("notes", [])
    section.files += ["elastic/points.csv", "elastic/bulk_moduli.csv", "elastic/e_star.json"]
    return section


def topography(results: Results) -> Section:
    """Figures 9 and 10."""
    found = results.json("topography/parameters.json")
    synthetic = bool(found.get("synthetic"))
    section = Section(
        "topography",
        "Surface topography",
        (
            "The scans are synthetic: made by the workflow with known parameters, passed through a simulated "
            "microscope and read back from a real file format. They check the method; they are no "
            "measurement. "
            if synthetic
            else "Spectra of the measured scans. "
        )
        + f"The Hurst exponent follows the convention `{found['convention']}`.",
        SYNTHETIC if synthetic else _used(results, "topography"),
    )
    section.add(scans.scans(results), "Height maps after levelling, in nm about their mean.", "Figure 9", wide=True)
    section.add(
        scans.spectra(results),
        "Power spectra of all scans, pooled, with the fits behind q₀, Hurst exponent and RMS. The fits use the trusted "
        "part; grey is what levelling, tip, noise or pixels disturb.",
        "Figure 10",
    )
    section.add(
        scans.recovery(results),
        "What the analysis returns of the synthetic scans' known truth. The interval of the typical RMS holds the "
        "scatter from place to place: it is as wide as so few places make it. Heights miss what levelling took.",
    )
    section.add(
        scans.recovered_sets(results),
        f"Truth and {float(found.get('confidence', 0.9)):.0%} intervals of many sets of synthetic scans with random "
        "truth and artefacts.",
        wide=True,
    )
    paper = {"q0": "≈ 0.02", "hurst": "≈ 0.92 (0.46 to 1.20) by 2H + 1", "rms": "1.82 to 14.17", "slope": "2.84"}
    truth = found.get("truth") or {}
    lines = []
    for name, estimate in found.get("estimates", {}).items():
        true = truth.get(name, truth.get(f"{name}_nm"))
        lines.append(
            (
                SYMBOLS.get(name, name),
                str(estimate.get("unit", "")),
                show(estimate.get("value")),
                _pair(estimate.get("interval")),
                _pair(estimate.get("scatter")),
                show(true) if true is not None else "–",
                paper.get(name, "–"),
            )
        )
    if lines:
        header = ("parameter", "unit", "estimate", "interval", "scatter of scans", "truth", "paper")
        section.blocks.append(Table("Roughness parameters", header, lines))
    section.files += ["topography/spectra.h5", "topography/parameters.json"]
    if results.has("law/scans.csv"):
        section.add(
            scans.pressed(results),
            "The contact closed on the scans themselves, on Gaussian surfaces with each scan's own spectrum, and on "
            "Gaussian surfaces with the fitted power law up to the pixels; all with the grid and RMS of the scan.",
            wide=True,
        )
        header = ("scan", "surface", "d_c (nm)", "C_a (GPa/nm)", "C_r (GPa)", "ρ_r (nm)", "fit")
        keys = ("d_c_nm", "C_a_GPa_nm", "C_r_GPa", "rho_r_nm")
        closing = [row for row in results.csv("law/scans.csv") if row["branch"] == "closing"]
        lines = [
            (row["scan"], row["surface"], *(show(number(row[key])) for key in keys), row["status"]) for row in closing
        ]
        section.blocks.append(Table("Law of the measured scans, closing", header, lines))
        section.files += ["curves/scans.h5", "law/scans.csv"]
    return section


def _pair(pair: Any) -> str:
    return f"{show(pair[0])} to {show(pair[1])}" if isinstance(pair, list) and len(pair) == 2 else "–"


def _used(results: Results, stage: str) -> str:
    """Whether an input of this scene really comes from the stage."""
    rows = results.csv("inputs.csv") if results.has("inputs.csv") else []
    return COMPUTED if any(row["origin"] == stage for row in rows) else f"{COMPUTED}, not used: inputs are {LITERATURE}"


def _range(row: Row, name: str) -> str:
    value = number(row.get(f"{name}_GPa"))
    if not np.isfinite(value):
        return "–"
    low, high = number(row.get(f"{name}_lo")), number(row.get(f"{name}_hi"))
    return f"{show(value)} [{show(low)}, {show(high)}]" if np.isfinite(low) else show(value)


def _fit_notes(fit: dict[str, Any]) -> list[str]:
    """What the MD points say about both constants, and how the halved energies compare."""
    notes = []
    method = "from the literature" if fit.get("method") == "literature" else "from the same points"
    for key, label, unit in (("H_macro_GPa", "H_macro", "GPa"), ("H_prime_GPa_nm0.5", "H′", "GPa nm½")):
        entry = fit.get(key)
        if isinstance(entry, dict):
            origin = method if label == "H_macro" else "from the points"
            span = f"{show(entry['median'])} [{show(entry['low'])}, {show(entry['high'])}] {unit}"
            notes.append(f"{label} in use, {origin}: {span} (median and 68 % interval).")
    free = fit.get("free_fit", {}).get("together", {})
    if "H_macro_GPa" in free:
        pairs = [
            f"{label} = {show(free[key]['median'])} [{show(free[key]['low'])}, {show(free[key]['high'])}]"
            for key, label in (("H_macro_GPa", "H_macro"), ("H_prime_GPa_nm0.5", "H′"))
        ]
        word = "" if free.get("identifiable") else ": the points alone do not identify both"
        notes.append(f"Free fit of both constants to all points: {', '.join(pairs)}{word}.")
    for ratio in fit.get("halved_over_full", []):
        notes.append(
            f"Halved over full energies, asperity {ratio['asperity']}: {show(ratio['median'])} "
            f"[{show(ratio['low'])}, {show(ratio['high'])}]; 0.5 is expected."
        )
    if cost := fit.get("cost"):
        notes.append(
            f"Molecular dynamics: {show(cost['atom_steps'])} atom-steps, {show(cost['lammps_cpu_s'] / 60)} minutes of "
            f"CPU time; the Python around LAMMPS took {show(100 * cost['python_cpu_share'])} % of all."
        )
    return notes
