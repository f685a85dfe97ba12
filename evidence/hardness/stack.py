"""How does an oxide film on titanium share its hardness with the metal, against contact length over thickness?

A film of silica is cut out of its glass after the asperity's shape, laid on an asperity of polycrystalline titanium,
and welded by an anneal. Nobody knows how atoms of the two potentials act on each other. The stated assumption is a
Morse bond of titanium and oxygen, and a short-range repulsion of titanium and silicon; its work of separation is a
gate. Glass and metal by themselves are pressed in the same way, and the share of the film is
(H - H_metal) / (H_glass - H_metal) at equal contact length.
"""

import io
import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from atomistic.constants import AVOGADRO, EV_PER_A3_IN_GPA
from atomistic.errors import InputError
from atomistic.hardness.asperity import cut_asperity, formula_of, neutralise, profile, remove_strays
from atomistic.hardness.contact_area import Area, calibrated
from atomistic.hardness.glass import make_glass
from atomistic.hardness.pressing import base_thickness_nm, plan_closing, prepare_body
from atomistic.hardness.runs import PROTOCOL, ClosingRun
from atomistic.hardness.stability import free_motion
from atomistic.lammps import Atoms, Workspace, load_data, load_dump, run_lammps, write_data
from atomistic.potentials import TABLE_POINTS, TABLE_START_A, Potential, contact_energy_and_force
from atomistic.settings import AsperitySettings, GlassSettings
from evidence.hardness import area as section
from evidence.hardness.choices import silica_and
from evidence.hardness.metal import CLOSING, DEPTHS_A, MOST_SHARE, STEEPNESS, identity, made, pressed, titanium
from evidence.hardness.metals import NEIGHBOURS, Metal, square_crystal
from evidence.record import load

BOND_A, BOND_PER_A = 2.1, 1.8  # length and steepness of the Morse bond
CROSS = {"O": "bond", "Si": "contact"}  # of titanium
GAP_A = 1.6  # between the surfaces that are laid on each other
COLUMN_A = 4.0  # of the map of thickness
FLAT_TILES = 2
MASSES_U = {2: 28.085, 3: 15.999}  # of the film, by type
SLAB_NM = 1.2  # film of the gates
LEAST_FILM_NM = 0.3  # one layer of tetrahedra
GLASS_A = 28.0  # about the edge of the cell of glass
GATES = {
    "film_density_g_cm3": "g/cm³",
    "gap_95_A": "Å",
    "slid_A": "Å",
    "drift_meV_atom": "meV an atom",
    "hottest_K": "K",
}


def arguments(parser: ArgumentParser) -> None:
    """Which parts."""
    parser.add_argument("parts", nargs="*", default=["area", "bond", "glass", "metal", "film"])
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3, 4])
    parser.add_argument("--thickness", type=float, nargs="+", default=[0.6, 1.0, 2.0], help="of the film, nm")
    parser.add_argument("--wavelength", type=float, default=5.6, help="of the asperity, nm")
    parser.add_argument("--metal", default="polycrystal", choices=["crystal", "polycrystal"], help="below the film")
    parser.add_argument("--grain", type=float, default=3.0, help="nm")
    parser.add_argument("--bond", type=float, nargs="+", default=[0.28], help="depth of the Morse bond, eV")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """Gates of area and bond on a flat film; glass and metal by themselves; then the films."""
    silica, oxide = silica_and("pmmcs")
    stacks, edge = [Stack(oxide, titanium(), depth) for depth in given.bond], 10 * given.wavelength
    for thickness in given.thickness:
        check_thickness(thickness, given.wavelength)
    run = ClosingRun(
        name="stack",
        asperity=AsperitySettings(name="stack", tiles=round(edge / GLASS_A), amplitude_nm=STEEPNESS * given.wavelength),
        seed=0,
        energy_scale=1.0,
    )
    base_nm = base_thickness_nm(CLOSING, given.wavelength)
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)

        def row(
            case: str, thickness_nm: float, quantity: str, value: float, metal: str, bond_eV: float | str = ""
        ) -> dict[str, Any]:
            by = {"wavelength_nm": given.wavelength, "metal": metal, "bond_eV": bond_eV}
            where = {"case": case, "seed": run.seed, "thickness_nm": thickness_nm, **by}
            return {**where, "quantity": quantity, "value": float(value)}

        for seed in given.seeds:
            run = run.model_copy(update={"seed": seed})
            glass = make_glass(silica, oxide, GlassSettings(), seed, work / "glass", edge_A=edge / run.asperity.tiles)
            for stack in stacks:
                found = {}
                if "area" in given.parts:
                    found |= area_errors(stack, glass, seed, work)
                if "bond" in given.parts:
                    flat = flat_stack(stack, glass, SLAB_NM, seed, work / "flat")
                    found["work_of_separation_J_m2"] = work_of_separation(stack, flat, work)
                for name, value in found.items():
                    yield row("flat", SLAB_NM, name, value, "crystal", stack.depth_eV)
            if not {"glass", "metal", "film"} & set(given.parts):
                continue
            for body in ("glass", "metal", "film"):
                calibrated_depth(body)  # before any hardness is looked at
            metal = stacks[0].metal
            bulk = scaled(made(metal, given.metal, edge, 10 * given.grain, seed, work / "bulk"), edge)
            whole = run.model_copy(update={"asperity": run.asperity.model_copy(update={"tiles": 1})})
            alone = {"glass": (run, glass, oxide, ""), "metal": (whole, bulk, _as_potential(metal), given.metal)}
            for case in sorted(alone.keys() & set(given.parts)):
                of, cell, force, kind = alone[case]
                aside = Workspace(work / "anneal", identity(cell), "anneal.in")
                amplitude = run.asperity.amplitude_nm
                cut = prepare_body(of, cell, force, CLOSING, PROTOCOL, aside, (seed, 7), amplitude, base_nm)
                for name, value in pressed(of, cut, force, seed, work / "alone").items():
                    yield row(case, 0.0, name, value, kind)
                aside.remove()
            for thickness, stack in product(given.thickness, stacks) if "film" in given.parts else ():
                body = laid(stack, bulk, glass, run, 10 * thickness, 10 * base_nm, work / "weld")
                found = pressed(run, body, _as_potential(stack), seed, work / "press")
                for name, value in {**gates(body), **found, **slid(body, work / "press" / "closing")}.items():
                    yield row("film", thickness, name, value, given.metal, stack.depth_eV)


def check_thickness(film_nm: float, wavelength_nm: float) -> None:
    """Refuse a film that is no layer, or so thick that no contact of its asperity feels the metal.

    Raises
    ------
    InputError : of those two.
    """
    widest = wavelength_nm * MOST_SHARE**0.5
    if not LEAST_FILM_NM <= film_nm <= widest:
        raise InputError(
            f"film of {film_nm:g} nm on an asperity of {wavelength_nm:g} nm, whose widest contact is {widest:.1f} nm: "
            f"accepted are {LEAST_FILM_NM:g} (one layer) to {widest:.1f} nm"
        )


def calibrated_depth(body: str) -> tuple[str, float]:
    """Depth (Å) with the least mean error of the contact area on bodies of this kind, and its largest error.

    Raises
    ------
    InputError : no area was calibrated on them; that of another kind of body does not serve.
    """
    study, case = {"film": ("hardness.stack", "flat"), "metal": ("hardness.metal", "slab")}.get(body, ("", ""))
    if body == "glass":
        return f"{Area.depth_A:g}", calibrated(silica_and("pmmcs")[1])[1]
    errors = {
        row["quantity"]: abs(float(row["value"]))
        for row in (load(study) if study else ())
        if row.get("case", row.get("body")) == case and row["quantity"].startswith("area_error")
    }
    if not errors:
        part = f"; run `python -m evidence {study} area`" if study else ""
        raise InputError(f"{body}: the contact area is not calibrated on it{part}")
    depth = min(DEPTHS_A, key=lambda depth: errors[f"area_error_mean_depth_{depth:g}_A"])
    return f"{depth:g}", max(errors[f"area_error_{end}_depth_{depth:g}_A"] for end in ("lowest", "highest"))


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """The work of separation, the error of the area, and the gates of the films."""
    found, values = {}, {}
    for row in rows:
        if row["quantity"] == "work_of_separation_J_m2":
            name = {"0.28": "work_weak", "0.45": "work_strong"}.get(row["bond_eV"], "work_other")
            found[name] = f"{float(row['value']):.2g} J/m²"
        values.setdefault((row["case"], row["quantity"]), []).append(float(row["value"]))
    for quantity, unit in GATES.items():
        if gate := values.get(("film", quantity)):
            found[quantity] = f"{min(gate):.3g} to {max(gate):.3g} {unit}"
    for depth in DEPTHS_A:
        ends = [values.get(("flat", f"area_error_{end}_depth_{depth:g}_A")) for end in ("lowest", "highest")]
        if ends[0] and ends[1]:
            label = f"{depth:g}".replace(".", "_")
            found[f"area_{label}"] = f"{100 * min(ends[0]):+.0f} to {100 * max(ends[1]):+.0f} %"
    return found


@dataclass(frozen=True)
class Stack:
    """Oxide on metal: types are those of the metal, then of the oxide.

    Attributes
    ----------
    depth_eV : of the Morse bond of metal and oxygen.
    """

    oxide: Potential
    metal: Metal
    depth_eV: float

    @property
    def species(self) -> Mapping[str, Any]:
        """What has the mass of each element."""
        return {**self.oxide.species, **self.metal.species}

    def files(self, elements: tuple[str, ...], energy_scale: float, repelled: None = None) -> dict[str, str]:
        """What LAMMPS needs, as `Potential.files`.

        Raises
        ------
        InputError : an ion without cross terms to the metal.
        """
        metal, *ions = elements
        if foreign := [ion for ion in ions if ion not in CROSS]:
            raise InputError(
                f"{metal} and {foreign[0]}: no cross terms, so that no film of it lies on the metal; known are "
                f"those with {' and '.join(CROSS)}"
            )
        end = self.oxide.cutoff_A
        nothing = " ".join(["NULL"] * len(ions))
        lines = ["pair_style hybrid table linear 4000 eam/alloy"]
        lines.append(f"pair_coeff * * eam/alloy metal.eam {metal} {nothing}")
        for i, first in enumerate(ions, 2):
            lines.append(f"pair_coeff 1 {i} table cross {CROSS[first]} {end}")
            lines += [
                f"pair_coeff {i} {i + j} table table {first}_{second} {end}" for j, second in enumerate(ions[i - 2 :])
            ]
        text = io.StringIO()
        r = np.sqrt(np.linspace(TABLE_START_A**2, end**2, TABLE_POINTS))
        for name, (energy, force) in {"bond": self.bond(r), "contact": contact_energy_and_force(r)}.items():
            text.write(f"\n{name}\nN {TABLE_POINTS} RSQ {TABLE_START_A} {end}\n\n")
            columns = [np.arange(1, TABLE_POINTS + 1), r, energy_scale * energy, energy_scale * force]
            np.savetxt(text, np.column_stack(columns), fmt="%d %.12g %.12g %.12g")
        return {
            "metal.eam": self.metal.setfl(energy_scale),
            "table": self.oxide.table(tuple(ions), energy_scale),
            "cross": "# titanium with oxygen and with silicon\n" + text.getvalue(),
            "pairs": "\n".join([*lines, *NEIGHBOURS]) + "\n",
        }

    def bond(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Energy (eV) and force (eV/Å) of titanium and oxygen; below 1e-3 of its depth at the cut-off."""
        decay = np.exp(-BOND_PER_A * (r - BOND_A))
        return self.depth_eV * ((1 - decay) ** 2 - 1), -2 * self.depth_eV * BOND_PER_A * (1 - decay) * decay


def _as_potential(force: Stack | Metal) -> Any:
    """It has what of a `Potential` the pressing uses: `species` and `files`."""
    return force


def scaled(body: Atoms, edge_A: float) -> Atoms:
    """The body in a cell of this edge; thermal expansion made it a little wider."""
    factor = edge_A / body.cell_A[0]
    return Atoms(body.elements, body.types, body.positions_A * factor, body.cell_A * factor)


def laid(
    stack: Stack, bulk: Atoms, glass: Atoms, run: ClosingRun, thickness_A: float, base_A: float, work: Path
) -> Atoms:
    """An asperity of metal under a film of glass, welded at 1000 K and cooled, without loose atoms.

    Parameters
    ----------
    bulk, glass : cells of the metal (one wavelength wide) and of the glass (`tiles` to the wavelength).
    """
    amplitude, tiles = 10 * run.asperity.amplitude_nm, run.asperity.tiles
    metal = cut_asperity(bulk, round(tiles * glass.cell_A[0] / bulk.cell_A[0]), amplitude, base_A, run.seed)
    film = cut_asperity(glass, tiles, amplitude, base_A + GAP_A + thickness_A, run.seed)
    x, y, z = film.positions_A.T
    floor = base_A + GAP_A + profile(x, y, float(film.cell_A[0]), amplitude)
    film = neutralise(film.take(z > floor), formula_of(glass))
    both = Atoms(
        (*metal.elements, *film.elements),
        np.concatenate([metal.types, film.types + len(metal.elements)]),
        np.concatenate([metal.positions_A, film.positions_A]),
        film.cell_A,
    )
    workspace = Workspace(work, identity(both), "anneal.in")
    for name, text in stack.files(both.elements, 1.0).items():
        (workspace / name).write_text(text, encoding="utf-8")
    write_data(workspace / "cut.data", both, {name: stack.species[name].mass_u for name in both.elements})
    plan = plan_closing(CLOSING, run)
    hot, cold = PROTOCOL.anneal_temperature_K, PROTOCOL.temperature_K
    variables = {
        "data": "cut.data",
        "pairs": "pairs",
        "seed": 7000 + run.seed,
        "timestep": plan.timestep,
        "frozen": 10 * PROTOCOL.frozen_nm,
        "segment": [1, 2],
        "previous": [0, 1],
        "from": [hot, hot],
        "to": [hot, cold],
        "steps": [plan.anneal_steps] * 2,
    }
    run_lammps("anneal.in", workspace, variables)
    welded = load_data(workspace / "annealed.data", both.elements)
    workspace.remove()
    of_film = np.flatnonzero(welded.types > len(metal.elements))
    tidy = welded.take(of_film)
    tidy = Atoms(film.elements, tidy.types - len(metal.elements), tidy.positions_A, tidy.cell_A)
    kept = remove_strays(tidy, formula_of(glass)).positions_A
    staying = np.isin(welded.positions_A[:, 2], kept[:, 2]) | (welded.types <= len(metal.elements))
    return welded.take(staying)


def gates(body: Atoms) -> dict[str, float]:
    """Height of the welded film over the metal, density of its middle half, and the gap below it, by columns."""
    number = np.maximum(1, (body.cell_A[:2] // COLUMN_A).astype(int))
    column = (np.mod(body.positions_A[:, :2] / body.cell_A[:2], 1) * number).astype(int) @ [1, number[0]]
    z, film = body.positions_A[:, 2], body.types > 1
    low, high, top = np.full(number.prod(), np.inf), np.full(number.prod(), -np.inf), np.full(number.prod(), -np.inf)
    np.minimum.at(low, column[film], z[film])
    np.maximum.at(high, column[film], z[film])
    np.maximum.at(top, column[~film], z[~film])
    covered = np.isfinite(low)
    low[~covered] = high[~covered] = 0
    middle = film & (np.abs(z - 0.5 * (low + high)[column]) < 0.25 * (high - low)[column])
    grams = np.array([MASSES_U[kind] for kind in body.types[middle]]).sum() / AVOGADRO
    volume_A3 = 0.5 * float(np.mean((high - low)[covered])) * float(np.prod(body.cell_A[:2])) * np.mean(covered)
    return {
        "film_height_A": float(np.mean((high - top)[covered])),
        "film_density_g_cm3": float(grams / (1e-24 * volume_A3)),
        "gap_median_A": float(np.median((low - top)[covered])),
        "gap_95_A": float(np.quantile((low - top)[covered], 0.95)),
        "covered_share": float(np.mean(covered)),
    }


def slid(body: Atoms, closing: Path) -> dict[str, float]:
    """How far the film has moved over the metal below the contact under the largest load (Å)."""
    workspace = Workspace.__new__(Workspace)
    workspace.path = closing
    last = max(int(path.suffix[1:]) for path in closing.glob("restart.*") if path.suffix[1:].isdigit())
    run_lammps("relax.in", workspace, {"pairs": "pairs", "segment": [last]})
    [(_, table)] = load_dump(closing / f"relaxed.{last}")
    moved = table[:, 2:4] - body.positions_A[:, :2]
    moved -= body.cell_A[:2] * np.round(moved / body.cell_A[:2])
    x, y, z = body.positions_A.T
    side = body.cell_A[0]
    near = np.hypot(x - side / 4, y - side / 4) < side / 4
    film = body.types > 1
    below = near & ~film & (z > z[near & ~film].max() - 6.0)
    apart = np.median(moved[near & film], axis=0) - np.median(moved[below], axis=0)
    return {"slid_A": float(np.hypot(*apart))}


def flat_stack(stack: Stack, glass: Atoms, thickness_nm: float, seed: int, work: Path) -> Atoms:
    """A flat film on a flat crystal, as wide as `FLAT_TILES` cells of glass."""
    edge = FLAT_TILES * float(glass.cell_A[0])
    bulk = square_crystal(stack.metal, edge, 20.0)
    factor = np.array([edge / bulk.cell_A[0], edge / bulk.cell_A[0], 1.0])
    bulk = Atoms(bulk.elements, bulk.types, bulk.positions_A * factor, bulk.cell_A * factor)
    return laid(stack, bulk, glass, flat_run(seed), 10 * thickness_nm, 20.0, work)


def flat_run(seed: int) -> ClosingRun:
    """Of a slab: no asperity."""
    flat = AsperitySettings.model_construct(name="slab", tiles=FLAT_TILES, amplitude_nm=0.0)
    return ClosingRun.model_construct(name="slab", asperity=flat, seed=seed, energy_scale=1.0)


def work_of_separation(stack: Stack, body: Atoms, work: Path) -> float:
    """Energy to lift the film off as it is, J/m^2: the energy of the bonds between both."""
    force, energies = _as_potential(stack), []
    for lift in (0.0, 14.0):
        moved = body.positions_A + np.where(body.types > 1, lift, 0.0)[:, None] * [0, 0, 1]
        tall = Atoms(body.elements, body.types, moved, body.cell_A + np.array([0, 0, 40.0]))
        record, _ = free_motion(tall, force, work / "lifted", 0.01, 1)
        energies.append(float(record[0, 1]))
    return (energies[1] - energies[0]) / float(np.prod(body.cell_A[:2])) * EV_PER_A3_IN_GPA / 10


def area_errors(stack: Stack, glass: Atoms, seed: int, work: Path) -> dict[str, float]:
    """Found over known area, minus 1, of bodies cut from a pressed flat film, by the depth within which atoms touch."""
    body, run = flat_stack(stack, glass, SLAB_NM, seed, work / "slab"), flat_run(seed)
    plan = plan_closing(CLOSING, run)
    steps = plan.segments * plan.segment_steps + round(section.SLAB_TRAVEL_A[0] / (plan.speed * plan.timestep))
    plan = replace(plan, segments=-(-steps // plan.segment_steps))
    layers = section.layers_of(run, [body], [_as_potential(stack)], CLOSING, plan, Area(), work / "area")
    found = {"area_snapshots": float(len(layers))}
    for depth in DEPTHS_A:
        errors = [row["error"] for row in section.cut_bodies(layers, Area(depth_A=depth))]
        for name, value in (("mean", np.mean(errors)), ("lowest", min(errors)), ("highest", max(errors))):
            found[f"area_error_{name}_depth_{depth:g}_A"] = float(value)
    return found
