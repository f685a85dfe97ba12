"""How much do closing speed, base, potential and steepness of the asperity change the hardness?

Single closing runs, each with one choice changed.  Their differences are the systematic errors that `size_effect.py`
adds to every run alike.

The rows of 2026-11-23 were not made by this command: they were copied, rounded, from the page that the runs were first
written up on.
"""

import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from functools import cache
from pathlib import Path

from atomistic.hardness.closing import run_closing
from atomistic.hardness.glass import make_glass
from atomistic.hardness.plateau import find_hardness
from atomistic.hardness.runs import PROTOCOL, ClosingRun
from atomistic.lammps import Atoms
from atomistic.materials import Material, load_materials, oxide_glasses
from atomistic.potentials import Potential, load_potential
from atomistic.settings import AsperitySettings, ClosingSettings, GlassSettings
from evidence.record import ROOT

SMALL, MEDIUM = {"tiles": 2, "amplitude_nm": 0.43}, {"tiles": 3, "amplitude_nm": 0.64}
CASES: dict[str, dict] = {  # asperity; what differs from a scene's default
    "default": {"asperity": SMALL},
    "base_half": {"asperity": SMALL, "closing": {"base_nm": 1.4}, "protocol": {"base_over_contact": 0.0}},
    "base_thick": {"asperity": SMALL, "closing": {"base_nm": 5.2}},
    "slow": {"asperity": SMALL, "closing": {"speed_m_s": 10}},
    "teter": {"asperity": SMALL, "potential": "teter"},
    "medium": {"asperity": MEDIUM, "closing": {"stop": "window"}},
    "blunt": {"asperity": {**MEDIUM, "amplitude_nm": 0.32}, "closing": {"stop": "window"}},
    "steep": {"asperity": {**MEDIUM, "amplitude_nm": 1.28}, "closing": {"stop": "window"}},
}
COLUMNS = (
    "status", "contact_length_nm", "hardness_GPa", "hardness_lo", "hardness_hi", "plateau_exponent", "same_shape_GPa",
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
        name=case, asperity=AsperitySettings(name="single", **changed["asperity"]), seed=seed, energy_scale=1.0
    )
    closing, protocol = (
        ClosingSettings(**changed.get("closing", {})),
        PROTOCOL.model_copy(update=changed.get("protocol")),
    )
    with tempfile.TemporaryDirectory() as work:
        glass = quenched(potential.name, seed)
        made = run_closing(run, silica, glass, potential, closing, Path(work) / "closing", protocol)
    found = asdict(find_hardness(made.curve, made.witness, made.summary["wavelength_nm"] ** 2))
    return {"case": case, "seed": seed, **{column: found[column] for column in COLUMNS}}


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
    """Mean stress of each case over that of its default: of the plateau, or for steepness at one share of the cell."""
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
            found[case] = f"{sum(one[seed] for seed in both) / sum(other[seed] for seed in both):.2f}"
    return found
