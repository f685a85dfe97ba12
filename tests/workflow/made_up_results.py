"""Small made-up result files of every stage, in the formats that the stages write."""

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from mesoscale.studies.answer_stability import published_beam
from workflow.files.results import Dataset, write_csv, write_h5, write_json, write_text
from workflow.schemas import schema_of

INPUTS = {  # name: unit, distribution, a, b, origin
    "hamaker": ("1e-18 J", "uniform", 0.18, 0.25, "literature"),
    "e_star": ("GPa", "normal", 91.0, 3.8, "elastic"),
    "h_macro": ("GPa", "uniform", 0.7, 3.2, "literature"),
    "h_prime": ("GPa nm^0.5", "uniform", 1.95, 14.8, "hardness"),
    "q0": ("1/nm", "uniform", 0.015, 0.035, "topography"),
    "hurst": ("1", "uniform", 0.5, 1.0, "topography"),
    "rms": ("nm", "uniform", 2.0, 15.0, "topography"),
}
LAW = {"d_c_nm": 31.8, "C_a_GPa_nm": 15e-5, "C_r_GPa": 6.4e-4, "rho_r_nm": 3.31}
OPENED = {"d_c_nm": 28.5, "C_a_GPa_nm": 20e-5, "C_r_GPa": 9.2e-4, "rho_r_nm": 2.67}
DOUBT = "the response explains 10% of what the inputs explain"
PROVENANCE = {"rule": "made_up", "inputs_hash": "0", "versions": {}}


def write_all(root: Path) -> list[Path]:
    """Write results of every stage under `root` and name the files."""
    scene = "scene: {device: {}, contact: {length_nm: 1000.0}}"
    write_text(root / "scene.yaml", f"{scene}\nversions: {{numpy: '2.4'}}\ngit_commit: abc\n")
    _inputs(root)
    _curves(root)
    _uncertainty(root)
    _law_band(root)
    _pad(root)
    _hardness(root)
    _elastic(root)
    _topography(root)
    _history(root)
    _failure(root)
    _calibration(root)
    _studies(root)
    return sorted(path for path in root.rglob("*") if path.is_file())


PLAIN = {"number": 1.0, "integer": 1, "boolean": True, "text": "made up"}


def _write(path: Path, rows: Iterable[Mapping[str, Any]]) -> None:
    """Write a table; what its rows leave out is filled in by the schema."""
    schema = schema_of(path)
    assert schema is not None, path
    needed = [column for column in schema.columns if not column.optional]
    plain = {column.name: "" if column.empty else PLAIN[column.type] for column in needed}
    write_csv(path, [{**plain, **row} for row in rows])


def _inputs(root: Path) -> None:
    _write(
        root / "inputs.csv",
        [
            {
                "parameter": name,
                "unit": unit,
                "distribution": kind,
                "a": a,
                "b": b,
                "origin": origin,
                "varies": "common",
            }
            for name, (unit, kind, a, b, origin) in INPUTS.items()
        ],
    )


def _curves(root: Path) -> None:
    h = np.linspace(20, 45, 30)
    groups, facts = {}, {}
    for name in ("elastic", "nonlinear", "plastic", "load_1000", "load_7000"):
        central = {
            name: (a + b) / 2 if kind == "uniform" else a
            for name, (_, kind, a, b, _) in INPUTS.items()
        }
        facts[name] = {
            "max_force_nN": 7000.0,
            "first_contact_nm": 40.0,
            "converged": True,
            **central,
        }
        for branch in ("closing", "opening"):
            force = 7000 * np.exp(-(h - 20) / 3)
            groups[f"{name}/{branch}"] = {
                "separation_nm": Dataset(h, "nm", "mean separation", ("point",)),
                "repulsive_nN": Dataset(force, "nN", "repulsion", ("point",)),
                "attractive_nN": Dataset(-0.05 * force, "nN", "attraction", ("point",)),
                "contact_area_nm2": Dataset(
                    0.3 * force, "nm^2", "area of contacting sites", ("point",)
                ),
                "asperities": Dataset(np.full(h.size, 9), "1", "asperities", ("point",)),
                "sweeps": Dataset(np.ones(h.size, int), "1", "flow sweeps", ("point",)),
            }
    contact = {
        "length_nm": 1000.0,
        "pixels": 128,
        "reading": {"convention": "areal", "touching_attracts": False},
    }
    write_h5(
        root / "contact/nominal.h5",
        groups,
        {"cell_area_nm2": 1e6, "contact": contact},
        PROVENANCE,
        facts,
    )
    heights = np.add.outer(np.sin(np.arange(16)), np.cos(np.arange(16)))
    spots = {
        "towards_flat_nm": Dataset(heights, "nm", "height towards the flat", ("x", "y")),
        "step": Dataset(
            np.digitize(-heights, [-1.5, -1.0, -0.5]) - 1, "1", "first step reached", ("x", "y")
        ),
        "separation_nm": Dataset(
            np.array([40.0, 30.0, 20.0]), "nm", "mean separation of the step", ("number",)
        ),
        "repulsive_nN": Dataset(
            np.array([10.0, 500.0, 7000.0]), "nN", "repulsive force", ("number",)
        ),
        "asperities": Dataset(np.array([1, 5, 9]), "1", "asperities in contact", ("number",)),
        "cut_share": Dataset(np.array([0.01, 0.1, 0.3]), "1", "share of the area", ("number",)),
    }
    write_h5(root / "contact/spots.h5", {"spots": spots}, {"length_nm": 1000.0}, PROVENANCE)
    fits = [
        {"branch": branch, **law, "residual": 0.2, "status": "ok"}
        for branch, law in (("closing", LAW), ("opening", OPENED))
    ]
    run = {"run": 0, "node": 0, "seed": 0, "hamaker": 0.215}
    _write(
        root / "law/parameters.csv",
        [run | fit for fit in (*fits, {**fits[1], "status": "poor_fit"})],
    )
    _write(root / "law/nominal.csv", [{"curve": "load_7000", **fit} for fit in fits])


def _uncertainty(root: Path) -> None:
    rng = np.random.default_rng(0)
    rms = rng.uniform(2, 15, 200)
    samples = {name: np.full(200, 1.0) for name in INPUTS} | {
        "rms": rms,
        "hamaker": np.full(200, 0.215),
    }
    for branch, law in (("closing", LAW), ("opening", OPENED)):
        for name, value in law.items():
            samples[f"{branch}_{name}"] = value * (
                rms / 8.5 if name.endswith("_nm") else np.ones(200)
            )
    rows = [dict(zip(samples, line, strict=True)) for line in zip(*samples.values(), strict=True)]
    _write(root / "uncertainty/samples.csv", rows)
    outputs = [*LAW, *(f"delta_{name}" for name in LAW)]
    values = [*LAW.values(), *(OPENED[name] - LAW[name] for name in LAW)]
    _write(
        root / "uncertainty/outputs.csv",
        [
            {
                "output": name,
                "unit": "nm",
                "mean": value,
                "dev": abs(value) / 2,
                "paper_mean_exchanged": value,
                "paper_dev_exchanged": abs(value) / 3,
                "centre": value,
                "centre_seed_sd": abs(value) / 9,
                "response_mean": value,
                "response_dev": abs(value) / 2,
                "response_q05": value / 2,
                "response_q50": value,
                "response_q95": 2 * value,
                "paper_mean": value,
                "paper_dev": abs(value) / 3,
                "seed_share": 0.1,
            }
            for name, value in zip(outputs, values, strict=True)
        ],
    )
    _write(
        root / "uncertainty/sensitivity.csv",
        [
            {
                "output": output,
                "input": name,
                "mu_star": i,
                "paper_mu_star": i,
                "sobol_total": i / 21,
            }
            for output in outputs
            for i, name in enumerate(INPUTS)
        ],
    )
    _write(
        root / "uncertainty/validation.csv",
        [
            {
                "output": name,
                "runs": 50,
                "missing": 0,
                "q2": 0.9,
                "q2_low": 0.8,
                "q2_high": 0.95,
                "explained": 0.95,
            }
            | ({"explained": 0.1, "doubt": DOUBT} if name == "C_r_GPa" else {})
            for name in outputs
        ],
    )
    responses = [
        _response(branch, name, value)
        for branch, law in (("closing", LAW), ("opening", OPENED))
        for name, value in law.items()
    ]
    inputs = [
        {
            "name": name,
            "unit": unit,
            "low": a if kind == "uniform" else a - 4 * b,
            "high": b if kind == "uniform" else a + 4 * b,
        }
        for name, (unit, kind, a, b, _) in INPUTS.items()
    ]
    content = {
        "inputs": inputs,
        "outputs": responses,
        "law": {"rho_a_nm": 2.0, "alpha_nm": 2.0, "most_GPa": 0.007},
    }
    write_json(root / "uncertainty/surrogate.json", content, PROVENANCE)


def _response(branch: str, name: str, value: float) -> dict[str, Any]:
    """An output that every input moves, of each kind that the format has; `value` in the middle of
    the ranges.
    """
    terms = {(0,) * 7: 1.0, (0, 1, 0, 0, 0, 0, 1): 0.03, (0, 0, 0, 0, 0, 3, 0): 0.04}
    terms |= {tuple(int(k == number) for k in range(7)): 0.01 * (number + 1) for number in range(6)}
    terms[0, 0, 0, 0, 0, 0, 1] = 0.5 if name == "d_c_nm" else 0.0
    if name == "rho_r_nm":
        kind = {"transform": "log"}
        scaled = {
            degrees: share if any(degrees) else math.log(value) for degrees, share in terms.items()
        }
    elif (branch, name) == ("opening", "d_c_nm"):
        kind = {"transform": "log", "below": "closing_d_c_nm"}
        drop = math.log(LAW[name] - value)
        scaled = {degrees: share if any(degrees) else drop for degrees, share in terms.items()}
    else:
        kind = {"transform": "identity"}
        scaled = {degrees: share * value for degrees, share in terms.items()}
    listed = [
        {"degrees": list(degrees), "coefficient": number} for degrees, number in scaled.items()
    ]
    return {"name": f"{branch}_{name}", **kind, "terms": listed}


def _law_band(root: Path) -> None:
    from mesoscale.law.samples import band_rows
    from workflow.files.results import load_numbers

    rows = load_numbers(root / "uncertainty/samples.csv")
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    _write(root / "uncertainty/law.csv", band_rows(columns))


def _pad(root: Path) -> None:

    from asperity.guards.bundle import ROOT
    from asperity.guards.foreign_yaml import load_mapping
    from evidence.pad.closed_form import ClosedForm
    from mesoscale.answer.budget import budget, effects_of
    from mesoscale.answer.points import Design, Point
    from mesoscale.answer.release import switch_on_pad
    from mesoscale.answer.reserve import central_reserve
    from mesoscale.answer.switches import PadModel, Solved
    from mesoscale.pad.curves import Flats
    from mesoscale.pad.grid import PadGrid
    from mesoscale.pad.pressed import Pad, curve_rows
    from mesoscale.switch import switch_of

    area, flats = 1e6, Flats(0.215, 0.165)
    separation = np.concatenate([np.geomspace(200, 50, 8)[:-1], np.arange(50, 19.9, -0.25)])
    grid = PadGrid(separation, np.arange(separation.size)[-61::12])
    form = ClosedForm(
        -5.0, 0.15, 0.006, 0.3, 0.01, 0.02, 0.05, 1.0, 0.5, 0.0, flats.hamaker, flats.offset_nm
    )
    shifts = np.random.default_rng(5).normal(0, 1.5, 24)
    closing = np.array([form.closing_GPa(separation + shift) for shift in shifts])
    opening = np.array(
        [
            [form.opening_GPa(separation + shift, depth + shift) for depth in grid.depth_nm]
            for shift in shifts
        ]
    )
    for number, depth in enumerate(grid.depth_nm):
        opening[:, number, :, separation < depth] = np.nan
    settled = np.ones(24, bool)
    pad = Pad(grid, np.full(24, 1 / 24), np.ones(24), 40 - shifts, closing, opening, settled, flats)
    _write(root / "pad/curves.csv", curve_rows(pad))
    states = switch_of(published_beam()).states(pad.curves)
    central = Solved(
        Point({}, 0.165, published_beam()), pad, states, (states.release_V, states.release_V)
    )
    model = PadModel(central, Design((), (), np.empty((0, 0)), np.arange(0), ()), ())
    switch = switch_on_pad(model, area) | {"reserve": central_reserve(central)}
    write_json(root / "answer/pad_switch.json", switch, PROVENANCE)
    shipped = load_mapping(ROOT / "config" / "effects.yaml", "table of effects")
    _write(
        root / "answer/budget.csv",
        budget(effects_of(shipped), switch, central, {1.0: 7.0, 0.5: 5.0, 1.37: 7.3, 1.36: 7.2}),
    )


def _hardness(root: Path) -> None:
    points = []
    for scale in (1.0, 0.5):
        run = f"small_{scale:g}"
        length = np.linspace(0.5, 4, 20)
        _write(
            root / f"hardness/closing/{run}.csv",
            [
                {"contact_length_nm": x, "contact_stress_GPa": 10 * scale * min(x / 2, 1)}
                for x in length
            ],
        )
        points.append(
            {
                "run": run,
                "energy_scale": scale,
                "wavelength_nm": 5.8,
                "status": "yield",
                "contact_length_nm": 3.0,
                "hardness_GPa": 10 * scale,
                "hardness_lo": 9 * scale,
                "hardness_hi": 11 * scale,
                "onset_displacement_nm": 0.2,
                "onset_length_nm": 2.0,
                "exchanges_before": 2,
                "exchanges_at_onset": 11,
                "exchanges_after": 30,
                "onset_p_value": 0.001,
            }
        )
        steps = (100, 200, 300)
        _write(
            root / f"hardness/witness/{run}.csv",
            [
                {"step": step, "displacement_nm": step / 1000, "exchanged_bonds": step // 10}
                for step in steps
            ],
        )
    _write(root / "hardness/points.csv", points)
    fit = {
        "method": "literature",
        "gate": {"passed": False, "reasons": ["only 2 of 9 runs <gave> a hardness"]},
        "H_macro_GPa": {"median": 1.9, "low": 1.1, "high": 2.8},
        "hardness_GPa": {
            way: {"median": 9.0, "low": 8.0, "high": 10.0} for way in ("measured", "scales")
        },
        "twins": [
            {"energy_scale": 0.5, "pairs": 1, "ratio": {"median": 0.5, "low": 0.44, "high": 0.57}}
        ],
        "free_fit": {
            "H_macro_GPa": {"mean": 10.0, "low": 7.0, "high": 13.0},
            "H_prime_GPa_nm0.5": {"mean": 0.1, "low": -6.0, "high": 4.0},
            "verdict": "6 runs do not tell H_prime from zero",
        },
        "curve": [
            {"contact_length_nm": x, "low_GPa": 5, "median_GPa": 7, "high_GPa": 9}
            for x in (2.0, 10.0)
        ],
        "film": {
            "base_GPa": {"low": 4, "median": 5, "high": 6},
            "left_out": {"film": 0.08, "paper": 0.2, "constant": 0.21},
            "length_over_thickness": [1.1, 5.6],
        },
    }
    write_json(root / "hardness/fit.json", fit, PROVENANCE)


def _elastic(root: Path) -> None:
    _write(
        root / "elastic/bulk_moduli.csv",
        [
            {
                "structure": f"a{i:02d}" if i else "beta",
                "xc": xc,
                "ions": "clamped",
                "B_GPa": 150 + 5 * i,
                "B_prime": 4,
                "V0_A3": 300,
            }
            for i in range(4)
            for xc in ("gga", "lda")
        ],
    )
    _write(
        root / "elastic/points.csv",
        [
            {"structure": "beta", "xc": "gga", "ions": "clamped", "strain": x, "energy_eV": x * x}
            for x in np.linspace(-0.05, 0.05, 5)
        ],
    )
    gate = {"passed": True, "reasons": []}
    used = [f"a{i:02d}" for i in range(1, 4)]
    e_star = {
        "mean_GPa": 90.0,
        "std_GPa": 4.0,
        "structures_used": used,
        "notes": ["no broken <bonds>"],
        "gate": gate,
    }
    write_json(root / "elastic/e_star.json", e_star, PROVENANCE)
    values = Dataset(np.random.default_rng(1).normal(90, 4, 500), "GPa", "E*", ("sample",))
    write_h5(root / "elastic/e_star.h5", {"samples": {"e_star_GPa": values}}, {}, PROVENANCE)


def _topography(root: Path) -> None:
    q = np.geomspace(0.006, 3, 40)
    psd = 1e4 / (1 + (q / 0.02) ** 3)

    def curve(values, unit="nm^4"):
        return Dataset(values, unit, "made up", ("q",))

    heights = np.random.default_rng(2).normal(0, 3, (64, 64))
    groups = {
        "pooled": {"q": curve(q, "1/nm"), "psd": curve(psd)},
        "fits": {"q": curve(q, "1/nm"), "likelihood": curve(psd), "truth": curve(psd)},
        "scans/small_01": {
            "q": curve(q, "1/nm"),
            "psd": curve(1.2 * psd),
            "heights": Dataset(heights, "nm", "heights", ("x", "y")),
        },
    }
    facts = {
        "scans/small_01": {
            "length_x_nm": 1000.0,
            "rms_nm": 3.0,
            "trusted_low": 0.02,
            "trusted_high": 0.5,
        }
    }
    write_h5(root / "topography/spectra.h5", groups, {"synthetic": True}, PROVENANCE, facts)
    truth = {"q0": 0.021, "slope": 2.8, "rms_nm": 3.1}
    estimates = {
        name: {
            "value": v,
            "interval": [0.9 * v, 1.1 * v],
            "scatter": [0.5 * v, 2 * v],
            "unit": unit,
        }
        for name, v, unit in (("q0", 0.02, "1/nm"), ("slope", 2.9, "1"), ("rms", 3.0, "nm"))
    }
    scan = {"name": "small_01", "rms_heights_nm": 2.9}
    content = {
        "synthetic": True,
        "convention": "areal",
        "estimates": estimates,
        "truth": truth,
        "scans": [scan],
    }
    write_json(
        root / "topography/parameters.json",
        {**content, "gate": {"passed": True, "reasons": []}},
        PROVENANCE,
    )


def _history(root: Path) -> None:
    cycles, dwell = [], []
    for cycle in (1, 2):
        row = {
            "seed": 1,
            "cycle": cycle,
            "held_s": 10.0 * cycle,
            "closed_nm": 25.0 - cycle,
            "last_contact_nm": 29.0,
        }
        row |= {"contact_area_nm2": 1e3, "dissipated_nN_nm": 1e4 / cycle**6, "pull_off_nN": 300.0}
        cycles.append(row)
        for time in (0.0, 10.0):
            held = {
                "held_s": 10 * (cycle - 1) + time,
                "hardness_factor": 0.9,
                "separation_nm": 25.0 - cycle - time / 20,
            }
            dwell.append(
                {"seed": 1, "cycle": cycle, **held, "contact_area_nm2": 1e3, "asperities": 100}
            )
    _write(root / "history/cycles.csv", cycles)
    _write(root / "history/dwell.csv", dwell)


def _calibration(root: Path) -> None:
    prior = {"prior_q05": 2.0, "prior_q50": 8.0, "prior_q95": 14.0}
    after = {"posterior_q05": 4.5, "posterior_q50": 5.0, "posterior_q95": 5.5}
    names = [{"parameter": name, "unit": row[0]} for name, row in INPUTS.items()]
    _write(root / "calibration/summary.csv", [{**name, **prior, **after} for name in names])
    far = "contradicts what the other measurements and the prior lead to"
    curves = [
        {"quantity": f"{branch} separation", "unit": "nm", "force_nN": force, **prior, **after}
        for branch in ("closing", "opening")
        for force in (140.0, 700.0, 3500.0)
    ]
    _write(
        root / "calibration/predictive.csv",
        [*curves, {"quantity": "release", "unit": "V", "force_nN": "", **prior, **after}],
    )
    verdicts = {"pull_off": (0.5, "agrees"), "hardness": (0.0, far)}
    tables = {
        kind: {
            "rows": 20,
            "probability": share,
            "verdict": verdict,
            "source": "made up, no measurement",
        }
        for kind, (share, verdict) in verdicts.items()
    }
    chain = {"sampler": "emcee 3", "r_hat": 1.004, "independent_draws": 1700.0}
    content = {
        "gate": {"passed": True, "reasons": []},
        "remarks": [f"hardness (hardness.csv) {far}"],
        "chain": chain,
    }
    content |= {"cycles": 1700, "response_error_share": 0.45, "points_left_out": 3}
    write_json(root / "calibration/posterior.json", {**content, "tables": tables}, PROVENANCE)


def _studies(root: Path) -> None:
    rows = [
        {
            "stage": "contact",
            "case": case,
            "knob": "force steps",
            "value": steps,
            "shipped": steps == 40,
        }
        | {
            "error": worse / steps**2,
            "own_error": 0.1 * worse / steps**2,
            "unit": "%",
            "release_V": None,
        }
        | {
            "reference": "320 steps; 4 surfaces",
            "wall_s": 0.01 * steps,
            "cpu_s": 0.01 * steps,
            "peak_rss_MB": 300.0,
        }
        for case, worse in (("d_c", 100.0), ("C_r", 300.0))
        for steps in (5, 10, 20, 40)
    ]
    _write(root / "accuracy/contact.csv", rows)
    own = {
        "stage": "answer",
        "case": "release",
        "shipped": True,
        "own_error": None,
        "unit": "V",
        "cpu_s": 0.0,
    }
    errors = {"elements of the beam": 0.03, "sites a side": 0.04}
    finer = [
        {"knob": knob, "value": 128, "error": volts, "release_V": volts}
        for knob, volts in errors.items()
    ]
    _write(
        root / "answer/errors.csv", [{**own, **row, "reference": "twice as many"} for row in finer]
    )
    cases = [
        {"case": case, "passed": passed} for case, passed in (("flat", True), ("spikes", False))
    ]
    _write(root / "stability/contact.csv", cases)


def _failure(root: Path) -> None:
    failing = {
        "probability": 3e-5,
        "low": 2e-5,
        "high": 5e-5,
        "variation": 0.2,
        "by_response": 4e-5,
        "runs": 128,
    }
    rows = [
        {"hold_V": volts, "attraction": times, "failing": 1e-6 * times * volts, "failing_q95": 1e-3}
        for volts in (60.0, 80.0, 100.0)
        for times in (1 / 3, 1.0, 3.0)
    ]
    laws = [
        {
            "attraction": times,
            "failing": failing,
            "given_common": {
                q: {"value": share} for q, share in (("0.05", 0.0), ("0.5", 2e-8), ("0.95", 3e-4))
            },
            "sure": 0.7,
            "largest_hold_V": largest,
            "least_rms_nm": 7.0,
            "least_spring": None if largest is None else 3.9,
            "there": None,
        }
        for times, largest in ((1 / 3, 100.0), (1.0, 71.0), (3.0, None))
    ]
    rate = {
        "release_V": 0.0,
        "allowed": 1e-6,
        "confidence": 0.9,
        "hold_V": 70.0,
        "laws": laws,
        "switches": 160,
    }
    rate |= {"spring": "thickness_um"}
    control = [
        {"name": "rms", "failing_if_known": 1e-7},
        {"name": "hurst", "failing_if_known": 3e-5},
    ]
    write_json(
        root / "failure/failure.json",
        rate | {"control_attraction": 1.0, "control": control},
        PROVENANCE,
    )
    _write(root / "failure/failure.csv", rows)
    study = {
        "lumps": 24,
        "pull_in": 1e-4,
        "release": 3e-3,
        "capacitance": 0.01,
        "pull_in_V": 70.0,
        "release_V": 6.0,
    }
    study |= {"reference": 1e-3}
    write_json(root / "circuit/circuit.json", {"lumps": study}, PROVENANCE)
    switches = [
        {
            "switch": name,
            "deviations": 0.0 if name.startswith("draw") else 2.0,
            **dict.fromkeys(INPUTS, 1.0),
            "gap_cutoff_nm": 0.3,
            "bow_nm": 50.0,
            "pull_in_V": 70.0,
            "release_V": at,
        }
        for name, at in (
            ("fast", 6.0),
            ("slow", 6.1),
            ("sticky", 0.0),
            ("loose", 7.0),
            ("draw_01", 5.0),
        )
    ]
    _write(root / "circuit/circuit.csv", switches)
    ways = [f"{way}_{of}_fF" for way in ("up", "down") for of in ("central", "q05", "q95")]
    _write(
        root / "circuit/loop.csv",
        [{"voltage_V": v, **dict.fromkeys(ways, 160.0 + v)} for v in (0.0, 40.0, 77.0)],
    )
