"""Random draws from Table 1 by the coupled engine: elastic, of constant hardness, and with the size effect, twice.

python -m mesoscale.contact.studies.coupled_draws FIRST LAST FILE.csv
"""

import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from mesoscale.contact.cycle import run_cycle
from mesoscale.contact.energy import dissipated_energy, work
from mesoscale.contact.studies.draws import draw_inputs
from mesoscale.contact.studies.stability import violations
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings
from mesoscale.tables import grow_table

GRIDS = (64, 128, 256)
SECOND_LOSS = 0.01  # of the first cycle's dissipation, what a second one to the same load may lose
COLUMNS: tuple[str, ...] = (
    "draw",
    "pixels",
    "case",
    "passed",
    "broken",
    "steps",
    "repulsion_drop",
    "second_loss",
    "cpu_s",
)


def coupled_draw_rows(first: int, last: int) -> Iterator[dict[str, Any]]:
    """Rows of the draws first .. last - 1: each on three grids of the same cell, judged by physical invariants."""
    for number in range(first, last):
        drawn = draw_inputs(number)
        for pixels in GRIDS:
            settings = ContactSettings(mechanics="coupled", pixels=pixels)
            heights = random_surface(drawn, settings, number)
            for case, inputs, model in (
                ("elastic", drawn, "elastic"),
                ("constant hardness", replace(drawn, h_prime=0.0), "plastic"),
                ("hardness of clusters", drawn, "plastic"),
            ):
                start = time.process_time()
                chosen = settings.model_copy(update={"model": model})
                cycle = run_cycle(inputs, chosen, number, heights=heights, keep_surface=True)
                broken = violations(cycle, inputs, chosen, heights)
                if not cycle.flags["force_reached"]:
                    broken.append("force not reached")
                again = 0.0
                lost = dissipated_energy(cycle)[0]
                if lost > 1e-3 * work(cycle.closing)[0]:  # else nothing yielded
                    second = run_cycle(inputs, chosen, number, heights=cycle.heights, keep_surface=True)
                    again = dissipated_energy(second)[0] / lost
                    broken += [f"second cycle: {words}" for words in violations(second, inputs, chosen, cycle.heights)]
                    if abs(again) > SECOND_LOSS:
                        broken.append(f"second cycle loses {again:.2g} of the first")
                yield {
                    "draw": number,
                    "pixels": pixels,
                    "case": case,
                    "passed": not broken,
                    "broken": "; ".join(broken),
                    "steps": int((cycle.closing.repulsive_nN > 0).sum()),
                    "repulsion_drop": f"{cycle.flags['repulsion_drop']:.1e}",
                    "second_loss": f"{again:.1e}",
                    "cpu_s": round(time.process_time() - start, 4),
                }


def main() -> None:
    """Add the rows of some draws to a file."""
    first, last, file = int(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3])
    grow_table(file, coupled_draw_rows(first, last), columns=COLUMNS)


if __name__ == "__main__":
    main()
