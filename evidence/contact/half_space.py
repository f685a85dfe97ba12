"""How near are forces and areas of the coupled engine to those of tamaas, another code?

Both press the same periodic surfaces, the engine to the separations that tamaas finds: elastic,
with saturated pressure, and unloading what plastic closing has flattened. tamaas (L. Frerot et al.,
J. Open Source Softw. 5 (2020) 2121) needs the optional extra `peers`.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from evidence.contact.draws import MIDDLE
from mesoscale.contact import ContactInputs, run_cycle
from mesoscale.contact.coupled.engine import CoupledContact
from mesoscale.contact.coupled.grid import Grid
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

HARDNESS_GPA = 4.0  # of the comparison with saturated pressure
CELL_NM = 62.5  # side of 64 sites
LOADS_NN = {  # on 64 x 64 sites, up to near full contact
    "elastic": (1e2, 1e3, 1e4, 8e4, 3e5),
    "nonlinear": (1e2, 1e3, 5e3, 1.4e4),
    "unloading": (1.9e3, 1e3, 200.0, 20.0),
}


class Pressed(NamedTuple):
    """What tamaas finds under one load.

    Attributes
    ----------
    pressure : (N, N), GPa.
    separation_nm : of the mean planes.
    """

    pressure: np.ndarray
    separation_nm: float


def by_tamaas(
    heights: np.ndarray,
    length_nm: float,
    load_nN: float,
    e_star: float,
    hardness: float | None = None,
    tolerance: float = 1e-10,
) -> Pressed:
    """Contact of (N, N) heights in nm, mean zero, at their minima, with a half-space of E* and a
    hardness (GPa).
    """
    import tamaas  # pyright: ignore[reportMissingImports]  (optional extra)

    tamaas.set_log_level(tamaas.LogLevel.error)
    model = tamaas.Model(tamaas.model_type.basic_2d, [length_nm] * 2, list(heights.shape))
    model.E, model.nu = e_star, 0.0  # E/(1 - nu^2) = E*
    if hardness is None:
        solver = tamaas.PolonskyKeerRey(model, -heights, tolerance)
    else:
        solver = tamaas.KatoSaturated(model, -heights, tolerance, hardness)
    solver.max_iter = 5000
    solver.solve(load_nN / length_nm**2)
    p = np.array(model.traction).reshape(heights.shape)
    # its displacement holds the plastic part, too
    u = Grid(len(heights), length_nm, e_star).displacement(p.ravel()).reshape(heights.shape)
    elastic = p > 0 if hardness is None else (p > 0) & (p < hardness * (1 - 1e-9))
    return Pressed(p, float(-(heights + u)[elastic].mean()))


def arguments(parser: argparse.ArgumentParser) -> None:
    """Grid and surfaces."""
    parser.add_argument("--pixels", type=int, default=64)
    parser.add_argument("--surfaces", type=int, default=10)


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each kind and load: largest differences over the surfaces."""
    length = CELL_NM * given.pixels / 64
    inputs = ContactInputs(
        **{**vars(MIDDLE), "h_macro": HARDNESS_GPA, "h_prime": 0.0, "q0": 0.15, "rms": 2.0}
    )
    settings = ContactSettings(mechanics="coupled", pixels=given.pixels, length_nm=length)
    for kind, loads in LOADS_NN.items():
        chosen = settings.model_copy(
            update={"model": "nonlinear" if kind == "nonlinear" else "elastic"}
        )
        surfaces = [random_surface(inputs, settings, seed) for seed in range(1, given.surfaces + 1)]
        if kind == "unloading":
            surfaces = [_flattened(heights, inputs, settings) for heights in surfaces]
        for load in (load * (given.pixels / 64) ** 2 for load in loads):
            differences = [_difference(heights, inputs, chosen, load) for heights in surfaces]
            force, sites, share = np.max(np.abs(differences), axis=0).tolist()
            yield {
                "kind": kind,
                "pixels": given.pixels,
                "surfaces": len(surfaces),
                "load_nN": load,
            } | {
                "largest_share_of_area": share,
                "force_difference": force,
                "sites_difference": sites,
            }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """The largest difference of force, of any kind."""
    worst = max(float(row["force_difference"]) for row in rows)
    most = max(float(row["largest_share_of_area"]) for row in rows)
    return {"force_difference": f"{worst:.0e}", "share": f"{100 * most:.0f} %"}


def _flattened(heights: np.ndarray, inputs: ContactInputs, settings: ContactSettings) -> np.ndarray:
    load = 2e3 * (settings.pixels / 64) ** 2
    bare = replace(inputs, hamaker=0.0)
    flattened = run_cycle(
        bare, settings, 0, load, heights, keep_surface=True, contact_at="lowest"
    ).heights
    assert flattened is not None
    return flattened


def _difference(
    heights: np.ndarray, inputs: ContactInputs, settings: ContactSettings, load_nN: float
) -> tuple[float, float, float]:
    """Relative differences of force and touching sites at the separation of tamaas, and the share
    of sites.
    """
    hardness = HARDNESS_GPA if settings.model == "nonlinear" else None
    wanted = by_tamaas(heights, settings.length_nm, load_nN, inputs.e_star, hardness, 1e-8)
    touching = int((wanted.pressure > 0).sum())
    moved = CoupledContact(heights.copy(), inputs, settings).move_to(wanted.separation_nm, False)
    return moved.force / load_nN - 1, moved.sites / touching - 1, touching / heights.size
