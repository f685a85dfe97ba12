"""Rounding moves no result of a fit, stage by stage: hardness, D0, profiles, tip, calibration,
answer, circuit, tables of the paper and rare failures (the others: `test_steady_fits.py`).
"""

from collections.abc import Callable
from dataclasses import asdict, is_dataclass, replace
from typing import Any

import numpy as np
import pytest

from atomistic.hardness import made_up_closings
from atomistic.hardness.plateau import find_hardness
from atomistic.hardness.size_effect import fit_size_effect
from atomistic.hardness.top_attraction import (
    attract_top,
    combined_cutoffs_nm,
    contact_distance_A,
)
from mesoscale.answer.release import answer
from mesoscale.calibration.observables import NAMES, Cycles
from mesoscale.calibration.posterior import Model
from mesoscale.calibration.responses import fit_responses
from mesoscale.calibration.voltages import fit_voltages
from mesoscale.circuit.tables import tables_of
from mesoscale.inputs.table import input_table
from mesoscale.settings import TopographySettings
from mesoscale.switch import States
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.description.tip import tip_lift
from mesoscale.topography.measurements.profiles import Profile
from mesoscale.topography.profile_conversion import isotropic_spectrum
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.synthetic_scans import surface_patch, synthetic_scans
from mesoscale.uncertainty.propagation import propagate
from mesoscale.uncertainty.rare_events import Process
from tests.atomistic.hardness.test_size_effect import GLASS, h_macro, series
from tests.atomistic.hardness.test_top_attraction import DENSITY, shapes
from tests.mesoscale.calibration.conftest import MAX_FORCE_NN, made_up_observables
from tests.mesoscale.calibration.test_posterior import pull_offs
from tests.mesoscale.calibration.test_voltages import pads
from tests.mesoscale.circuit.test_tables import pad
from tests.mesoscale.topography.description import test_tip_on_grains as grains
from tests.mesoscale.topography.description.test_parameters import TRUTH, trusted_scan
from tests.mesoscale.topography.description.test_treatment import FILTERS, SIDE, found
from tests.mesoscale.uncertainty.test_propagation import SETTINGS, linear_nodes, uniform_table
from tests.test_steady_fits import MOVED, rounded

Array = np.ndarray
Change = Callable[[Array], Array]
ROUGH = RoughSpectrum.from_rms(6.0, 0.025, 2.84, 3.2)


def leaves(content: Any, name: str = "") -> dict[str, Any]:
    """All numbers and words of a result by their place in it; an array is one number."""
    if is_dataclass(content) and not isinstance(content, type):
        content = asdict(content)
    if isinstance(content, dict):
        parts = content.items()
    elif isinstance(content, (list, tuple)):
        parts = enumerate(content)
    else:
        return {name: content}
    return {
        place: leaf for key, part in parts for place, leaf in leaves(part, f"{name}.{key}").items()
    }


def hardness(change: Change) -> Any:
    """Of a closing whose stresses scatter by a twentieth."""
    rows = made_up_closings.curve(made_up_closings.plateau)
    scatter = 1.0 + 0.05 * np.random.default_rng(2).normal(size=len(rows))
    stress = change(np.array([row["contact_stress_GPa"] for row in rows]) * scatter)
    length = change(np.array([row["contact_length_nm"] for row in rows]))
    for row, of_stress, of_length in zip(rows, stress.tolist(), length.tolist(), strict=True):
        row |= {"contact_stress_GPa": of_stress, "contact_length_nm": of_length}
        row["contact_area_nm2"] = of_length**2
    # not the cell's own area: the last row would lie on the bound of what is used
    area = 0.99 * made_up_closings.CELL_AREA_NM2
    return find_hardness(rows, made_up_closings.witness(), area, made_up_closings.APPROACH_NM)


def size_effect(change: Change) -> Any:
    points = series(2.0, 8.0)
    values = change(np.array([float(point["hardness_GPa"]) for point in points]))
    points = [
        {**point, "hardness_GPa": repr(value)}
        for point, value in zip(points, values.tolist(), strict=True)
    ]
    return {
        way: fit_size_effect(
            points, GLASS, 0.05, h_macro, energies=way, indentation_GPa=(8.0, 11.0)
        )
        for way in ("measured", "scales")
    }


def cutoff(change: Change) -> Any:
    """D0 from a sphere of layers."""
    _, depths, _ = next(iter(shapes()))
    depths = -np.sort(depths[::8])
    top = attract_top(change(depths), np.full(len(depths), 8.0), 10.0, DENSITY)
    apart = contact_distance_A(float(change(np.array(DENSITY))))
    return [top, combined_cutoffs_nm([top]), apart]


def profile(change: Change) -> Any:
    points, length = 2048, 4000.0
    heights = surface_patch(ROUGH, points, length, np.random.default_rng(0))[:, 0]
    line = Profile(change(heights), length, "line")
    return vars(isotropic_spectrum(line, 5 * np.pi / length, 0.5 * np.pi * points / length))


def maps(change: Change) -> Any:
    """From heights, through levelling and trusted ranges."""
    settings = TopographySettings()
    scans = [item.scan for item in synthetic_scans(TRUTH)]
    spectra = [
        trusted_scan(replace(scan, heights_nm=change(scan.heights_nm)), settings) for scan in scans
    ]
    return analyse(spectra, settings).estimates


def treated(change: Change) -> Any:
    heights = surface_patch(ROUGH, 256, SIDE, np.random.default_rng(0))
    names = ("gaussian 2", "mean 3", "low pass", "spline 2")
    return {name: found(change(FILTERS[name][0](heights))) for name in names}


def tip(change: Change) -> Any:
    """What the tip lifted on grains."""
    spectra, quantiles, _ = grains.analysed(grains.GRAINS)
    changed = [
        replace(item, spectrum=replace(item.spectrum, psd=change(item.spectrum.psd)))
        for item in spectra
    ]
    topography = analyse(changed, grains.SETTINGS)
    seen = max(item.high for item in changed)
    mean = change(np.mean(list(quantiles.values()), axis=0))
    return tip_lift(grains.RADIUS, topography.likelihood, seen, topography.cutoff, mean)


def switches(change: Change) -> Any:
    """Switches, a third of which stick, and the inputs that they vary with."""
    prior = input_table()
    model = pads(prior, middle_V=4.0)
    known = [point.states for point in model.points]
    rows = [[of.pull_in_V, of.release_V, of.capacitance_fF + of.release_V] for of in known]
    volts = change(np.array(rows))
    points = tuple(
        replace(point, states=States(*row), halves_V=(0.99 * row[1], 1.01 * row[1]))
        for point, row in zip(model.points, volts.tolist(), strict=True)
    )
    return replace(model, points=points), prior


def voltages(change: Change) -> Any:
    model, prior = switches(change)
    x = prior.sample(50, 3)
    return {
        name: [fitted.each_V, fitted.shared_V, fitted(x)]
        for name, fitted in fit_voltages(model, prior).items()
    }


def answered(change: Change) -> Any:
    return answer(switches(change)[0])


def made_up_cycles(prior: Any) -> Cycles:
    x = prior.sample(900, 3)
    return Cycles(x, made_up_observables(x, np.random.default_rng(3)))


def observables(change: Change) -> Any:
    prior = input_table()
    cycles = made_up_cycles(prior)
    return fit_responses(NAMES, Cycles(cycles.x, change(cycles.y)), prior)


def posterior(change: Change) -> Any:
    """Of pull-offs: a chain, whose steps are the same numbers each time."""
    prior = input_table()
    model = Model(prior, made_up_cycles(prior), {}, MAX_FORCE_NN)
    data = model.posterior((pull_offs(change(np.array([60.0, 80.0, 100.0]))),))
    x = data.inputs(data.draw().z)
    return [x.mean(axis=0), x.std(axis=0)]


def circuit(change: Change) -> Any:
    law = pad(waves=0.05)
    law = replace(law, closing=change(law.closing), opening=change(law.opening))
    return {cubic: asdict(tables_of(law, cubic)) for cubic in (True, False)}


def paper_tables(change: Change) -> Any:
    """Linear responses of the paper, and regressions of runs that scatter."""
    table = uniform_table()
    nodes = linear_nodes(table, [1.0, 2.0, 3.0], scatter=0.1)
    x = table.sample(300, 9)
    closing = 10.0 + x @ np.array([1.0, 2.0, 3.0]) + x[:, 0] * x[:, 1]
    closing += 0.1 * np.random.default_rng(1).normal(size=len(x))
    runs = change(np.stack([closing] * 4 + [2.0 * closing] * 4, axis=1))
    changed = replace(nodes, values=change(nodes.values))
    propagated = propagate(changed, table, SETTINGS, (x, runs))
    return [propagated.by_seed, propagated.variances, propagated.outputs.mean(axis=0)]


def rare_failures(change: Change) -> Any:
    """The process of the reserve; the library's own search moved its deviation by a factor of 2."""
    rng = np.random.default_rng(3)
    x = rng.random((60, 4))
    y = np.sin(3.0 * x[:, 0]) + x[:, 1] ** 2 + 0.05 * rng.normal(size=60)
    return Process(x, change(y))(rng.random((20, 4)))


QUICK = (
    hardness,
    size_effect,
    cutoff,
    treated,
    voltages,
    answered,
    observables,
    circuit,
    paper_tables,
    rare_failures,
)
SLOW = (profile, maps, tip, posterior)


@pytest.mark.parametrize(("of", "turns"), [*((of, 3) for of in QUICK), *((of, 1) for of in SLOW)])
def test_rounding_moves_no_result_of_a_stage(of, turns):
    """Numbers of an array by its largest, as some are differences that rounding leaves."""
    exact = leaves(of(np.asarray))
    for turn in range(turns):
        other = leaves(of(lambda values, turn=turn: rounded(values, turn)))
        assert other.keys() == exact.keys()
        for name, value in exact.items():
            if isinstance(value, (float, np.ndarray)):
                largest = np.nanmax(np.abs(value), initial=0.0)
                near = pytest.approx(value, rel=MOVED, abs=MOVED * largest, nan_ok=True)
                assert np.shape(other[name]) == np.shape(value), name
                assert other[name] == near, name
            else:
                assert str(other[name]) == str(value), name
