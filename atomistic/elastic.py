"""The elastic stage: relaxed glasses, E(V) scans, and the effective modulus E* with its uncertainty.

    E = 3 B (1 − 2ν),   1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂          (Kim et al. 2013, eq. 5)

B from E(V) under isotropic strain.  "Clamped" ions keep their fractional coordinates (every bond scales); "relaxed"
ions find their minimum at each strain, which is what a slow experiment does.  A glass is softer with relaxed ions.
"""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from ase import Atoms
from ase.calculators.calculator import CalculationFailed, Calculator

from atomistic.dft import PyscfGamma, Store, commensurate_mesh
from atomistic.equation_of_state import MIN_POINTS, fit_equation_of_state
from atomistic.errors import InputError
from atomistic.relaxation import Rest, extrapolated_ions, strained
from atomistic.settings import DftSettings, ElasticSettings

Progress = Callable[[float, str], None]
ENGINES_OF_ASE = ("espresso", "vasp", "abinit", "cp2k", "gpaw", "siesta")
FORBIDDEN_PARAMETERS = (
    "command",
    "profile",
    "binary",
    "executable",
)  # a scene must not be able to start programs


def make_calculator(
    dft: DftSettings,
    xc: str,
    largest_cell: np.ndarray | None = None,
    store: Store | None = None,
    cutoff_Ha=None,
) -> Calculator:
    """The DFT engine of the settings.

    Parameters
    ----------
    xc : "GGA" or "LDA"
    largest_cell : (3, 3) Å; the mesh is fixed to what this cell needs, so that it does not jump along a scan
    store : finished calculations (PySCF engine only)
    """
    if dft.engine == "pyscf":
        cutoff = cutoff_Ha or dft.cutoff_Ha
        return PyscfGamma(
            store=store,
            xc=xc,
            basis=dft.basis,
            cutoff_Ha=cutoff,
            mesh=None if largest_cell is None else commensurate_mesh(largest_cell, cutoff),
            tolerance_Ha=dft.tolerance_Ha,
            max_cycles=dft.max_cycles,
            numerics=dft.numerics,
        )
    for key in FORBIDDEN_PARAMETERS:
        if key in dft.parameters:
            raise InputError(
                f"elastic.dft.parameters.{key}: a scene may not name programs; configure them in ASE's own "
                "configuration file (ase.readthedocs.io, 'Calculator configuration')"
            )
    from ase.calculators.calculator import get_calculator_class

    try:
        parameters: dict[str, Any] = dict(dft.parameters)
        return get_calculator_class(dft.engine)(**parameters)
    except Exception as error:
        raise InputError(f"elastic.dft.engine: ASE cannot set up {dft.engine}: {error}") from error


@dataclass(frozen=True)
class Point:
    """One volume of an E(V) scan; `energy_eV` is NaN where the calculation failed.

    `detail` says why it failed, or how relaxed ions came to rest.
    """

    strain: float
    volume_A3: float
    energy_eV: float
    converged: bool
    wall_s: float
    detail: str = ""


def scan_order(strains: Sequence[float]) -> list[float]:
    """Smallest strain first, then outwards: each calculation starts from its neighbours'."""
    return sorted(strains, key=lambda strain: (abs(strain), -strain))


def scan_volumes(
    atoms: Atoms,
    calculator: Calculator,
    strains: Sequence[float],
    relax: Callable[[Atoms, np.ndarray | None], Rest] | None = None,
    progress: Progress | None = None,
) -> list[Point]:
    """Energy of a structure at each isotropic strain.

    A calculation that fails is reported in its point and the scan goes on.  Ions that relax start from where those of
    the nearest strains came to rest, with the Hessian found there; what the forces left still hold is taken off the
    energy.

    Parameters
    ----------
    relax : moves the ions of a strained structure (its calculator attached) to their minimum, from a Hessian if there
        is one; None clamps them
    """
    points: dict[float, Point] = {}
    rested: dict[float, Atoms] = {}
    hessian: np.ndarray | None = None
    order = scan_order(strains)
    if relax is not None:
        order.append(order[0])  # the first to come to rest did so without neighbours: once more, between them
    for done, strain in enumerate(order):
        if progress:
            progress(done / len(order), f"strain {strain:+.3f}")
        others = {known: ions for known, ions in rested.items() if known != strain}
        trial = extrapolated_ions(others or {0.0: atoms}, strain)
        trial.calc = calculator
        start = time.perf_counter()
        energy, converged, detail = float("nan"), True, ""
        try:
            below = 0.0
            if relax is not None:
                rest = relax(trial, hessian)
                rested[strain], hessian, below = trial, rest.hessian_eV_A2, rest.depth_eV
                detail = (
                    f"{rest.steps} steps, {rest.force_left_eV_A:.2f} eV/A left, minimum {1000 * below:.1f} meV below"
                )
            energy = float(trial.get_potential_energy()) - below
        except (CalculationFailed, NotImplementedError, np.linalg.LinAlgError, FloatingPointError) as error:
            converged, detail = False, f"strain {strain:+.3f}: {error}"
        point = Point(strain, float(trial.get_volume()), energy, converged, time.perf_counter() - start, detail)
        before = points.get(strain, point)
        lower = before if before.energy_eV < energy or not converged else point
        points[strain] = replace(lower, wall_s=point.wall_s + (before.wall_s if before is not point else 0.0))
    return [points[strain] for strain in sorted(points)]


def rejected_points(atoms: Atoms, strains: Sequence[float], reason: str) -> list[Point]:
    """The scan of a structure that failed its gate: nothing computed, the reason in every point."""
    volumes = [float(strained(atoms, strain).get_volume()) for strain in strains]
    return [Point(s, v, float("nan"), False, 0.0, reason) for s, v in zip(strains, volumes, strict=True)]


def fit_scan(scan: Sequence[Mapping[str, str]]) -> dict[str, Any]:
    """Row of `bulk_moduli.csv` from the rows of one scan: the fit, or why there is none.

    Points that did not converge are named in `flags`; with fewer than five left the structure is rejected.
    """
    good = [row for row in scan if row["converged"] == "True"]
    failed = list(dict.fromkeys(row["detail"] for row in scan if row["converged"] != "True"))
    result: dict[str, Any] = {key: scan[0][key] for key in ("structure", "xc", "ions", "atoms")}
    empty = ("B_GPa", "B_prime", "V0_A3", "B_vinet_GPa", "residual_meV")
    if len(good) < MIN_POINTS:
        flags = [f"{len(good)} of {len(scan)} strains converged, {MIN_POINTS} are needed", *failed]
        return {
            **result,
            **dict.fromkeys(empty),
            "points": len(good),
            "flags": "; ".join(flags),
            "failed": "",
        }
    fit = fit_equation_of_state([float(r["volume_A3"]) for r in good], [float(r["energy_eV"]) for r in good])
    return {
        **result,
        **{key: getattr(fit, key) for key in empty},
        "points": fit.points,
        "flags": "; ".join(fit.flags),
        "failed": "; ".join(failed),
    }


# -- effective modulus


@dataclass(frozen=True)
class Modulus:
    """A bulk modulus that entered or was kept out of E*."""

    structure: str
    xc: str
    ions: str
    B_GPa: float
    trusted: bool
    reason: str = ""


def plane_strain_modulus(B_GPa, nu, other_E_GPa, other_nu):
    """E* of two bodies in GPa (eq. 5); arrays broadcast."""
    E = 3 * np.asarray(B_GPa) * (1 - 2 * np.asarray(nu))
    return 1 / ((1 - np.asarray(nu) ** 2) / E + (1 - np.asarray(other_nu) ** 2) / np.asarray(other_E_GPa))


def functional_shift(moduli: Sequence[Modulus], ions: str) -> dict[str, Any]:
    """LDA − GGA of the bulk modulus over the structures that have both: mean, spread, 95 % interval of the mean."""
    from scipy.stats import t

    by_xc = {
        xc: {m.structure: m.B_GPa for m in moduli if m.xc == xc and m.ions == ions and m.trusted}
        for xc in ("GGA", "LDA")
    }
    both = sorted(set(by_xc["GGA"]) & set(by_xc["LDA"]))
    differences = np.array([by_xc["LDA"][s] - by_xc["GGA"][s] for s in both])
    n = len(differences)
    if n == 0:
        return {"mean_GPa": float("nan"), "std_GPa": float("nan"), "interval_95_GPa": None, "structures": []}
    mean = float(differences.mean())
    std = float(differences.std(ddof=1)) if n > 1 else float("nan")
    half = float(t.ppf(0.975, n - 1) * std / np.sqrt(n)) if n > 1 else float("nan")
    return {
        "mean_GPa": mean,
        "std_GPa": std,
        "interval_95_GPa": [mean - half, mean + half],
        "structures": both,
    }


def variance_shares(
    B_GPa: Sequence[float] | np.ndarray,
    shift_GPa: float,
    nu: tuple[float, float],
    other_E: tuple[float, float],
    other_nu: float,
) -> dict[str, Any]:
    """Mean, standard deviation and first-order and total shares of the variance of E*, without sampling error.

    The four inputs are independent: structure (the ensemble, equal weights), functional (GGA or GGA + shift, equal
    weights), ν (uniform), E of the other body (normal).  Gauss quadrature makes a weighted grid on which the
    analysis of variance is exact.
    """
    nodes_nu, weights_nu = np.polynomial.legendre.leggauss(12)
    nodes_E, weights_E = np.polynomial.hermite_e.hermegauss(9)
    values = [
        np.asarray(B_GPa, float),
        np.array([0.0, shift_GPa]),
        0.5 * (nu[0] + nu[1]) + 0.5 * (nu[1] - nu[0]) * nodes_nu,
        other_E[0] + other_E[1] * nodes_E,
    ]
    weights = [
        np.full(len(values[0]), 1 / len(values[0])),
        np.full(2, 0.5),
        weights_nu / 2,
        weights_E / weights_E.sum(),
    ]
    B, f, n, E = np.meshgrid(*values, indexing="ij")
    grid = plane_strain_modulus(B + f, n, E, other_nu)
    weight = np.einsum("i,j,k,l->ijkl", *weights)
    mean = float((weight * grid).sum())
    variance = float((weight * (grid - mean) ** 2).sum())
    names = ("structure", "functional", "poisson_ratio", "counter_body")
    shares = {}
    for axis, name in enumerate(names):
        others = tuple(k for k in range(4) if k != axis)
        conditional = np.tensordot(grid, np.einsum("i,j,k->ijk", *(weights[k] for k in others)), (others, (0, 1, 2)))
        first = float(weights[axis] @ (conditional - mean) ** 2)
        over = np.average(grid, axis=axis, weights=weights[axis])
        rest = np.einsum("i,j,k->ijk", *(weights[k] for k in others))
        total = variance - float((rest * (over - mean) ** 2).sum())
        shares[name] = {"first_order": first / variance, "total": total / variance} if variance > 0 else {}
    return {"mean_GPa": mean, "std_GPa": float(np.sqrt(variance)), "shares": shares}


NOTES = (
    "The glasses are ideal networks: every Si has four N and every N three Si. Films hold a few per cent of broken "
    "bonds, which soften them, so B and E* are upper estimates.",
    "Ions clamped to fractional coordinates (the paper's scaling) stiffen the glass; relaxed_over_clamped says by how "
    "much.",
)
PAPER = {"mean_GPa": 91.0, "std_GPa": 3.8, "source": "Kim et al. (2013), Table 1"}


def effective_modulus(
    moduli: Sequence[Modulus], counter_body: Mapping[str, Any], settings: ElasticSettings
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """E* as a distribution: mixture of GGA and GGA shifted by LDA − GGA, ν uniform, counter body from experiment.

    Parameters
    ----------
    moduli : of the glasses (crystals do not belong here)
    counter_body : material file of the other body

    Returns
    -------
    Summary for `e_star.json` (with `inputs` and `gate`), and samples: e_star_GPa, B_GPa, nu, counter_E_GPa, xc
    """
    used = [m for m in moduli if m.xc == "GGA" and m.ions == settings.ions and m.trusted]
    shift = functional_shift(moduli, settings.ions)
    shift_ions = settings.ions
    if not shift["structures"]:  # relaxed ions are seldom done with LDA: its shift is then the clamped one
        shift, shift_ions = functional_shift(moduli, "clamped"), "clamped"
    shift = {**shift, "ions": shift_ions}
    reasons = []
    if len(used) < settings.min_structures:
        reasons.append(
            f"{len(used)} amorphous structures with a trusted {settings.ions}-ion GGA bulk modulus, "
            f"{settings.min_structures} are needed"
        )
    if not shift["structures"]:
        reasons.append("no structure has both LDA and GGA: the model-form shift is unknown")
    other_E = (float(counter_body["young_GPa"]), float(counter_body.get("young_std_GPa", 0.0)))
    other_nu = float(counter_body["poisson_ratio"])
    summary: dict[str, Any] = {
        "ions": settings.ions,
        "structures_used": [m.structure for m in used],
        "kept_out": [{**asdict(m)} for m in moduli if not m.trusted],
        "B_GGA_GPa": _spread([m.B_GPa for m in used]),
        "B_GPa_by_kind": {
            f"{xc} {ions}": _spread([m.B_GPa for m in moduli if m.xc == xc and m.ions == ions and m.trusted])
            for xc in ("GGA", "LDA")
            for ions in ("clamped", "relaxed")
        },
        "relaxed_over_clamped": _ratio(moduli),
        "LDA_minus_GGA": shift,
        "poisson_ratio": {
            "distribution": "uniform",
            "a": settings.poisson_ratio[0],
            "b": settings.poisson_ratio[1],
        },
        "counter_body": {
            "name": counter_body["name"],
            "E_GPa": other_E[0],
            "E_std_GPa": other_E[1],
            "nu": other_nu,
        },
        "paper": PAPER,
        "notes": list(NOTES[: 2 if settings.ions == "clamped" else 1]),
    }
    nan = float("nan")
    if not used:
        summary |= {
            "mean_GPa": nan,
            "std_GPa": nan,
            "inputs": {},
            "gate": {"passed": False, "reasons": reasons},
        }
        return summary, {name: np.empty(0) for name in ("e_star_GPa", "B_GPa", "nu", "counter_E_GPa", "xc")}
    delta = shift["mean_GPa"] if shift["structures"] else 0.0
    B = np.array([m.B_GPa for m in used])
    summary |= variance_shares(B, delta, settings.poisson_ratio, other_E, other_nu)
    rng = np.random.default_rng(np.random.SeedSequence([settings.seed, 51]))
    n = settings.samples
    lda = rng.integers(0, 2, n)
    B_samples = rng.choice(B, n) + delta * lda
    nu = rng.uniform(*settings.poisson_ratio, n)
    E = rng.normal(other_E[0], other_E[1], n)
    e_star = plane_strain_modulus(B_samples, nu, E, other_nu)
    quantiles = (0.025, 0.16, 0.5, 0.84, 0.975)
    summary["quantiles_GPa"] = dict(zip(map(str, quantiles), np.quantile(e_star, quantiles).tolist(), strict=True))
    summary["standard_error_of_mean_GPa"] = _standard_error(B, delta, settings, other_E, other_nu)
    summary["inputs"] = {"e_star": {"distribution": "normal", "a": summary["mean_GPa"], "b": summary["std_GPa"]}}
    summary["gate"] = {"passed": not reasons, "reasons": reasons}
    return summary, {"e_star_GPa": e_star, "B_GPa": B_samples, "nu": nu, "counter_E_GPa": E, "xc": lda}


def _standard_error(B: np.ndarray, delta: float, settings: ElasticSettings, other_E, other_nu: float) -> float:
    """Standard error of the mean of E* from the finite number of structures (jackknife)."""
    if len(B) < 2:
        return float("nan")
    means = [
        variance_shares(np.delete(B, k), delta, settings.poisson_ratio, other_E, other_nu)["mean_GPa"]
        for k in range(len(B))
    ]
    return float(np.sqrt((len(B) - 1) / len(B) * np.sum((np.array(means) - np.mean(means)) ** 2)))


def _spread(values: Sequence[float]) -> dict[str, Any]:
    array = np.array(values, float)
    return {
        "mean": float(array.mean()) if len(array) else None,
        "std": float(array.std(ddof=1)) if len(array) > 1 else None,
        "structures": len(array),
    }


def _ratio(moduli: Sequence[Modulus]) -> dict[str, Any]:
    """Relaxed-ion over clamped-ion bulk modulus of the structures that have both (GGA)."""

    def by_structure(ions: str) -> Iterator[tuple[str, float]]:
        return ((m.structure, m.B_GPa) for m in moduli if m.xc == "GGA" and m.ions == ions and m.trusted)

    clamped = dict(by_structure("clamped"))
    ratios = {s: B / clamped[s] for s, B in by_structure("relaxed") if s in clamped}
    return {**_spread(list(ratios.values())), "by_structure": ratios}
