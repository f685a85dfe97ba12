"""E* from bulk and shear moduli of the same structures, so that Poisson's ratio is theirs and not assumed."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from ase import Atoms
from ase.calculators.calculator import CalculationFailed, Calculator

from atomistic.constants import AMU_PER_A3_IN_G_CM3
from atomistic.elastic.dft import TwoMeshes
from atomistic.elastic.moduli import grid_shares, plane_strain_modulus, spread
from atomistic.elastic.networks import examine, no_insulator, same_network
from atomistic.elastic.relaxation import Rest, last_gap_eV, relax_cell, strained
from atomistic.elastic.response import Response, elastic_response
from atomistic.elastic.tensor import isotropic, poisson, young
from atomistic.errors import InputError
from atomistic.materials import Material, NetworkGlass, Polycrystal
from atomistic.settings import ElasticSettings, TensorSettings

Progress = Callable[[float, str], None]
IONS = ("clamped", "relaxed")
ROUGH = 3.0  # times the largest force left: so far one of two meshes serves, at half the cost; its ripple is as large
MOST_ESTIMATED = 0.2  # of a constant: a third of the estimate may be wrong (docs/elastic.md), so 7 % of the constant
ASSUMPTIONS = (
    "Poisson's ratio is computed: bulk and shear modulus of each structure come from its elastic constants.",
    "LDA scales bulk and shear modulus by one factor, that of the bulk modulus under clamped ions.",
    "Anisotropy is what a small cell leaves of the difference between Voigt's and Reuss's bounds. What its size "
    "changes beyond that is taken from larger cells of a crystal and of single glasses, not from an ensemble of them.",
)


class Measured(NamedTuple):
    """Elastic constants of a structure at rest, or why there are none.

    Attributes
    ----------
    atoms : ions and cell as they came to rest
    doubts : why a cell at rest is no insulating glass any more
    """

    atoms: Atoms
    rest: Rest | None
    response: Response | None
    failure: str
    doubts: tuple[str, ...] = ()

    def report(self, name: str) -> dict[str, Any]:
        """What elastic/tensors/NAME.json says; GPa in Voigt's order xx, yy, zz, yz, xz, xy."""
        constants, rest = self.response, self.rest
        return {
            "structure": name,
            "atoms": len(self.atoms),
            "density_g_cm3": float(self.atoms.get_masses().sum() / self.atoms.get_volume() * AMU_PER_A3_IN_G_CM3),
            "steps": rest.steps if rest else 0,
            "force_left_eV_A": rest.force_left_eV_A if rest else None,
            "calculations": constants.calculations if constants else 0,
            "softest_eV_A2": constants.softest_eV_A2 if constants else None,
            "stress_left_GPa": constants.clamped.stress.tolist() if constants else None,
            "error_GPa": float(constants.clamped.error.max()) if constants else None,
            "still_softer_GPa": constants.relaxed_left.tolist() if constants else None,
            "C_clamped_GPa": constants.clamped.C.tolist() if constants else None,
            "C_relaxed_GPa": constants.relaxed.tolist() if constants else None,
            "failure": self.failure,
            "doubts": list(self.doubts),
        }


def measure_constants(
    atoms: Atoms,
    calculator: Calculator,
    settings: TensorSettings,
    progress: Progress | None = None,
    criteria: NetworkGlass | None = None,
) -> Measured:
    """Relax ions and cell, then elastic constants; whatever fails costs this structure only and is named.

    Parameters
    ----------
    criteria : what a glass should still fulfil when its cell has come to rest; None for a crystal
    """
    atoms = strained(atoms, 0.0)
    sides = calculator.sides if isinstance(calculator, TwoMeshes) else (calculator, calculator)
    rest, doubts = None, ()
    try:
        rest = _relax(atoms, calculator, settings)
        if not rest.converged:
            left = f"{rest.force_left_eV_A:.2f} eV/A left on an atom"
            return Measured(atoms, rest, None, f"ions and cell not at rest after {rest.steps} steps, {left}")
        doubts = _no_glass(atoms, calculator, criteria) if criteria else ()
        constants = elastic_response(
            atoms,
            sides,
            rest.hessian_eV_A2,
            settings.strain,
            settings.displacement_A,
            settings.rounds,
            settings.tolerance_GPa,
            progress,
        )
    except (CalculationFailed, NotImplementedError, InputError, np.linalg.LinAlgError, FloatingPointError) as error:
        return Measured(atoms, rest, None, str(error), doubts)
    return Measured(atoms, rest, constants, "", doubts)


def _no_glass(atoms: Atoms, calculator: Calculator, criteria: NetworkGlass) -> tuple[str, ...]:
    """Why a cell at rest is no insulating glass: without the stress of its box it may have turned into a crystal."""
    return (*examine(atoms, criteria).reasons, *no_insulator(last_gap_eV(calculator), criteria))


def _relax(atoms: Atoms, calculator: Calculator, settings: TensorSettings) -> Rest:
    """Ions and cell at rest; of two meshes the first goes ahead as far as its ripple lets it."""
    before, hessian = 0, None
    if isinstance(calculator, TwoMeshes):
        atoms.calc = calculator.sides[0]
        rough = relax_cell(atoms, ROUGH * settings.force_eV_A, settings.max_steps)
        if not rough.converged:
            return rough
        before, hessian = rough.steps, rough.hessian_eV_A2
    atoms.calc = calculator
    rest = relax_cell(atoms, settings.force_eV_A, settings.max_steps, hessian)
    return rest._replace(steps=before + rest.steps)


def isotropic_rows(report: Mapping[str, Any], copied: str | None = None) -> list[dict[str, Any]]:
    """Rows of elastic/isotropic_moduli.csv of one structure, clamped and relaxed, from its `Measured.report`.

    Parameters
    ----------
    copied : the structure that this one is once more at rest; it counts once
    """
    rows = []
    for ions in IONS:
        flags = [*filter(None, [report["failure"], copied and f"at rest it is {copied} again"])]
        values = dict.fromkeys(("B_GPa", "G_GPa", "E_GPa", "nu", "B_error_GPa", "G_error_GPa"))
        if not report["failure"]:
            if ions == "relaxed":
                flags += _resting_on_estimates(report)
            try:
                mean = isotropic(np.array(report[f"C_{ions}_GPa"]))
                values = dict(zip(values, (mean.B, mean.G, mean.E, mean.nu, mean.B_error, mean.G_error), strict=True))
            except InputError as error:
                flags.append(str(error))
        head = {key: report[key] for key in ("structure", "atoms", "density_g_cm3")}
        rows.append({**head, "ions": ions, **values, "flags": "; ".join(flags), "doubts": "; ".join(report["doubts"])})
    return rows


def isotropic_table(measured: Iterable[tuple[Mapping[str, Any], Atoms]]) -> list[dict[str, Any]]:
    """Rows of elastic/isotropic_moduli.csv; a network in which several cells come to rest counts once.

    Parameters
    ----------
    measured : of each structure its `Measured.report` and its cell at rest
    """
    rows: list[dict[str, Any]] = []
    known: dict[str, Atoms] = {}
    for report, atoms in measured:
        rows += isotropic_rows(report, same_network(atoms, known))
        if not report["failure"]:
            known[report["structure"]] = atoms
    return rows


def _resting_on_estimates(report: Mapping[str, Any]) -> list[str]:
    """What to say of the first constant whose softening by the ions is estimated for a large part, if there is one."""
    names = ("C11", "C22", "C33", "C44", "C55", "C66")
    for name, value, left in zip(names, np.diag(report["C_relaxed_GPa"]), report["still_softer_GPa"], strict=True):
        if left > MOST_ESTIMATED * abs(value):
            return [f"{name} of {value:.0f} GPa rests on an estimate of {left:.0f} GPa: raise elastic.tensor.rounds"]
    return []


def _on_doubtful(rows: Sequence[Mapping[str, str]], sound: Mapping[str, Any]) -> str:
    """What to say of cells that are no insulating glass at rest, and of E* without them."""
    said = ", ".join(f"{row['structure']} ({row['doubts']})" for row in rows if row["doubts"])
    without = (
        f"Without them it is {sound['mean_GPa']:.1f} ± {sound['std_GPa']:.1f} GPa" if sound else "None is left without"
    )
    return f"Cells that are no insulating glass when they are at rest: {said}. They are in E*. {without}."


def with_computed_poisson(
    by_literature: Mapping[str, Any],
    rows: Sequence[Mapping[str, str]],
    counter_body: Material,
    settings: ElasticSettings,
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """E* from the structures' own bulk and shear moduli, ions relaxed.

    Parameters
    ----------
    by_literature : what `effective_modulus` gives with Poisson's ratio from its range; kept beside the result
    rows : of elastic/isotropic_moduli.csv

    Returns
    -------
    As `effective_modulus`
    """
    other: Polycrystal = counter_body.part("polycrystal")
    trusted = {ions: [row for row in rows if row["ions"] == ions and not row["flags"]] for ions in IONS}
    columns = ("B_GPa", "G_GPa", "B_error_GPa", "G_error_GPa")
    pairs = {
        ions: np.array([[float(row[c]) for c in columns] for row in trusted[ions]]).reshape(-1, 4) for ions in IONS
    }
    used = pairs["relaxed"]
    shift = by_literature["LDA_minus_GGA"]["mean_GPa"]
    clamped_B = by_literature["B_GPa_by_kind"]["GGA clamped"]["mean"]
    reasons = []
    if len(used) < settings.min_structures:
        reasons.append(
            f"{len(used)} amorphous structures with trusted elastic constants, {settings.min_structures} are needed"
        )
    if not np.isfinite(shift) or not clamped_B:
        reasons.append("no structure has both LDA and GGA: the model-form shift is unknown")
    summary = {
        **by_literature,
        "ions": "relaxed",
        "structures_used": [row["structure"] for row in trusted["relaxed"]],
        "poisson_ratio": {"distribution": "computed", **spread(poisson(used[:, 0], used[:, 1]))},
        "isotropic_moduli": {
            ions: {
                "B_GPa": spread(p[:, 0]),
                "G_GPa": spread(p[:, 1]),
                "E_GPa": spread(young(p[:, 0], p[:, 1])),
                "nu": spread(poisson(p[:, 0], p[:, 1])),
            }
            for ions, p in pairs.items()
        },
        "by_literature_poisson": {
            key: by_literature.get(key)
            for key in ("mean_GPa", "std_GPa", "shares", "quantiles_GPa", "ions", "structures_used", "gate")
        },
        "notes": [by_literature["notes"][0], *ASSUMPTIONS],
        "gate": {"passed": not reasons, "reasons": reasons},
        "inputs": {},
        "mean_GPa": float("nan"),
        "std_GPa": float("nan"),
    }
    if not len(used):
        return summary, {}
    factor = 1 + shift / clamped_B if np.isfinite(shift) and clamped_B else 1.0
    nodes, weights = np.polynomial.legendre.leggauss(8)
    normal, normal_weights = np.polynomial.hermite_e.hermegauss(9)

    def modulus(structure, anisotropy, size, functional, counter_E):
        B, G, B_error, G_error = used[np.asarray(structure, int)].T
        scale = functional * (1 + settings.size_error * size)
        B, G = scale * (B + anisotropy * B_error).T, scale * (G + anisotropy * G_error).T
        return plane_strain_modulus(B, poisson(B, G), counter_E, other.poisson_ratio), B, G

    axes = {
        "structure": (np.arange(len(used)), np.full(len(used), 1 / len(used))),
        "anisotropy": (nodes, weights / 2),  # uniform between the bounds
        "size": (normal, normal_weights / normal_weights.sum()),
        "functional": (np.array([1.0, factor]), np.full(2, 0.5)),
        "counter_body": (other.young_GPa + other.young_std_GPa * normal, normal_weights / normal_weights.sum()),
    }
    summary |= grid_shares(axes, lambda *values: modulus(*values)[0])
    sound = np.array([k for k, row in enumerate(trusted["relaxed"]) if not row["doubts"]], int)
    if len(sound) < len(used):
        of_sound = {**axes, "structure": (sound, np.full(len(sound), 1 / max(1, len(sound))))}
        without = grid_shares(of_sound, lambda *values: modulus(*values)[0]) if len(sound) else {}
        summary["without_doubtful"] = {
            "structures": len(sound),
            "mean_GPa": without.get("mean_GPa"),
            "std_GPa": without.get("std_GPa"),
        }
        summary["notes"].append(_on_doubtful(trusted["relaxed"], without))
    rng = np.random.default_rng(np.random.SeedSequence([settings.seed, 52]))
    n = settings.samples
    lda = rng.integers(0, 2, n)
    counter = rng.normal(other.young_GPa, other.young_std_GPa, n)
    structure, anisotropy, size = rng.integers(0, len(used), n), rng.uniform(-1, 1, n), rng.standard_normal(n)
    e_star, B, G = modulus(structure, anisotropy, size, np.where(lda, factor, 1.0), counter)
    quantiles = (0.025, 0.16, 0.5, 0.84, 0.975)
    summary["quantiles_GPa"] = dict(zip(map(str, quantiles), np.quantile(e_star, quantiles).tolist(), strict=True))
    means = [modulus(k, 0.0, 0.0, 0.5 * (1 + factor), other.young_GPa)[0] for k in range(len(used))]
    summary["standard_error_of_mean_GPa"] = (
        float(np.std(means, ddof=1) / np.sqrt(len(used))) if len(used) > 1 else float("nan")
    )
    summary["inputs"] = {"e_star": {"distribution": "normal", "a": summary["mean_GPa"], "b": summary["std_GPa"]}}
    return summary, {"e_star_GPa": e_star, "B_GPa": B, "nu": poisson(B, G), "counter_E_GPa": counter, "xc": lda}
