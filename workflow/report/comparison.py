"""Two scenes side by side on one page: `asperity compare results/a results/b`."""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from asperity.foreign_text import shown
from mesoscale.law.parameters import PARAMETERS
from workflow.checksums import is_damaged
from workflow.report.available import Results
from workflow.report.gates import faint_outputs
from workflow.report.numbers import OUTPUTS, column, show
from workflow.report.page import Table
from workflow.report.render import low
from workflow.report.verdict import verdict

ENDS = (0.05, 0.5, 0.95)
Spread = tuple[float, float, float]
"""5 %, median and 95 %."""


def comparison(first: Results, second: Results) -> str:
    """HTML of the page: what both scenes say, and the differences with their intervals."""
    pairs = [(results, results.root.name) for results in (first, second)]
    here = Path(__file__).parent
    environment = Environment(loader=FileSystemLoader(here), autoescape=True, undefined=StrictUndefined)
    environment.filters["low"] = low
    return environment.get_template("comparison.html.j2").render(
        names=[name for _, name in pairs],
        verdicts=[(name, said.sentence if (said := verdict(results)) else "") for results, name in pairs],
        table=differences(first, second),
        style=(here / "style.css").read_text(encoding="utf-8"),
    )


def differences(first: Results, second: Results) -> Table:
    """Every quantity that both scenes have, and the second less the first."""
    one, other = spreads(first), spreads(second)
    lines = [
        (f"{name} ({unit})" if unit else name, _shown(one[name, unit]), _shown(other[name, unit]), _shown(difference))
        for name, unit in one
        if (name, unit) in other
        for difference in [difference_of(one[name, unit], other[name, unit])]
    ]
    header = ("quantity", first.root.name, second.root.name, "difference")
    grey = {OUTPUTS[name.removeprefix("delta_")][0] for part in (first, second) for name in faint_outputs(part)}
    return Table(
        "Median and 5 to 95 % (of probabilities 95 %), the central value alone where a release has no interval; the "
        "difference is second less first, of independent scenes. Grey is not to be trusted in one of them",
        header,
        lines,
        faint={line[0] for line in lines if line[0].split(",")[0] in grey},
    )


def difference_of(first: Spread, second: Spread) -> Spread:
    """Second less first; deviations to either side of the median add in squares, as for independent quantities."""
    middle = second[1] - first[1]
    low = middle - float(np.hypot(second[1] - second[0], first[2] - first[1]))
    high = middle + float(np.hypot(second[2] - second[1], first[1] - first[0]))
    return low, middle, high


def spreads(results: Results) -> dict[tuple[str, str], Spread]:
    """Quantities of a scene by name and unit."""
    quantities: dict[tuple[str, str], Spread] = {}
    said = verdict(results)
    if said and said.release_V:
        low, middle, high = said.release_V if len(said.release_V) == 3 else (np.nan, *said.release_V, np.nan)
        quantities["release voltage, 0 where it sticks", "V"] = (low, middle, high)
    if said and said.stuck:
        quantities["probability of sticking", ""] = said.stuck
    if results.has("uq/samples.csv"):
        rows = results.csv("uq/samples.csv")
        for branch in ("closing", "opening"):
            for name in PARAMETERS:
                symbol, unit, factor = OUTPUTS[name]
                values = column(rows, f"{branch}_{name}") * factor
                quantities[f"{symbol}, {branch}", unit] = _quantiles(values[np.isfinite(values)])
    if results.has("elastic/e_star.h5"):
        samples = results.h5("elastic/e_star.h5")[0]["samples"]["e_star_GPa"]
        quantities["E* computed", "GPa"] = _quantiles(np.asarray(samples, float))
    if results.has("topography/parameters.json"):
        for name, estimate in results.json("topography/parameters.json").get("estimates", {}).items():
            low, high = estimate["interval"]
            quantities[f"{name} measured", estimate["unit"]] = (float(low), float(estimate["value"]), float(high))
    return quantities


def _quantiles(values: np.ndarray) -> Spread:
    low, middle, high = np.quantile(values, ENDS).tolist()
    return low, middle, high


def _shown(spread: Spread) -> str:
    low, middle, high = (show(value) for value in spread)
    return middle if np.isnan(spread[0]) else f"{middle} [{low}, {high}]"


def results_in(folder: Path) -> Results:
    """All result files of a folder, for a page that no run schedules."""
    return Results(folder, files_in(folder), folder.name)


def files_in(folder: Path) -> list[Path]:
    """Result files of a folder; links, pipes and devices are left out."""
    return [
        path
        for path in sorted(folder.rglob("*"))
        if path.suffix in {".csv", ".json", ".h5"}
        and path.relative_to(folder).parts[0] not in {"logs", "work"}
        and path.is_file()
        and not path.is_symlink()
    ]


def _refuse(message: str) -> int:
    print(f"ERROR {shown(message)}", file=sys.stderr)
    return 1


def main(arguments: Sequence[str]) -> int:
    """Write the page of two folders of results."""
    first, second, page = (Path(name).resolve() for name in arguments)
    for folder in (first, second):
        if not (folder / "inputs.csv").is_file():
            return _refuse(f"{folder.name}: no results of a scene are there; give two folders such as results/ci")
        if damaged := next((path for path in files_in(folder) if is_damaged(path)), None):
            return _refuse(f"{damaged}: damaged, it differs from its checksum; run the scene again: it is made again")
    try:
        text = comparison(results_in(first), results_in(second))
    except Exception as error:  # results of a stranger may hold anything
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:300]
        return _refuse(f"{first.name}, {second.name}: not comparable ({reason}); run both with this version")
    page.write_text(text, encoding="utf-8")
    print(f"the comparison is {page.name}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
