"""Hard cases of the elastic stage: invariant checks, and what cannot be trusted says so."""

from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from typing import Any

import numpy as np
from ase import Atoms
from ase.build import bulk
from ase.calculators.calculator import CalculationFailed, Calculator

from atomistic.elastic.dft import PyscfGamma, ScfNotConverged, build_cell, commensurate_mesh
from atomistic.elastic.energy_scans import fit_scan, scan_volumes
from atomistic.elastic.joint_moduli import measure_constants
from atomistic.elastic.moduli import plane_strain_modulus
from atomistic.elastic.networks import examine, tersoff_calculator
from atomistic.elastic.relaxation import relax_cell, spring_hessian, strained
from atomistic.elastic.response import elastic_response
from atomistic.elastic.tensor import fit_stiffness, isotropic, strain_states
from atomistic.errors import InputError
from atomistic.materials import NetworkGlass
from atomistic.settings import ElasticSettings, TensorSettings

Verdict = tuple[bool, str]
Check = tuple[str, str, str, Callable[[], Verdict]]
CUTOFF_HA = 50.0
SMALL = "gth-szv-molopt-sr"
SMALL_STRAIN = 0.06  # of the experimental cell: about where that basis has its minimum
MAX_TURNED = 1e-3  # of G: what a rotation may change
MAX_WIDE = 0.03  # of B: what five more per cent of strain may change


def _scan(atoms: Atoms, strains, xc: str = "GGA", **parameters: Any) -> dict[str, Any]:
    """Row of `bulk_moduli.csv` of a small scan."""
    mesh = commensurate_mesh(atoms.cell.array * (1 + max(strains)), CUTOFF_HA)
    calculator = PyscfGamma(xc=xc, mesh=mesh, tolerance_Ha=1e-6, **parameters)
    name = {"structure": "cell", "xc": xc, "ions": "clamped", "atoms": str(len(atoms))}
    points = scan_volumes(atoms, calculator, strains)
    return fit_scan([{**name, **{key: str(value) for key, value in asdict(p).items()}} for p in points])


def wide_strain(cell: Atoms) -> Verdict:
    """Same B from ±10 % as from ±5 % linear strain, and no flag but that of the two forms."""
    cell = strained(cell, SMALL_STRAIN)
    narrow = _scan(cell, (-0.05, -0.025, 0.0, 0.025, 0.05), basis=SMALL)
    wide = _scan(cell, (-0.1, -0.05, -0.025, 0.0, 0.025, 0.05, 0.1), basis=SMALL)
    change = wide["B_GPa"] / narrow["B_GPa"] - 1
    said = abs(change) < MAX_WIDE or bool(wide["flags"])
    return said, f"B {narrow['B_GPa']:.1f} -> {wide['B_GPa']:.1f} GPa ({change:+.1%}); flags: {wide['flags'] or 'none'}"


def near_dependent_basis(cell: Atoms) -> Verdict:
    """GTH-DZVP, not optimised for solids: the overlap's condition is large, the energy stays that of a bound solid."""
    mesh = commensurate_mesh(cell.cell.array, CUTOFF_HA)
    overlap = build_cell(cell, "GGA", "gth-dzvp", mesh).pbc_intor("int1e_ovlp")
    energies = {}
    for basis in ("gth-dzvp", "gth-dzvp-molopt-sr"):
        atoms = strained(cell, 0.0)
        atoms.calc = PyscfGamma(xc="GGA", basis=basis, mesh=mesh, tolerance_Ha=1e-6)
        try:
            energies[basis] = atoms.get_potential_energy() / len(atoms)
        except ScfNotConverged as error:
            return True, f"condition {np.linalg.cond(overlap):.1e}; {error}"
    apart = energies["gth-dzvp"] - energies["gth-dzvp-molopt-sr"]
    return abs(apart) < 1.0, f"condition {np.linalg.cond(overlap):.1e}; {apart:+.3f} eV/atom from the MOLOPT basis"


def unconverged(cell: Atoms) -> Verdict:
    """With two SCF cycles no strain converges: no B, every strain named."""
    fit = _scan(cell, (-0.03, -0.015, 0.0, 0.015, 0.03), basis=SMALL, max_cycles=2)
    named = all(f"strain {s:+.3f}" in fit["flags"] for s in (-0.03, -0.015, 0.0, 0.015, 0.03))
    return fit["B_GPa"] is None and named, fit["flags"]


def minimum_outside(cell: Atoms) -> Verdict:
    """A scan of a compressed cell only: V0 lies outside and the fit is flagged."""
    fit = _scan(cell, (-0.1, -0.09, -0.08, -0.07, -0.06), basis=SMALL)
    return "outside" in fit["flags"] or "no minimum" in fit["flags"], fit["flags"] or "not flagged"


def incompressible() -> Verdict:
    """ν → 0.5: refused as a range; E* falls to zero steadily on the way, always finite and positive."""
    nu = np.array([0.3, 0.4, 0.45, 0.49, 0.499, 0.499999])
    e_star = plane_strain_modulus(150.0, nu, 116.0, 0.32)
    try:
        ElasticSettings(poisson_ratio=(0.3, 0.5))
        refused = False
    except ValueError:
        refused = True
    fine = bool(np.all(np.isfinite(e_star)) and np.all(e_star > 0) and np.all(np.diff(e_star) < 0))
    return refused and fine, f"E* {e_star[0]:.1f} to {e_star[-1]:.2g} GPa; range up to 0.5 refused: {refused}"


def badly_sized(cell: Atoms, criteria: NetworkGlass, factor: float) -> Verdict:
    """A cell scaled far from its density fails the gate of glasses, and the reason is its density."""
    verdict = examine(strained(cell, factor - 1), criteria)
    return any(reason.startswith("density") for reason in verdict.reasons), "; ".join(verdict.reasons)


def collapsed_energy(cell: Atoms) -> Verdict:
    """At 60 % of the edge the SCF gives a far higher energy or an error, never a bound state."""
    mesh = commensurate_mesh(cell.cell.array, CUTOFF_HA)
    energies = []
    for strain in (0.0, -0.4):
        atoms = strained(cell, strain)
        atoms.calc = PyscfGamma(xc="GGA", basis=SMALL, mesh=mesh, tolerance_Ha=1e-6)
        try:
            energies.append(atoms.get_potential_energy() / len(atoms))
        except (ScfNotConverged, np.linalg.LinAlgError) as error:
            return True, f"strain {strain:+.1f}: {error}"
    return energies[1] > energies[0] + 1, f"{energies[1] - energies[0]:+.1f} eV/atom"


def metal(criteria: NetworkGlass) -> Verdict:
    """Aluminium has no gap: the SCF fails, or the gap is below what a glass must have."""
    atoms = bulk("Al", "fcc", 4.05, cubic=True)
    calculator = PyscfGamma(xc="GGA", basis="gth-dzvp-molopt-sr", cutoff_Ha=40.0, tolerance_Ha=1e-6, max_cycles=30)
    atoms.calc = calculator
    try:
        atoms.get_potential_energy()
    except ScfNotConverged as error:
        return True, str(error)
    return calculator.gap_eV < criteria.gap_eV, f"gap {calculator.gap_eV:.2f} eV, {criteria.gap_eV} are needed"


def too_few_points() -> Verdict:
    """Four strains are refused before anything is computed."""
    try:
        ElasticSettings(strains=(-0.02, 0.0, 0.01, 0.02))
    except ValueError as error:
        return True, str(error).splitlines()[2].strip()
    return False, "accepted"


def _under_tersoff(cell: Atoms, criteria: NetworkGlass) -> Atoms:
    atoms = strained(cell, 0.0)
    atoms.calc = tersoff_calculator(criteria.tersoff)
    return atoms


def refused(call: Callable[[], Any], words: str) -> Verdict:
    """One line that names what is wrong."""
    try:
        call()
    except InputError as error:
        return words in str(error), str(error)
    return False, "accepted"


def turned_crystal(cell: Atoms, criteria: NetworkGlass) -> Verdict:
    """The isotropic moduli of a crystal do not depend on how it is turned."""
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    means = []
    for axes in (np.eye(3), turn):
        atoms = strained(cell, 0.0)
        atoms.set_cell(atoms.cell.array @ axes, scale_atoms=True)
        atoms.calc = tersoff_calculator(criteria.tersoff)
        rest = relax_cell(atoms, 5e-3, 100)
        means.append(
            isotropic(
                elastic_response(atoms, (atoms.calc, atoms.calc), rest.hessian_eV_A2, 2e-3, 0.01, 8, 0.01).relaxed
            )
        )
    apart = abs(means[0].G / means[1].G - 1)
    return apart < MAX_TURNED, f"G {means[0].G:.2f} and {means[1].G:.2f} GPa, {apart:.1e} apart"


def saddle(cell: Atoms, criteria: NetworkGlass) -> Verdict:
    """Bonds stretched beyond their inflection push ions away from where they are: a saddle, and refused."""
    atoms, calculator = strained(cell, 0.2), tersoff_calculator(criteria.tersoff)
    return refused(
        lambda: elastic_response(atoms, (calculator, calculator), spring_hessian(cell), 2e-3, 0.01, 3, 0.01), "saddle"
    )


def unstable_body() -> Verdict:
    """A matrix with a negative eigenvalue has no moduli; the strain that lowers the energy is named."""
    C = np.diag([100.0, 100, 100, 30, 30, -2])
    return refused(lambda: isotropic(C), "unstable")


def broken_by_shear(cell: Atoms, criteria: NetworkGlass) -> Verdict:
    """A shear that breaks bonds leaves atoms without their valence: the gate names them."""
    sheared = strained(cell, 0.0)
    sheared.set_cell(cell.cell.array @ np.array([[1, 0, 0.5], [0, 1, 0.5], [0, 0, 1.0]]), scale_atoms=True)
    verdict = examine(sheared, criteria, max_defects=0)
    return verdict.defects > 0 and not verdict.passed, "; ".join(verdict.reasons)


def metallic_defect(cell: Atoms, criteria: NetworkGlass) -> Verdict:
    """A missing silicon atom leaves levels in the gap: it closes, or the SCF fails, and the structure is out."""
    broken = cell[[k for k in range(len(cell)) if k != 0]]
    engine = PyscfGamma(basis=SMALL, cutoff_Ha=CUTOFF_HA, tolerance_Ha=1e-6)
    broken.calc = engine
    try:
        broken.get_potential_energy()
    except ScfNotConverged as error:
        return True, str(error)
    return engine.gap_eV < criteria.gap_eV, f"gap {engine.gap_eV:.2f} eV, {criteria.gap_eV} are needed"


def odd_electrons(cell: Atoms) -> Verdict:
    """A missing nitrogen atom leaves an odd number of electrons: no closed shell, one line."""
    broken = cell[[k for k in range(len(cell)) if k != len(cell) - 1]]
    broken.calc = PyscfGamma(basis=SMALL, cutoff_Ha=CUTOFF_HA)
    try:
        broken.get_potential_energy()
    except CalculationFailed as error:
        return "odd" in str(error), str(error)
    return False, "an energy"


def costs_only_itself(cell: Atoms) -> Verdict:
    """An SCF that fails while constants are measured is named in the structure's row; nothing is raised."""
    engine = PyscfGamma(basis=SMALL, cutoff_Ha=CUTOFF_HA, max_cycles=2)
    measured = measure_constants(cell, engine, TensorSettings())
    return measured.response is None and "not converged" in measured.failure, measured.failure


def without_stress(cell: Atoms) -> Verdict:
    """A calculator without stress is refused before anything is computed."""

    class Blind(Calculator):
        implemented_properties = ["energy", "forces"]  # noqa: RUF012

    return refused(
        lambda: elastic_response(cell, (Blind(), Blind()), np.eye(3 * len(cell)), 0.005, 0.01, 1, 1.0), "no stress"
    )


def stability_checks(cell: Atoms, criteria: NetworkGlass) -> list[Check]:
    """Case, description, what is checked, and the check.

    Parameters
    ----------
    cell : β-Si3N4, 14 atoms
    criteria : the `network_glass` of its material
    """
    cases: list[tuple[str, str, Callable[..., Verdict], tuple]] = [
        ("strain of ±10 %", "B moves by < 3 % or the fit is flagged", wide_strain, (cell,)),
        ("near-dependent basis", "energy within 1 eV/atom or not converged", near_dependent_basis, (cell,)),
        ("unconverged SCF", "no B; every strain named", unconverged, (cell,)),
        ("minimum outside the scan", "flagged", minimum_outside, (cell,)),
        ("four strains", "refused", too_few_points, ()),
        ("Poisson ratio to 0.5", "refused; E* finite, positive, falling", incompressible, ()),
        ("collapsed cell", "fails the gate by density", badly_sized, (cell, criteria, 0.6)),
        ("exploded cell", "fails the gate by density", badly_sized, (cell, criteria, 2.0)),
        ("SCF of a collapsed cell", "far above equilibrium, or an error", collapsed_energy, (cell,)),
        ("metal", "not converged, or gap too small", metal, (criteria,)),
        ("metallic defect", "not converged, or gap too small", metallic_defect, (cell, criteria)),
        ("odd number of electrons", "one line", odd_electrons, (cell,)),
        ("strain beyond elasticity", "refused", refused, (partial(strain_states, 0.1), "no longer proportional")),
        (
            "too few strain states",
            "refused; says how many unknowns",
            refused,
            (partial(fit_stiffness, strain_states(0.01)[:8], list(np.zeros((8, 6)))), "of 7 unknowns"),
        ),
        ("unstable structure", "refused; strain named", unstable_body, ()),
        ("saddle instead of a minimum", "refused", saddle, (cell, criteria)),
        ("shear that breaks bonds", "fails the gate by valence", broken_by_shear, (cell, criteria)),
        ("calculator without stress", "refused", without_stress, (cell,)),
        ("SCF fails in a strained state", "named in the row, nothing raised", costs_only_itself, (cell,)),
        ("turned crystal", "same moduli within 1e-3", turned_crystal, (cell, criteria)),
    ]
    return [(case, judge.__doc__ or "", checks, partial(judge, *arguments)) for case, checks, judge, arguments in cases]
