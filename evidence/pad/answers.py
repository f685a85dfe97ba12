"""What do the law of attraction, D0, mechanics, hardness, seeds and cells change in the default answer?

Each row is scene `reduced` up to its pad with hardness by eq. 4, its default until 0.2.0, and one statement changed.
What its atoms give is stated: E*, H' and D0 of its own runs; `film` has the law of films and its numbers instead.
`pixels` of 256 make the rows cheap, and are the same for all that are compared. Rows with other seeds have other
surfaces and other points.
"""

import json
import re
import shutil
import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from atomistic.hardness.contact_area import calibrated
from atomistic.hardness.size_effect import SYSTEMATIC, literature_samples
from evidence.hardness.choices import silica_and
from evidence.hardness.films import SOFT_GPA, laws
from evidence.pad.runs import results_of
from evidence.record import ROOT, load

ATOMS = {
    "e_star": {"origin": "literature", "distribution": "normal", "values": [90.5, 2.5], "source": "reduced"},
    "h_prime": {"origin": "literature", "values": [3.7, 16.7], "source": "reduced"},
    "gap_cutoff": {"origin": "literature", "values": [0.274, 0.349], "source": "reduced"},
}
EQ_4 = {"hardness": "paper", **dict.fromkeys(("h_film", "t_film", "k_film", "m_film"))}
GLASS = {  # the closing runs' own hardness, without the soft metal of eq. 4
    "h_macro": {"origin": "literature", "values": [8, 11], "source": "closing runs of full energies"},
    "h_prime": {"origin": "literature", "distribution": "fixed", "values": [0], "source": "no size effect"},
}
LITERATURE = {"gap_cutoff": {"origin": "literature", "values": [0.165, 0.3], "source": "Israelachvili, 13.13"}}
SMALL = {"cells": 32, "points": 48, "point_cells": 2}  # an adhesive cell takes some ten times as long as a coupled one
CLAMPED = {"contact": {"attraction": "clamped"}}
TABLE_1 = {"extends": "table1", "contact": {"mechanics": "coupled", "attraction": "offset"}, "pad": {"cells": 64}}
SEEDS = {"mesoscale/pad/cells.py": "FIRST_SEED = 1000", "mesoscale/device/points.py": "rng=0"}
CASES: dict[str, dict[str, Any]] = {
    "default": {},
    "clamped, literature's D0": {**CLAMPED, "inputs": LITERATURE},
    "offset, literature's D0": {"inputs": LITERATURE},
    "clamped": CLAMPED,
    "small pad": {"pad": SMALL},
    "small pad, attraction deforms": {"pad": SMALL, "contact": {"mechanics": "adhesive"}},
    "hardness of the glass": {"inputs": GLASS},
    "clamped, literature's D0, hardness of the glass": {**CLAMPED, "inputs": {**LITERATURE, **GLASS}},
    "paper's inputs": TABLE_1,
    "paper's inputs, film": TABLE_1,
    "film": {},  # on H_macro of the default
    "film, metal as pressed": {},
    "256 cells": {"pad": {"cells": 256}},
    "other seeds, 1": {},
    "other seeds, 2": {},
}


def arguments(parser: ArgumentParser) -> None:
    """Which cases, at which grid."""
    parser.add_argument("--cases", nargs="+", default=list(CASES), choices=list(CASES))
    parser.add_argument("--pixels", type=int, default=256)


def film_inputs(pressed: bool) -> dict[str, Any]:
    """Inputs of an oxide film as scene `reduced` has them; `pressed`: on titanium as scene `films` presses it."""
    _, area_error = calibrated(silica_and("pmmcs")[1])
    runs = [row for row in load("hardness.sizes") if row["scene"] == "reduced"]
    _, _, hardness = literature_samples(runs, SOFT_GPA, {"area": area_error / 3**0.5, **SYSTEMATIC}, (1, 1))
    film, base, _, _ = laws()["draws"].T
    by = {"origin": "literature", "source": "python -m evidence hardness.films, hardness.sizes"}

    def row(values: np.ndarray) -> dict[str, Any]:
        return {**by, "values": np.quantile(values, [0.16, 0.84]).tolist()}

    given = yaml.safe_load((ROOT / "config" / "scenes" / "reduced.yaml").read_text(encoding="utf-8"))["inputs"]
    return {
        "hardness": "film",
        "h_prime": None,
        "h_film": row(film if pressed else hardness),  # oxide with halved energies is softer than that metal
        **{name: given[name] for name in ("t_film", "k_film", "m_film")},
        **({"h_macro": row(base)} if pressed else {}),
    }


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each case."""
    for case in given.cases:
        with tempfile.TemporaryDirectory() as folder:
            tree = _other_seeds(Path(folder), case[-1]) if case.startswith("other") else ROOT
            with results_of(scene_of(case, given.pixels), "device", tree) as results:
                yield {"case": case, "pixels": given.pixels, **_answer(results)}


def scene_of(case: str, pixels: int) -> dict[str, Any]:
    """The scene of a case."""
    changed = CASES[case]
    if "film" in case:
        changed = {**changed, "inputs": film_inputs("pressed" in case)}
    return {
        "extends": "reduced",
        "name": "answer",
        "compute": [],
        "inputs": ({} if changed.get("extends") else EQ_4 | ATOMS) | changed.get("inputs", {}),
        "contact": {"pixels": pixels} | changed.get("contact", {}),
        **{key: value for key, value in changed.items() if key not in ("inputs", "contact")},
    }


def _other_seeds(tree: Path, number: str) -> Path:
    """A copy of the product whose surfaces and points come from other seeds."""
    for package in ("asperity", "atomistic", "mesoscale", "workflow", "config", "evidence"):
        shutil.copytree(ROOT / package, tree / package, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("Snakefile", "pyproject.toml", "uv.lock"):
        shutil.copy(ROOT / name, tree / name)
    for name, seed in SEEDS.items():
        text = (tree / name).read_text()
        if seed not in text:
            raise ValueError(f"{name}: {seed!r} is no longer there")
        (tree / name).write_text(text.replace(seed, re.sub(r"\d+$", f"{number}0000", seed)))
    return tree


def _answer(results: Path) -> dict[str, Any]:
    content = json.loads((results / "device" / "pad_switch.json").read_text())
    switch = content["answer"]
    volts, stuck = switch["release_V"]["quantiles"], switch["stuck"]
    largest = sorted(switch["sensitivity"], key=lambda row: -row["share_of_variance"])[:3]
    return {
        "release_V": volts["0.5"], "low_V": volts["0.05"], "high_V": volts["0.95"],
        "central_V": content["central"]["release_V"],
        "stuck": stuck["value"], "stuck_low": stuck["low"], "stuck_high": stuck["high"],
        "points": stuck["samples"], "refused": len(switch["refused"]),
        "largest_shares": ", ".join(f"{row['name']} {row['share_of_variance']:.2f}" for row in largest),
    }  # fmt: skip


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Release and sticking of each case, the last run of each; the share of H_macro with the default's statements."""
    same = [row["largest_shares"] for row in rows if row["case"].split(",")[0] in ("default", "other seeds")]
    shares = [float(share) for text in same for share in re.findall(r"h_macro ([\d.]+)", text)]
    return {
        "h_macro": ", ".join(f"{share:.0%}" for share in shares),
        **{
            re.sub(r"\W+", "_", f"{row['case']}_{row['pixels']}"): f"{float(row['release_V']):.2f} V "
            f"[{float(row['low_V']):.2f}, {float(row['high_V']):.2f}], {float(row['stuck']):.0%} stick"
            for row in rows
        },
    }
