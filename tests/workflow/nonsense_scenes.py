"""Scenes that make no sense, each of which must be refused before anything runs, with part of the
words it gets.
"""

import itertools

from evidence.attacks.runs import scene


def _bomb() -> str:
    lines = ["a: &a [x,x,x,x,x,x,x,x,x]"]
    lines += [f"{b}: &{b} [{','.join([f'*{a}'] * 9)}]" for a, b in itertools.pairwise("abcdefghi")]
    return "\n".join(lines)


TWICE = "[{name: a, tiles: 2, amplitude_nm: 0.4}, {name: a, tiles: 3, amplitude_nm: 0.6}]"
CYCLIC = "{rms: {q0: 0.9, hurst: -0.9}, q0: {hurst: 0.9}}"
NONSENSE: dict[str, tuple[str, str]] = {
    "alias bomb": (_bomb(), "alias *a: write the value out"),
    "alias of itself": ("contact: &a {pixels: *a}", "alias *a"),
    "date as a key": ("2026-11-22: 3", "2026-11-22: unknown key"),
    "date as a number": ("contact: {pixels: 2026-11-22}", "accepted is an integer"),
    "merge key": ("contact:\n  <<: {pixels: 128}", "merge key"),
    "deep nesting": ("contact: " + 5000 * "[" + 5000 * "]", "nested deeper than 20 levels"),
    "name of 5000 characters": ("name: " + 5000 * "x", "name = "),
    "key of 5000 characters": ("? " + 5000 * "x" + "\n: 3", "unknown key"),
    "name with a path": ("name: ../../mine", "name = "),
    "name of a shipped scene": ("name: paper", "shipped scene"),
    "minutes as pixels": ("contact: {pixels: 16:40}", "accepted is an integer"),
    "octal pixels": ("contact: {pixels: 0200}", "accepted is an integer"),
    "text as pixels": ('contact: {pixels: "256"}', "accepted is an integer"),
    "infinite gap": ("device: {gap_um: .inf}", "accepted is a number"),
    "not a number": ("device: {gap_um: .nan}", "accepted is a number"),
    "key twice": ("contact: {pixels: 256, pixels: 512}", "stands twice"),
    "object of Python": ("x: !!python/object/apply:os.system ['true']", "plain values only"),
    "tag of an integer": ('contact: {pixels: !!int ""}', "plain values only"),
    "tag of a truth": ("contact: {pixels: !!bool x}", "plain values only"),
    "tag of nothing": ("contact: {pixels: ! 5}", "plain values only"),
    "fifty thousand values": ("x: [" + 60_000 * "1," + "]", "more than 50000 values"),
    "program as a key": ("hardness: {closing: {launcher: rm}}", "unknown key"),
    "negative RMS": (scene(rms="{values: [-2, 15]}"), "inputs.rms: spans -2 .. 15"),
    "RMS of a metre": (scene(rms="{distribution: fixed, values: [1.0e+9]}"), "inputs.rms: spans"),
    "RMS from high to low": (
        scene(rms="{values: [15, 2]}"),
        "the first must not exceed the second",
    ),
    "normal RMS below zero": (
        scene(rms="{distribution: normal, values: [2, 2]}"),
        "inputs.rms: spans",
    ),
    "modulus of zero": (scene(e_star="{distribution: fixed, values: [0]}"), "inputs.e_star: spans"),
    "modulus in pascals": (
        scene(e_star="{distribution: fixed, values: [9.1e+10]}"),
        "inputs.e_star: spans",
    ),
    "negative hardness": (scene(h_prime="{values: [-5, 15]}"), "inputs.h_prime: spans"),
    "Hurst exponent of 3": (scene(hurst="{values: [0.5, 3]}"), "inputs.hurst: spans"),
    "missing samples": (scene(rms="{distribution: samples, values: nowhere.csv}"), "no such file"),
    "source of 200 kB": (
        scene(rms="{values: [2, 15], source: " + 200_000 * "x" + "}"),
        "at most 500 characters",
    ),
    "contradictory correlations": (f"inputs: {{correlations: {CYCLIC}}}", "correlation"),
    "correlation with itself": ("inputs: {correlations: {rms: {rms: 0.5}}}", "with itself"),
    "correlation of 1": (
        "inputs: {correlations: {rms: {q0: 1.0}}}",
        "rms with q0 = 1; accepted is more than -1",
    ),
    "correlation stated twice": (
        "inputs: {correlations: {e_star: {h_macro: 0.5}, h_macro: {e_star: -0.5}}}",
        "e_star with h_macro is stated twice",
    ),
    "correlation of nobody": ("inputs: {correlations: {rms: {x: 0.5}}}", "unknown input x"),
    "uniform q0 beyond the grid": (
        scene("contact: {pixels: 64}", q0="{values: [0.5, 0.9]}"),
        "beyond what the grid",
    ),
    "normal q0 beyond the grid": (
        scene(q0="{distribution: normal, values: [5, 0.1]}"),
        "beyond what the grid",
    ),
    "fixed q0 beyond the grid": (
        scene(q0="{distribution: fixed, values: [5]}"),
        "beyond what the grid",
    ),
    "cell smaller than its roll-off": (
        scene("contact: {length_nm: 200}"),
        "too small for its roll-off",
    ),
    "electrode smaller than a cell": (
        scene("device: {width_um: 0.01, length_um: 50}"),
        "is smaller than one cell",
    ),
    "cut-off beyond the grid": (
        scene("contact: {pixels: 64, q1_per_nm: 1}"),
        "beyond what contact.pixels = 64",
    ),
    "gap cutoff twice": (
        scene("contact: {gap_cutoff_nm: 0.2}", gap_cutoff="{values: [0.15, 0.3]}"),
        "the same number",
    ),
    "negative force": ("contact: {max_force_nN: -7000}", "contact.max_force_nN = -7000"),
    "cell of nothing": ("contact: {length_nm: 1.0e-300}", "contact.length_nm = 1e-300"),
    "cell of a metre": ("contact: {length_nm: 1.0e+9}", "contact.length_nm = 1000000000.0"),
    "flow of no width": ("contact: {flow_width_nm: 1.0e-12}", "unknown key"),
    "one pixel": ("contact: {pixels: 1}", "contact.pixels = 1"),
    "regression with one run": (scene("uncertainty: {direct_runs: 1}"), "needs at least 14"),
    "million jobs of a pad": (scene("pad: {cells: 1000000}"), "pad.cells = 1000000"),
    "history without flow": (
        scene("history: {cycles: 2}", "contact: {model: elastic}"),
        "only plastic contacts",
    ),
    "coupled contact beyond the memory": (
        scene("contact: {pixels: 16384, mechanics: coupled}"),
        "GB of memory",
    ),
    "beam shorter than an atom": ("device: {length_um: 1.0e-9}", "device.length_um = 1e-09"),
    "spring of nothing": ("device: {spring_N_per_m: 1.0e-300}", "device.spring_N_per_m = 1e-300"),
    "gap below zero": ("device: {gap_um: -1}", "device.gap_um = -1"),
    "Poisson's ratio of a half": ("device: {poisson_ratio: 0.5}", "device.poisson_ratio = 0.5"),
    "two Poisson's ratios in the wrong order": (
        "elastic: {poisson_ratio: [0.3, 0.2]}",
        "two increasing numbers",
    ),
    "equal asperities": (f"hardness: {{asperities: {TWICE}}}", "two have the same name"),
    "no scans at all": (
        "compute: [topography]\ntopography: {synthetic: {small_scans: 0, large_scans: 0}}",
        "nothing to analyse",
    ),
    "missing scans": ("topography: {scans: [nowhere.gwy]}", "no such file"),
    "two conventions": ("topography: {convention: profile}", "convention"),
    "drift without a life": (
        "measurements: {tables: [{kind: drift, file: drift.csv}]}",
        "a drift narrows the rates of lifetime, but lifetime.years = null",
    ),
    "calibration with nothing": (
        scene(rms="{origin: calibration, values: [2, 15]}"),
        "measurements.tables is empty",
    ),
    "stage that cannot compute it": (
        scene(rms="{origin: elastic}"),
        "accepted: literature, topography",
    ),
}
"""By name: the scene and part of its refusal."""
