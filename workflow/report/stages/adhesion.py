"""Energy and pull-off of pads against roughness, load and attraction."""

from collections.abc import Callable, Iterator

from workflow.report.available import Results, Row
from workflow.report.drawing import SERIES, SOFT, draw
from workflow.report.numbers import cell, column, number, show, spread
from workflow.report.page import Block, Figure, stage, table

STYLES = {"asperity": "o--", "coupled": "s-"}


@stage("Adhesion of pads", "adhesion/summary.csv")
def describe(results: Results) -> Iterator[Block]:
    """Energy per area, pull-off, and a sphere on the same film."""
    rows = results.csv("adhesion/summary.csv")
    yield (
        f"{rows[0]['pads']} pads of {rows[0]['cells']} cells each, closed to several loads and opened. The energy is "
        "the work of opening from zero net force outwards. Of each number the mean over pads, the lowest and the "
        "highest."
    )
    yield Figure(
        adhesion_figure(rows),
        "Left: energy per area after each load; the grey line is that of flats at the separation of zero force of the "
        "lowest load. Right: pull-off of the central case. Bars span the pads.",
        wide=True,
    )
    yield table(
        "Mean over pads [lowest, highest]",
        rows,
        {
            "mechanics": "mechanics",
            "differs": _difference,
            "load (MPa)": cell("load_MPa"),
            "energy (µJ/m²)": _over_pads("energy_uJ_m2"),
            "flats (µJ/m²)": _over_pads("flats_uJ_m2"),
            "pull-off (kPa)": _over_pads("pull_off_kPa"),
            "work on a sphere (mJ/m²)": _over_pads("sphere_work_mJ_m2"),
        },
        heads=3,
    )
    yield (
        "Measured with ruby spheres of 0.5 mm on four diamond films: 0.08 to 7.15 mJ/m² (Thimons et al. 2021, "
        "doi 10.1007/s11340-021-00733-6)."
    )


def adhesion_figure(rows: list[Row]) -> str:
    """Energy against RMS height, and pull-off against load."""
    loads = sorted({number(row["load_MPa"]) for row in rows})

    def plot(energy, pull):
        for mechanics, style in STYLES.items():
            for place, load in enumerate(loads):
                part = [
                    row
                    for row in rows
                    if row["mechanics"] == mechanics
                    and row["varied"] in ("none", "rms")
                    and number(row["load_MPa"]) == load
                ]
                part.sort(key=lambda row: number(row["rms_nm"]))
                if part:
                    color = SERIES[place % len(SERIES)]
                    _bars(energy, part, "rms_nm", "energy_uJ_m2", style, color, f"{mechanics}, {load:g} MPa")
                    if place == 0:
                        energy.plot(column(part, "rms_nm"), column(part, "flats_uJ_m2"), color=SOFT, linewidth=0.8)
            central = [row for row in rows if row["mechanics"] == mechanics and row["varied"] == "none"]
            if central:
                _bars(pull, central, "load_MPa", "pull_off_kPa", style, SERIES[0], mechanics)
        energy.set(yscale="log", xlabel="RMS height (nm)", ylabel="energy (µJ/m²)")
        energy.legend(ncols=2)
        pull.set(xscale="log", yscale="log", xlabel="largest load (MPa)", ylabel="pull-off (kPa)")
        pull.legend()

    return draw("adhesion", "Adhesion of pads against roughness and load", plot, (9.4, 3.8), columns=2)


def _bars(axis, rows: list[Row], across: str, key: str, style: str, color: str, label: str) -> None:
    middle = column(rows, key)
    spans = (middle - column(rows, f"{key}_lowest"), column(rows, f"{key}_highest") - middle)
    axis.errorbar(column(rows, across), middle, spans, fmt=style, color=color, markersize=4, capsize=2, label=label)


def _difference(row: Row) -> str:
    varied = row["varied"]
    texts = {
        "none": "central",
        "rms": f"RMS {show(number(row['rms_nm']))} nm",
        "gap_cutoff": f"D₀ {show(number(row['gap_cutoff_nm']))} nm",
        "work": f"D₀ {show(number(row['gap_cutoff_nm']))} nm, A_H {show(number(row['hamaker_aJ']))} aJ",
    }
    return texts[varied] if varied in texts else f"retardation {show(number(row['retardation_nm']))} nm"


def _over_pads(name: str) -> Callable[[Row], str]:
    return lambda row: spread(row, name, f"{name}_lowest", f"{name}_highest")
