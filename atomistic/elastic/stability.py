"""Stiff and extreme cases of the elastic stage, each judged by what must hold (target `stability`).

What the engine cannot compute must be refused or flagged; a plausible number would be wrong. The
cells are small ones of the material's first crystal, in the smallest basis: a hard case costs a
second at most.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np
from ase import Atoms
from ase.build import bulk
from ase.calculators.calculator import CalculationFailed

from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.elastic.dft import SCF, PyscfGamma
from atomistic.elastic.energy_scans import STRAINS, fit_scan, scan_volumes
from atomistic.elastic.equation_of_state import EquationOfState, fit_equation_of_state, vinet
from atomistic.elastic.networks import crystal, examine, no_insulator
from atomistic.elastic.relaxation import last_gap_eV, strained
from atomistic.for_studies import HardCase, Verdict, refused
from atomistic.materials import Material, NetworkGlass

CHEAP = {"basis": "gth-szv-molopt-sr", "cutoff_Ha": 40.0, "max_cycles": SCF.max_cycles}
REFUSED = "not converged, or its gap is too small: no energy counts"
GATED = "refused by the gate of glasses"
FLAGGED = "the fit is flagged: no modulus counts"
ONE_LINE = "refused in one line"
VOLUMES_A3 = np.linspace(270.0, 330.0, 7)
B_GPA = 235.0
NOISE = np.array([1.0, -2.0, 1.5, 0.5, -1.5, 2.0, -1.0])


def hard_cases(material: Material) -> list[HardCase]:
    """The cases of a material with a `network_glass` and a crystal."""
    glass: NetworkGlass = material.part("network_glass")
    cell = crystal(material, next(iter(material.crystals)), (1, 1, 1))
    return [
        *_engine_cases(cell, glass),
        *_structure_cases(cell, glass),
        *_scan_cases(cell),
        *curve_cases(),
    ]


def _engine_cases(cell: Atoms, glass: NetworkGlass) -> list[HardCase]:
    """Cells that density functional theory of closed shells cannot compute."""
    symbols = np.array(cell.get_chemical_symbols())
    cation = int(np.flatnonzero(symbols == "Si")[0])
    anion = int(np.flatnonzero(symbols == "N")[0])
    silicon = bulk("Si", "diamond", 5.43)
    overlapping = silicon.copy()
    overlapping.positions[1] = overlapping.positions[0]
    aluminium = bulk("Al", "fcc", 4.05, cubic=True)
    conducting = [
        ("metal", "aluminium: no gap", aluminium),
        (
            "missing atom",
            "one Si taken out: its neighbours' levels close the gap",
            _without(cell, cation),
        ),
        ("one kind of atoms", "N in the places of a metal", bulk("N", "fcc", 4.0, cubic=True)),
        (
            "overstrained cell",
            "silicon with edges 25 % longer: all bonds broken",
            strained(silicon, 0.25),
        ),
        ("overlapping atoms", "both Si of silicon at one place", overlapping),
        ("tiny cell", "one Si in a cube of 2.7 Å", Atoms("Si", cell=[2.7] * 3, pbc=True)),
    ]
    cases = [
        HardCase(name, words, REFUSED, partial(no_energy, atoms, glass))
        for name, words, atoms in conducting
    ]
    odd = partial(
        refused,
        partial(_energy_eV, _without(cell, anion)),
        "odd number of electrons",
        CalculationFailed,
    )
    one_cycle = partial(_energy_eV, _shaken(silicon), max_cycles=1, tolerance_Ha=1e-11)
    return [
        *cases,
        HardCase("odd number of electrons", "one N taken out", ONE_LINE, odd),
        HardCase(
            "self-consistency cut short",
            "one cycle",
            "an error, not an energy",
            partial(refused, one_cycle, "not converged in 1 cycles", CalculationFailed),
        ),
        HardCase(
            "collapsed cell",
            "edges at 60 %",
            "1 eV per atom above the crystal or more, or refused",
            partial(_collapsed, cell),
        ),
    ]


def _structure_cases(cell: Atoms, glass: NetworkGlass) -> list[HardCase]:
    """Cells that are no glass of the material, by their gate."""
    symbols = np.array(cell.get_chemical_symbols())
    anions = np.flatnonzero(symbols == "N")
    moved = cell.copy()
    moved.positions[anions[0], 2] += 0.9
    sheared = cell.copy()
    sheared.set_cell(
        cell.cell.array @ np.array([[1, 0, 0.5], [0, 1, 0.5], [0, 0, 1.0]]), scale_atoms=True
    )
    close = cell.copy()
    close.positions[1] = close.positions[0]
    molecule = Atoms("N2", positions=[[0, 0, 0], [1.1, 0, 0]], cell=[40.0] * 3, pbc=True)
    judged = [
        ("collapsed network", "edges at 70 %", strained(cell, -0.3), "density"),
        ("exploded network", "edges at 140 %", strained(cell, 0.4), "density"),
        ("far too large cell", "a molecule in a cube of 40 Å", molecule, "density"),
        ("network of one kind", "the N of the crystal alone", cell[anions], "coordination of Si"),
        ("overlapping network", "two atoms at one place", close, "distance"),
        ("broken bond", "one N moved by 0.9 Å", moved, "valence"),
        ("sheared network", "a shear that breaks bonds", sheared, "valence"),
        ("crystal", "a perfect network with symmetry", cell, "crystal"),
    ]
    return [
        HardCase(name, words, GATED, partial(_gated, atoms, glass, why))
        for name, words, atoms, why in judged
    ]


def _scan_cases(cell: Atoms) -> list[HardCase]:
    """Scans of which energies are missing."""
    lost = _without(cell, int(np.flatnonzero(np.array(cell.get_chemical_symbols()) == "N")[0]))
    return [
        HardCase(
            "scan without an energy",
            "every calculation fails",
            "the scan goes to its end, names the reason, and has no modulus",
            partial(_failed_scan, lost),
        )
    ]


def curve_cases() -> list[HardCase]:
    """Made-up E(V): those that tell no bulk modulus, and stiff and soft ones that do."""
    volumes = VOLUMES_A3
    sound = made_up_eV(volumes)
    with_nan = np.where(volumes == volumes[2], np.nan, sound)
    jump = np.where(volumes > 300.0, sound + 0.5, sound)
    flagged = [
        (
            "minimum outside the scan",
            "equilibrium at 350 of 270 to 330 Å3",
            made_up_eV(volumes, 350.0),
            "outside",
        ),
        ("no minimum", "energy falls with volume throughout", -0.001 * volumes, "no minimum"),
        ("energies that do not tell B", "noise of 0.3 eV", sound + 0.2 * NOISE, "scatter about"),
        ("energies that jump", "0.5 eV more beyond equilibrium", jump, ""),
        ("equal energies", "a flat curve", np.zeros(7), ""),
    ]
    refusals = [
        ("few points", "four volumes", volumes[:4], sound[:4], "at least 5 are needed"),
        (
            "duplicates",
            "seven points at four volumes",
            volumes[[0, 0, 1, 1, 2, 2, 3]],
            sound,
            "at least 5 are needed",
        ),
        ("energy without a number", "one of seven is NaN", volumes, with_nan, "energies finite"),
        ("volume of zero", "one of seven", volumes - volumes[0], sound, "volumes must be positive"),
    ]
    solids = [
        ("stiffest", "B = 10,000 GPa", 1e4),
        ("softest", "B = 0.1 GPa", 0.1),
    ]
    return [
        *(
            HardCase(name, words, FLAGGED, partial(_flagged, energies, why))
            for name, words, energies, why in flagged
        ),
        *(
            HardCase(
                name, words, ONE_LINE, partial(refused, partial(fit_equation_of_state, x, y), why)
            )
            for name, words, x, y, why in refusals
        ),
        *(
            HardCase(name, words, "B comes back within 1 %", partial(_comes_back, B))
            for name, words, B in solids
        ),
        HardCase(
            "noise that is known",
            "0.015 eV on a curve of 5 eV",
            "B within three of its standard errors, without a flag",
            partial(_known_noise, sound),
        ),
    ]


def made_up_eV(volumes_A3: np.ndarray, V0_A3: float = 300.0, B_GPa: float = B_GPA) -> np.ndarray:
    """E(V) of a solid, eV."""
    return vinet(volumes_A3, V0_A3, -5000.0, B_GPa / EV_PER_A3_IN_GPA, 4.2)


def no_energy(atoms: Atoms, glass: NetworkGlass) -> Verdict:
    """Whether a cell is refused: no energy, or a gap that is too small."""
    trial = atoms.copy()
    trial.calc = calculator = PyscfGamma(**CHEAP)
    try:
        trial.get_potential_energy()
    except (CalculationFailed, np.linalg.LinAlgError) as error:
        return True, str(error)
    gap_eV = last_gap_eV(calculator)
    return bool(no_insulator(gap_eV, glass)), f"gap {gap_eV:.2f} eV, {glass.gap_eV} are needed"


def _energy_eV(atoms: Atoms, **parameters: float) -> float:
    trial = atoms.copy()
    trial.calc = PyscfGamma(**{**CHEAP, **parameters})
    return float(trial.get_potential_energy())


def _collapsed(cell: Atoms) -> Verdict:
    usual = _energy_eV(cell)
    try:
        collapsed = _energy_eV(strained(cell, -0.4))
    except (CalculationFailed, np.linalg.LinAlgError) as error:
        return True, str(error)
    above = (collapsed - usual) / len(cell)
    return above > 1.0, f"{above:+.1f} eV per atom"


def _gated(atoms: Atoms, glass: NetworkGlass, why: str) -> Verdict:
    reasons = examine(atoms, glass, max_defects=0).reasons
    return any(why in reason for reason in reasons), "; ".join(reasons)


def _failed_scan(atoms: Atoms) -> Verdict:
    points = scan_volumes(atoms, PyscfGamma(**CHEAP), STRAINS)
    head = {"structure": "lost", "xc": "GGA", "ions": "clamped", "atoms": str(len(atoms))}
    rows = [{**head, "converged": str(point.converged), "detail": point.detail} for point in points]
    fit = fit_scan(rows)
    named = "0 of 5 strains converged" in fit["flags"] and "odd number of electrons" in fit["flags"]
    return len(points) == len(STRAINS) and named and fit["B_GPa"] is None, fit["flags"]


def _flagged(energies_eV: np.ndarray, why: str) -> Verdict:
    fit = fit_equation_of_state(VOLUMES_A3, energies_eV)
    return any(why in flag for flag in fit.flags), _words(fit)


def _comes_back(B_GPa: float) -> Verdict:
    fit = fit_equation_of_state(VOLUMES_A3, made_up_eV(VOLUMES_A3, B_GPa=B_GPa))
    return not fit.flags and abs(fit.B_GPa / B_GPa - 1) < 0.01, _words(fit)


def _known_noise(energies_eV: np.ndarray) -> Verdict:
    fit = fit_equation_of_state(VOLUMES_A3, energies_eV + 0.01 * NOISE)
    return not fit.flags and abs(fit.B_GPa - B_GPA) < 3 * fit.B_error_GPa, _words(fit)


def _words(fit: EquationOfState) -> str:
    return (
        f"B {fit.B_GPa:.4g} +- {fit.B_error_GPa:.2g} GPa; flags: {'; '.join(fit.flags) or 'none'}"
    )


def _without(cell: Atoms, index: int) -> Atoms:
    remaining: Sequence[int] = [k for k in range(len(cell)) if k != index]
    return cell[remaining]


def _shaken(cell: Atoms) -> Atoms:
    """The crystal leaves self-consistency little to do."""
    shaken = cell.copy()
    shaken.rattle(0.1, seed=1)
    return shaken
