"""What does the hardness law of films change in a cell against eq. 4: contact, hysteresis and pull-off?

Cells of 1 µm² by `run_cycle`, with the inputs of four cases of `pad.answers`: `reduced` and the paper's Table 1, each
with eq. 4 and with the law of films. Both laws have the same surfaces, and the same draws of all inputs that they
share; at `medians` inputs are at their medians, and only surfaces differ. Cells are closed to 7 MPa, as in `curves/`
by default, and to 40 MPa, as switches close their pads in `pad.answers` (28 to 53 MPa). Rows are means with standard
errors, those of `film less eq. 4` of the paired difference. Numbers are those of the largest load.

- `d_c_nm`: separation at first contact on closing, as in `law/parameters.csv`. The surface decides it, not the law.
- `d_c_change_nm`: separation at last contact on opening less `d_c_nm`.
- `hysteresis_mJ_m2`: area between the curves of net pressure of closing and opening, the work lost per area of cell.
- `pull_off_kPa`: largest net attraction on opening, per area of the cell. A pad of many cells pulls less.

At median inputs the film is harder than eq. 4 where contacts are 5 to 30 nm wide (Table 1: up to 50 nm), and softer
where they are wider. So it pulls less at the small load, and more at the large one, where more contacts are wide.
Single draws differ far more, since H' and the film's hardness are drawn independently.
"""

import re
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from evidence.pad.answers import scene_of
from evidence.pad.runs import results_of
from evidence.record import load_table
from mesoscale.contact import Cycle, run_cycle
from mesoscale.contact.energy import pull_off, work
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import from_rows
from mesoscale.settings import ContactSettings
from workflow.run.contact_settings import contact_settings
from workflow.scene import load_scene

Array = NDArray[np.float64]

CASES = {
    "reduced": {"eq. 4": "default", "film": "film"},
    "Table 1": {"eq. 4": "paper's inputs", "film": "paper's inputs, film"},
}
DIFFERENCE = "film less eq. 4"
MEASURED = ("d_c_nm", "d_c_change_nm", "hysteresis_mJ_m2", "pull_off_kPa")


def arguments(parser: ArgumentParser) -> None:
    """How many surfaces, at which loads and grid."""
    parser.add_argument("--surfaces", type=int, default=128)
    parser.add_argument("--loads", type=float, nargs="+", default=[7.0, 40.0], help="MPa")
    parser.add_argument("--pixels", type=int, default=256)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each set of inputs, load and law, and one for the difference of the laws."""
    for inputs, laws in CASES.items():
        cases = {law: _inputs_of(case, given.pixels) for law, case in laws.items()}
        names = list(dict.fromkeys(name for table, _ in cases.values() for name in table.names))
        drawn = qmc.LatinHypercube(len(names), rng=0).random(given.surfaces)
        for at, units in (("medians", np.full_like(drawn, 0.5)), ("draws", drawn)):
            ranks = dict(zip(names, units.T, strict=True))
            for load in given.loads:
                cycles = {law: list(_closed(*case, ranks, load)) for law, case in cases.items()}
                found = {law: np.array([measures(cycle) for cycle in of]) for law, of in cycles.items()}
                found[DIFFERENCE] = found["film"] - found["eq. 4"]
                converged = np.array([[cycle.converged for cycle in of] for of in cycles.values()]).all(axis=0)
                for law, values in found.items():
                    about = {"inputs": inputs, "at": at, "load_MPa": load, "law": law, "surfaces": len(values)}
                    yield {**about, **_means(values), "both_converged": int(converged.sum())}


def _inputs_of(case: str, pixels: int) -> tuple[InputTable, ContactSettings]:
    """The inputs of a cell and the settings of its contact, as the scene of a case has them."""
    with results_of(scene_of(case, pixels), "inputs") as results:
        described = results / "topography" / "parameters.json"
        job = SimpleNamespace(input={"topography": described} if described.is_file() else {})
        given = load_scene(str(results.parent.parent / "scene.yaml")).contact.model_dump(mode="json")
        return from_rows(load_table(results / "inputs.csv")), contact_settings(given, job)


def _closed(table: InputTable, contact: ContactSettings, ranks: Mapping[str, Array], load: float) -> Iterator[Cycle]:
    """Cycles to a load (MPa), from the rank of each input, 0 to 1, by name, and one surface each."""
    values = table.transform(np.stack([ranks[name] for name in table.names], axis=1))
    for seed, row in enumerate(values.tolist()):
        inputs, settings = contact_of(dict(zip(table.names, row, strict=True)), contact)
        yield run_cycle(inputs, settings, seed, load * 1e-3 * settings.length_nm**2)


def measures(cycle: Cycle) -> tuple[float, ...]:
    """What a cycle gives, in the order of MEASURED; nN/nm² are GPa, nN/nm are J/m²."""
    lost = work(cycle.closing, net=True)[0] - work(cycle.opening, net=True)[0]
    return (
        cycle.first_contact_nm,
        cycle.last_contact_nm - cycle.first_contact_nm,
        1e3 * lost / cycle.cell_area_nm2,
        1e6 * pull_off(cycle.opening) / cycle.cell_area_nm2,
    )


def _means(values: Array) -> dict[str, float]:
    """Mean and standard error of each measure, from shape (surfaces, measures)."""
    errors = values.std(axis=0, ddof=1) / len(values) ** 0.5
    both = zip(MEASURED, values.mean(axis=0).tolist(), errors.tolist(), strict=True)
    return {key: number for name, mean, error in both for key, number in ((name, mean), (f"{name}_error", error))}


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Means of each law, and by how much films change hysteresis and pull-off, at the largest load."""
    largest = max(float(row["load_MPa"]) for row in rows)
    of = {(row["inputs"], row["at"], row["law"]): row for row in rows if float(row["load_MPa"]) == largest}
    texts, changes = {}, {}
    for (inputs, at, law), row in of.items():
        key = re.sub(r"\W+", "_", inputs) + ("_draws" if at == "draws" else "")
        if law == DIFFERENCE:
            for name in ("hysteresis", "pull_off"):
                column = next(column for column in MEASURED if column.startswith(name))
                before, change, error = (
                    float(number) for number in (of[inputs, at, "eq. 4"][column], row[column], row[f"{column}_error"])
                )
                changes[f"{key}_{name}"] = f"{100 * change / before:+.1f} ± {100 * error / before:.1f} %"
        elif at == "draws":
            texts[f"{key}_{re.sub(r'[^a-z0-9]+', '_', law)}"] = (
                f"d_c {float(row['d_c_nm']):.1f} nm, {float(row['d_c_change_nm']):+.2f} nm on opening; "
                f"{float(row['hysteresis_mJ_m2']):.1f} mJ/m² lost; pull-off {float(row['pull_off_kPa']):.0f} kPa"
            )
    return {**texts, **changes}
