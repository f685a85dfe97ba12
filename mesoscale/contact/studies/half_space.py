"""What the neglect of elastic coupling costs: single asperities beside an elastic half-space (docs/coupling.md).

The half-space is solved by tamaas (conjugate gradients of Polonsky and Keer on an FFT boundary-element grid,
periodic, no friction, no adhesion): every contact bends the surface under all others. The model presses each
asperity on its own and takes the plane section for its area.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mesoscale.contact.cycle import Branch, run_cycle
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings, CouplingSettings
from mesoscale.topography.synthesis import synthesize

PREFACTORS = ("hertz", "paper")
MISSING = (
    "coupling.surfaces: the elastic half-space needs tamaas, which is not installed; "
    "uv sync --locked --all-groups --extra peers, then run again"
)


@dataclass(frozen=True)
class HalfSpace:
    """A rough surface pressed by a rigid flat against an elastic half-space.

    Attributes
    ----------
    separation_nm : mean plane of the surface to the flat, as in the contact model.
    error : relative error of the solver.
    """

    separation_nm: float
    contact_area_nm2: float
    error: float
    wall_s: float


def solve_half_space(
    heights: np.ndarray, length_nm: float, e_star_GPa: float, load_nN: float, settings: CouplingSettings
) -> HalfSpace:
    """Elastic contact of a periodic surface with all its asperities coupled.

    Parameters
    ----------
    heights : (N, N), nm, mean zero; contact is at the minima

    Raises
    ------
    InputError : tamaas is not installed.
    """
    try:
        import tamaas  # pyright: ignore[reportMissingImports]  # an optional extra
    except ImportError:
        raise InputError(MISSING) from None
    tamaas.set_log_level(tamaas.LogLevel.error)
    start = time.perf_counter()
    model = tamaas.Model(tamaas.model_type.basic_2d, [length_nm, length_nm], list(heights.shape))
    model.E, model.nu = e_star_GPa, 0.0  # E/(1 - nu^2) = E*
    solver = tamaas.PolonskyKeerRey(model, -heights, settings.tolerance)
    solver.max_iter = settings.max_iterations
    error = solver.solve(load_nN / length_nm**2)
    touching = model.traction > 0
    return HalfSpace(
        # the solver's displacement holds the flat's approach: it is the local distance from the undeformed plane
        float(model.displacement.mean()),
        float(touching.mean()) * length_nm**2,
        float(error),
        time.perf_counter() - start,
    )


def compare(
    inputs: ContactInputs,
    contact: ContactSettings,
    settings: CouplingSettings,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[dict[str, Any]]:
    """Rows of coupling/comparison.csv: both models at each load, for each surface and prefactor of eq. 3."""
    if settings.surfaces == 0:
        raise InputError("coupling.surfaces = 0: no surface is asked for; give a number of surfaces in the scene")
    total = settings.surfaces * len(settings.loads_nN)
    for done in range(settings.surfaces):
        seed = contact.nominal_seed + done
        heights = synthesize(
            settings.pixels,
            contact.length_nm,
            inputs.q0,
            inputs.hurst,
            inputs.rms,
            seed,
            contact.convention,
            contact.q1_per_nm,
        )
        heights -= heights.mean()
        curves = {
            prefactor: _single_asperities(heights, inputs, contact, settings, prefactor) for prefactor in PREFACTORS
        }
        for number, load in enumerate(sorted(settings.loads_nN)):
            coupled = solve_half_space(heights, contact.length_nm, inputs.e_star, load, settings)
            for prefactor, curve in curves.items():
                yield _row(seed, load, prefactor, curve, coupled, settings)
            if progress is not None:
                progress((done * len(settings.loads_nN) + number + 1) / total, f"surface {seed}, {load:g} nN")


def _single_asperities(
    heights: np.ndarray, inputs: ContactInputs, contact: ContactSettings, settings: CouplingSettings, prefactor: str
) -> Branch:
    """Closing branch of the elastic model beyond the largest load, without attraction."""
    changes = {"model": "elastic", "prefactor": prefactor, "pixels": settings.pixels, "force_steps": 160}
    repulsion_only = ContactInputs(**{**vars(inputs), "hamaker": 0.0})
    # beyond the loads, so that the force at the coupled separation is on the curve, too
    force = 4 * max(settings.loads_nN)
    return run_cycle(repulsion_only, contact.model_copy(update=changes), 0, force, heights).closing


def _row(
    seed: int, load: float, prefactor: str, curve: Branch, coupled: HalfSpace, settings: CouplingSettings
) -> dict[str, Any]:
    touching = curve.repulsive_nN > 0
    force, separation = curve.repulsive_nN[touching], curve.separation_nm[touching]
    single = float(np.interp(load, force, separation))
    area = float(np.interp(load, force, curve.contact_area_nm2[touching]))
    # separations fall along the branch; np.interp wants them to rise
    at_same_separation = float(np.interp(coupled.separation_nm, separation[::-1], force[::-1], left=np.nan, right=0.0))
    return {
        "seed": seed,
        "load_nN": load,
        "prefactor": prefactor,
        "separation_nm": single,
        "separation_coupled_nm": coupled.separation_nm,
        "contact_area_nm2": area,
        "contact_area_coupled_nm2": coupled.contact_area_nm2,
        "force_ratio": at_same_separation / load,
        "solver_error": coupled.error,
        "solved": coupled.error <= settings.tolerance,
        "wall_s": round(coupled.wall_s, 3),
    }
