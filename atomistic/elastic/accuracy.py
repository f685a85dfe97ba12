"""Error of the bulk modulus of a scene's glasses against run time, one numerical choice at a time.

The choices are the width of the strains, their number, the cut-off of the density, the steps of the
relaxation and the number of glasses. Energies of the scene's own scans are used again, and orbitals
as well: every calculation starts from those of the ones before.
"""

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, partial

import numpy as np
from ase import Atoms
from ase.calculators.calculator import CalculationFailed
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from asperity.guards.errors import InputError
from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.elastic.dft import PyscfGamma, Solution, make_calculator
from atomistic.elastic.energy_scans import STRAINS
from atomistic.elastic.equation_of_state import fit_equation_of_state
from atomistic.elastic.relaxation import relax_ions, strained
from atomistic.for_studies import Deviations, Variation
from atomistic.settings import DftSettings

WIDTHS = (0.05, 0.03, 0.02, 0.01)
"""Largest strains that are tried; Kim et al. (2013) strained by 5 %."""
EVERY = 0.005
"""Strain between the points of the reference for the number of strains."""
DEGREE = 5
"""Of the reference curve of all strains: degree 3 misses energies of a glass by 0.9 meV, degree 5
by 0.01 meV.
"""
CUTOFF = 0.8
FINER_CUTOFF = 1.4
"""Cut-offs over the one in use; at six tenths of 50 Ha a modulus is wrong by half."""
FURTHER_STEPS = 2
"""Ionic steps beyond those in use, which cost two energies each."""
AT_REST_EV_A = 0.05
"""Largest force at which the further steps end."""
MODULUS = [("B", "%")]
Fitted = tuple[float, float]
"""A bulk modulus and its standard error by the misfit, GPa."""


@dataclass(eq=False)
class ScannedGlass:
    """A relaxed glass of the scene with the energies of its scan by PBE.

    Attributes
    ----------
    energies_eV : by strain, those of the scan; others are added as they are computed.
    seconds : processor time of each energy that was computed here.
    step_seconds : processor time of an ionic step beyond those of the scene.
    solutions : former ones, from which the next calculation starts.
    """

    atoms: Atoms
    dft: DftSettings
    energies_eV: dict[float, float] = field(default_factory=dict)
    seconds: list[float] = field(default_factory=list)
    step_seconds: float = float("nan")
    solutions: list[Solution] = field(default_factory=list)

    def modulus(self, strains: Sequence[float]) -> Fitted:
        """B by the fit of the stage; NaN where an energy is missing."""
        volumes, energies = self.curve(strains)
        if not np.isfinite(energies).all():
            return np.nan, np.nan
        fit = fit_equation_of_state(volumes, energies)
        return fit.B_GPa, fit.B_error_GPa

    def curve(self, strains: Sequence[float]) -> tuple[list[float], list[float]]:
        """Volumes (Å³) and energies (eV), NaN where the calculation fails."""
        # from small strains outwards, as the stage does: each starts from its neighbours
        missing = sorted(set(strains) - set(self.energies_eV), key=abs)
        calculator = self._calculator()
        for strain in missing:
            trial = strained(self.atoms, strain)
            trial.calc = calculator
            started = time.process_time()
            self.energies_eV[strain] = np.nan
            with suppress(CalculationFailed, np.linalg.LinAlgError):
                self.energies_eV[strain] = float(trial.get_potential_energy())
            self.seconds.append(time.process_time() - started)
        self.solutions = calculator.history
        volume = self.atoms.get_volume()
        return [volume * (1 + strain) ** 3 for strain in strains], [
            self.energies_eV[strain] for strain in strains
        ]

    def with_cutoff(self, cutoff_Ha: float) -> "ScannedGlass":
        """The same atoms on another mesh, without energies."""
        dft = self.dft.model_copy(update={"cutoff_Ha": cutoff_Ha})
        return ScannedGlass(self.atoms, dft, solutions=list(self.solutions))

    def relaxed_further(self) -> "ScannedGlass":
        """The glass after some more ionic steps, without energies."""
        atoms = strained(self.atoms, 0.0)
        atoms.calc = calculator = self._calculator(forces=True)
        started = time.process_time()
        done = relax_ions(atoms, AT_REST_EV_A, FURTHER_STEPS)
        self.step_seconds = (time.process_time() - started) / max(done.steps, 1)
        return ScannedGlass(strained(atoms, 0.0), self.dft, solutions=calculator.history)

    def _calculator(self, forces: bool = False) -> PyscfGamma:
        """On the mesh of the stage's own scans."""
        largest_cell = self.atoms.cell.array * (1 + max(STRAINS))
        calculator = make_calculator(self.dft, "GGA", largest_cell, forces=forces)
        calculator.history = list(self.solutions)
        return calculator


def variations(
    glasses: Sequence[ScannedGlass], moduli_GPa: Sequence[float], scan_s: float
) -> list[Variation]:
    """The numerical choices of the stage.

    Parameters
    ----------
    glasses : samples of all choices but the last, with whole scans.
    moduli_GPa : of all glasses of the scene that count.
    scan_s : seconds that the scan of one of them took.

    Raises
    ------
    InputError : no glass.
    """
    if not glasses:
        raise InputError(
            "elastic: no glass of the scene has a whole scan, so that there is nothing to study"
        )
    choices = [_widths(glasses), _numbers(glasses), _cutoffs(glasses)]
    if glasses[0].dft.relaxation_steps:
        choices.append(_relaxations(glasses))
    if len(moduli_GPa) > 1:
        choices.append(_ensembles(moduli_GPa, scan_s))
    return choices


def _widths(glasses: Sequence[ScannedGlass]) -> Variation:
    """The largest strain."""
    all_strains = sorted({strain for width in WIDTHS for strain in five_strains(width)})

    def reference(glass: ScannedGlass) -> Fitted:
        volumes, energies = map(np.array, glass.curve(all_strains))
        known = np.isfinite(energies)
        return modulus_of_polynomial(volumes[known], energies[known], DEGREE), 0.0

    values = []
    for width in WIDTHS:
        fitted = partial(_by_strains, five_strains(width))
        values.append((width, _each(glasses, fitted, reference, partial(_scan_s, glasses))))
    words = f"a polynomial of degree {DEGREE} through the energies of all widths"
    return Variation(
        "largest strain", MODULUS, values, max(STRAINS), words, samples=_counted(glasses)
    )


def _numbers(glasses: Sequence[ScannedGlass]) -> Variation:
    """How many strains lie within the largest one."""
    largest = max(STRAINS)
    finest = round(2 * largest / EVERY) + 1
    reference = partial(_by_strains, even_strains(largest, finest))
    numbers = (len(STRAINS), (finest + 1) // 2)
    values = []
    for number in numbers:
        fitted = partial(_by_strains, even_strains(largest, number))
        values.append(
            (number, _each(glasses, fitted, reference, partial(_scan_s, glasses, number)))
        )
    words = f"{finest} strains"
    return Variation(
        "number of strains", MODULUS, values, len(STRAINS), words, samples=_counted(glasses)
    )


def _cutoffs(glasses: Sequence[ScannedGlass]) -> Variation:
    """The cut-off of the density."""
    used = glasses[0].dft.cutoff_Ha

    @cache
    def at(factor: float, glass: ScannedGlass) -> ScannedGlass:
        if factor == 1.0:
            return glass
        return glass.with_cutoff(factor * used)

    def fitted(factor: float, glass: ScannedGlass) -> Fitted:
        return _by_strains(STRAINS, at(factor, glass))

    def seconds(factor: float) -> float:
        return _scan_s([at(factor, glass) for glass in glasses])

    values = []
    for factor in (CUTOFF, 1.0):
        deviations = _each(
            glasses,
            partial(fitted, factor),
            partial(fitted, FINER_CUTOFF),
            partial(seconds, factor),
        )
        values.append((round(factor * used, 6), deviations))
    words = f"{FINER_CUTOFF * used:g} Ha"
    return Variation(
        "cut-off of the density, Ha", MODULUS, values, used, words, samples=_counted(glasses)
    )


def _relaxations(glasses: Sequence[ScannedGlass]) -> Variation:
    """The ionic steps before the scan."""
    used = glasses[0].dft.relaxation_steps

    def further(glass: ScannedGlass) -> Fitted:
        try:
            return glass.relaxed_further().modulus(STRAINS)
        except CalculationFailed:
            return np.nan, np.nan

    def seconds() -> float:
        return used * float(np.mean([glass.step_seconds for glass in glasses]))

    values = [(used, _each(glasses, partial(_by_strains, STRAINS), further, seconds))]
    words = f"{FURTHER_STEPS} more steps"
    return Variation("most ionic steps", MODULUS, values, used, words, samples=_counted(glasses))


def _ensembles(moduli_GPa: Sequence[float], scan_s: float) -> Variation:
    """The number of glasses: the standard error of their mean, by the scatter of all."""
    B = np.asarray(moduli_GPa, float)
    scatter = 100 * float(B.std(ddof=1) / B.mean())

    def deviations(count: int) -> Deviations:
        error = np.array([scatter / np.sqrt(count)])
        error_of_error = error / np.sqrt(2 * (len(B) - 1))
        return Deviations(error[None], error_of_error, count * scan_s)

    values = [(count, partial(deviations, count)) for count in range(1, len(B) + 1)]
    reference = f"the mean of all possible ones, by the scatter of {len(B)}"
    return Variation("glasses", MODULUS, values, len(B), reference, "")


def _each(
    glasses: Sequence[ScannedGlass],
    value: Callable[[ScannedGlass], Fitted],
    reference: Callable[[ScannedGlass], Fitted],
    seconds: Callable[[], float],
) -> Callable[[], Deviations]:
    """How far a value is off on some glasses; each fit's misfit says how well that is known."""

    def deviations() -> Deviations:
        fitted = np.array([value(glass) for glass in glasses])
        best = np.array([reference(glass) for glass in glasses])
        off = 100 * (fitted[:, 0] / best[:, 0] - 1)
        misfits = 100 * np.hypot(fitted[:, 1], best[:, 1]) / best[:, 0]
        noise = np.sqrt(np.mean(misfits**2) / len(glasses))
        return Deviations(off[:, None], np.array([noise]), seconds())

    return deviations


def _scan_s(glasses: Sequence[ScannedGlass], number: int = len(STRAINS)) -> float:
    """Processor seconds of a scan of so many strains."""
    return number * float(np.mean([second for glass in glasses for second in glass.seconds]))


def _by_strains(strains: Sequence[float], glass: ScannedGlass) -> Fitted:
    return glass.modulus(strains)


def _counted(glasses: Sequence[ScannedGlass]) -> str:
    return "1 glass" if len(glasses) == 1 else f"{len(glasses)} glasses"


def five_strains(largest: float) -> list[float]:
    """As many as the stage takes, evenly between both signs of the largest."""
    return even_strains(largest, len(STRAINS))


def even_strains(largest: float, number: int) -> list[float]:
    """An odd number of strains between both signs of the largest; equal to the last bit."""
    half = number // 2
    return [round(largest * k / half, 9) for k in range(-half, half + 1)]


def modulus_of_polynomial(volumes_A3: ArrayLike, energies_eV: ArrayLike, degree: int) -> float:
    """Bulk modulus of a polynomial in V^(-2/3) through energies, GPa: V E'' where E is least.

    Raises
    ------
    InputError : it has no minimum between the volumes.
    """
    volumes = np.asarray(volumes_A3, float)
    energies = np.asarray(energies_eV, float)
    x = volumes ** (-2 / 3)
    curve = Polynomial.fit(x, energies - energies.mean(), degree)
    real = [root.real for root in curve.deriv().roots() if abs(root.imag) < 1e-12]
    inside = [root for root in real if x.min() < root < x.max()]
    minima = [root for root in inside if curve.deriv(2)(root) > 0]
    if not minima:
        raise InputError("elastic: energies of the study have no minimum between its strains")
    lowest = min(minima, key=curve)
    V = lowest**-1.5
    slope_of_x = -2 / 3 * lowest / V
    return float(V * curve.deriv(2)(lowest) * slope_of_x**2 * EV_PER_A3_IN_GPA)
