"""How much do speed, base, anneal, snapshots, potential and steepness of the asperity change the
hardness?

Single closing runs, each with one choice changed.  Differences of speed, base, potential and
steepness are the systematic errors that `size_effect.py` adds to every run alike.  A protocol that
is cheaper is taken where it moves hardness and D0 by less than a third of what runs scatter
(`figures`, rows `..._shift`).

The rows of 2026-11-23 were not made by this command: they were copied, rounded, from the page that
the runs were first written up on.
"""

import resource
import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from functools import cache
from pathlib import Path

import numpy as np

from atomistic.hardness.closing import run_closing
from atomistic.hardness.glass import make_glass
from atomistic.hardness.plateau import find_hardness
from atomistic.hardness.runs import PROTOCOL, ClosingRun
from atomistic.hardness.top_attraction import combined_cutoffs_nm, tops_of
from atomistic.lammps import Atoms
from atomistic.materials import Material, load_materials, oxide_glasses
from atomistic.potentials import Potential, load_potential
from atomistic.settings import AsperitySettings, ClosingSettings, GlassSettings
from evidence.record import ROOT

SMALL, MEDIUM = {"tiles": 2, "amplitude_nm": 0.43}, {"tiles": 3, "amplitude_nm": 0.64}
CASES: dict[str, dict] = {  # asperity; what differs from a scene's default
    "default": {"asperity": SMALL},
    "base_half": {
        "asperity": SMALL,
        "closing": {"base_nm": 1.4},
        "protocol": {"base_over_contact": 0.0},
    },
    "base_thick": {"asperity": SMALL, "closing": {"base_nm": 5.2}},
    "slow": {"asperity": SMALL, "closing": {"speed_m_s": 10}},
    "teter": {"asperity": SMALL, "potential": "teter"},
    "medium": {"asperity": MEDIUM, "closing": {"stop": "window"}},
    "blunt": {"asperity": {**MEDIUM, "amplitude_nm": 0.32}, "closing": {"stop": "window"}},
    "steep": {"asperity": {**MEDIUM, "amplitude_nm": 1.28}, "closing": {"stop": "window"}},
    "base_0.7": {
        "asperity": SMALL,
        "closing": {"base_nm": 1.0},
        "protocol": {"base_over_contact": 0.7},
    },
    "anneal_half": {"asperity": SMALL, "closing": {"anneal_ps": 2.5}},
    "snapshots_half": {"asperity": SMALL, "protocol": {"segments_per_snapshot": 2}},
}
CHEAPER = ("base_0.7", "anneal_half", "snapshots_half")
COLUMNS = (
    "status", "contact_length_nm", "hardness_GPa", "hardness_lo", "hardness_hi",
    "plateau_exponent", "same_shape_GPa",
)  # fmt: skip


def arguments(parser: ArgumentParser) -> None:
    """Which cases, of which glasses."""
    parser.add_argument("cases", nargs="*", default=list(CASES))
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--workers", type=int, default=2)


def rows(given: Namespace) -> Iterator[dict]:
    """Every case with every glass, as they end."""
    with ProcessPoolExecutor(given.workers) as pool:
        jobs = [pool.submit(close, case, seed) for case in given.cases for seed in given.seeds]
        for job in as_completed(jobs):
            yield job.result()


def close(case: str, seed: int) -> dict:
    """Melt, quench and close one case at full energies."""
    changed = CASES[case]
    silica, potential = silica_and(changed.get("potential", "pmmcs"))
    run = ClosingRun(
        name=case,
        asperity=AsperitySettings(name="single", **changed["asperity"]),
        seed=seed,
        energy_scale=1.0,
    )
    closing, protocol = (
        ClosingSettings(**changed.get("closing", {})),
        PROTOCOL.model_copy(update=changed.get("protocol")),
    )
    with tempfile.TemporaryDirectory() as work:
        glass = quenched(potential.name, seed)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        made = run_closing(run, silica, glass, potential, closing, Path(work) / "closing", protocol)
        cpu = resource.getrusage(resource.RUSAGE_CHILDREN)
    found = asdict(find_hardness(made.curve, made.witness, made.summary["wavelength_nm"] ** 2))
    tops = tops_of(made.witness)
    return {
        "case": case,
        "seed": seed,
        **{column: found[column] for column in COLUMNS},
        "d0_nm": combined_cutoffs_nm(tops)[1] if tops else None,
        "atoms": made.summary["atoms"],
        "lammps_cpu_s": cpu.ru_utime + cpu.ru_stime - before.ru_utime - before.ru_stime,
    }


def silica_and(name: str) -> tuple[Material, Potential]:
    """The oxide, and a potential by its name."""
    silica = oxide_glasses(load_materials(ROOT / "config" / "materials").values())["SiO2"]
    return silica, load_potential(ROOT / "config" / "potentials" / f"{name}.yaml")


@cache
def quenched(name: str, seed: int) -> Atoms:
    """The glass of a potential, made once in each worker."""
    with tempfile.TemporaryDirectory() as work:
        return make_glass(*silica_and(name), GlassSettings(), seed, Path(work) / "glass")


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Mean stress of each case over that of its default: of the plateau, or for steepness at one
    share of the cell.

    Of a cheaper protocol also how far hardness, H' and D0 move, with a standard error, in scatters
    between runs.
    """
    found = {}
    for case, reference, column in (
        ("base_half", "base_thick", "hardness_GPa"),
        ("default", "base_thick", "hardness_GPa"),
        ("slow", "default", "hardness_GPa"),
        ("teter", "default", "hardness_GPa"),
        ("blunt", "medium", "same_shape_GPa"),
        ("steep", "medium", "same_shape_GPa"),
    ):
        one, other = (
            {row["seed"]: float(row[column]) for row in rows if row["case"] == name and row[column]}
            for name in (case, reference)
        )
        both = one.keys() & other.keys()  # the glasses that have been pressed both ways
        if both:
            found[case] = (
                f"{sum(one[seed] for seed in both) / sum(other[seed] for seed in both):.2f}"
            )
    for case in CHEAPER:
        for quantity in QUANTITIES:
            tried = logs_of(rows, case, quantity)
            usual = logs_of(rows, "default", quantity)
            if min(tried.size, usual.size) > 2:
                scatter = float(usual.std(ddof=1))
                error = np.hypot(tried.std(ddof=1) / tried.size**0.5, scatter / usual.size**0.5)
                shift = (tried.mean() - usual.mean()) / scatter
                found[f"{case}_{quantity}_shift"] = (
                    f"{shift:+.2f} ± {error / scatter:.2f} of {scatter:.1%}"
                )
    return found


H_MACRO_GPA = 1.95  # middle of Kim et al. (2013), Table 1
QUANTITIES: dict[str, Callable[[Mapping[str, str]], float]] = {
    "hardness": lambda row: float(row["hardness_GPa"]),
    "h_prime": lambda row: (
        (float(row["hardness_GPa"]) - H_MACRO_GPA) * float(row["contact_length_nm"]) ** 0.5
    ),
    "d0": lambda row: float(row["d0_nm"]),
}


def logs_of(rows: Sequence[Mapping[str, str]], case: str, quantity: str) -> np.ndarray:
    """Logarithms of a quantity of the defended runs of a case that have it, shape (runs,)."""
    runs = [
        row for row in rows if row["case"] == case and row["status"] == "yield" and row["d0_nm"]
    ]
    return np.log([QUANTITIES[quantity](row) for row in runs])
