"""Numerical errors on the page: a line a stage, error against run time, and the hard cases."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from matplotlib.ticker import LogLocator

from workflow.report.available import CsvRow, Results
from workflow.report.drawing import INK, SERIES, SOFT, draw
from workflow.report.numbers import number, show
from workflow.report.page import Block, Figure, PageTable, Section, section

STAGES = {  # with a result that tells whether the scene has the stage
    "hardness": "hardness/points.csv",
    "elastic": "elastic/bulk_moduli.csv",
    "topography": "topography/parameters.json",
    "contact": "contact/nominal.h5",
    "uncertainty": "uncertainty/outputs.csv",
    "pad": "pad/curves.csv",
    "answer": "answer/pad_switch.json",
    "circuit": "circuit/circuit.json",
    "failure": "failure/failure.json",
    "lifetime": "lifetime/lifetime.json",
}
OWN = {"contact": "contact/errors.csv", "answer": "answer/errors.csv"}
"""Tables that every run makes; others are those of the target `accuracy`."""
NEAR_BEST = 2.0
"""An error within this factor of the best one is not worth more time."""
SMALL_PERCENT = 1.0
SMALL_SHARE = 0.1
"""Errors not worth more time: in per cent, and as a share of the release's standard deviation."""
TOLD_APART = 2.0
"""Two errors differ where they do by as many of their own errors."""
PER_ROW = 2
"""Panels of a row of the picture."""
LEGEND_LINE = 0.2
"""Height of a line of a legend, inches."""
ROUNDING = 1e-9
"""Errors that are rounding, in % or volts: not drawn."""


@dataclass(frozen=True)
class Error:
    """An error of one quantity with its own error, and what it moves in the release (V, NaN: not
    known).
    """

    quantity: str
    error: float
    own_error: float
    unit: str
    release_V: float

    def __str__(self) -> str:
        text = f"{self.quantity} {show(self.error, 2)}"
        if np.isfinite(self.own_error):
            text += f" ± {show(self.own_error, 1)}"
        if self.unit.startswith("%"):
            return text + self.unit
        return f"{text} {self.unit}"


@dataclass(frozen=True)
class Value:
    """One value of a knob with the errors of its quantities, and processor seconds of one
    computation.
    """

    text: str
    shipped: bool
    cpu_s: float
    errors: dict[str, Error] = field(default_factory=dict)


@dataclass(frozen=True)
class KnobTable:
    """What an accuracy table says of one knob; its values are in the order in which they were
    tried, cheapest first.
    """

    stage: str
    name: str
    reference: str
    values: list[Value]

    @property
    def shipped(self) -> Value | None:
        """The value in use, where it was tried."""
        return next((value for value in self.values if value.shipped), None)

    @property
    def quantity(self) -> str:
        """The quantity that the value in use, or else the first, moves most: by volts where they
        are known.
        """
        errors = (self.shipped or self.values[0]).errors.values()
        in_volts = [error for error in errors if np.isfinite(error.release_V)]
        if in_volts:
            return max(in_volts, key=lambda error: error.release_V).quantity
        return max(errors, key=lambda error: np.nan_to_num(error.error)).quantity

    @property
    def curve(self) -> list[tuple[Value, Error]]:
        """The values with their errors of that quantity."""
        quantity = self.quantity
        pairs = [
            (value, value.errors[quantity]) for value in self.values if quantity in value.errors
        ]
        return [pair for pair in pairs if np.isfinite(pair[1].error)]


def studies(results: Results) -> list[Section]:
    """The sections of numerical errors, error against run time and stability."""
    tables = knob_tables(results)
    sections = [
        section(
            "numerical-errors", "Numerical errors, stage by stage", "", _lines(results, tables), []
        )
    ]
    if accuracy := results.matching("accuracy/", ".csv"):
        tried = [table for table in tables if len(table.values) > 1]
        sections.append(
            section(
                "accuracy", "Error against run time", ACCURACY, _accuracy(results, tried), accuracy
            )
        )
    if stability := results.matching("stability/", ".csv"):
        sections.append(
            section(
                "stability", "Stiff and extreme cases", STABILITY, _stability(results), stability
            )
        )
    return sections


ACCURACY = (
    "What each numerical choice costs and buys. Errors are root mean squares over several"
    " surfaces, points or seeds, each with its standard error. Recommended is the cheapest value"
    f" whose error is small, or within a factor {NEAR_BEST:g} of the best one tried."
)
STABILITY = "Unusual inputs, and what the code does with them."


def knob_tables(results: Results) -> list[KnobTable]:
    """What all accuracy tables say, by stage; a stage without one has what every run tells."""
    tables = []
    for stage in STAGES:
        name = f"accuracy/{stage}.csv"
        if not results.has(name):
            name = OWN.get(stage, name)
        if results.has(name):
            tables += tables_of(stage, results.csv(name))
    return tables


def tables_of(stage: str, rows: Sequence[CsvRow]) -> list[KnobTable]:
    """The knobs of an accuracy table."""
    knobs: dict[str, KnobTable] = {}
    for row in rows:
        knob = knobs.setdefault(row["knob"], KnobTable(stage, row["knob"], row["reference"], []))
        value = next((value for value in knob.values if value.text == row["value"]), None)
        if value is None:
            value = Value(row["value"], row["shipped"] == "True", number(row["cpu_s"]))
            knob.values.append(value)
        numbers = [number(row.get(name)) for name in ("error", "own_error", "release_V")]
        value.errors.setdefault(
            row["case"], Error(row["case"], numbers[0], numbers[1], row["unit"], numbers[2])
        )
    return [knob for knob in knobs.values() if any(value.errors for value in knob.values)]


def _lines(results: Results, tables: Sequence[KnobTable]) -> Iterator[Block]:
    """One line a stage: its largest error, and what it moves in the release."""
    rows = []
    unknown = []
    for stage, result in STAGES.items():
        if not results.has(result):
            continue
        used = [table for table in tables if table.stage == stage and table.shipped and table.curve]
        if not used:
            unknown.append(stage)
            continue
        in_volts = [table for table in used if np.isfinite(_in_use(table).release_V)]
        unweighed = [table for table in used if table not in in_volts]
        volts = "not known"
        worst = []
        if in_volts:
            worst.append(max(in_volts, key=lambda table: _in_use(table).release_V))
            volts = f"{show(_in_use(worst[0]).release_V, 2)} V"
        if unweighed:
            worst.append(max(unweighed, key=lambda table: _in_use(table).error))
        choices = [f"{table.name}, {_short(table.shipped)}" for table in worst]
        rows.append(
            (stage, "; ".join(choices), "; ".join(str(_in_use(table)) for table in worst), volts)
        )
    if unknown:
        rows.append((", ".join(unknown), "not measured in this scene", "", ""))
    caption = f"Numerical errors; asperity run {results.scene} accuracy measures all"
    yield PageTable(
        caption, ("stage", "worst choice", "its error", "release moves"), rows, front=True
    )


def _in_use(table: KnobTable) -> Error:
    assert table.shipped is not None
    return table.shipped.errors[table.quantity]


def _short(value: Value | None) -> str:
    """A number shortened, whole numbers and words as they are."""
    if value is None:
        return "–"
    value_as_number = number(value.text)
    if np.isfinite(value_as_number) and not value_as_number.is_integer():
        return show(value_as_number)
    return value.text.removesuffix(".0")


def _accuracy(results: Results, tables: Sequence[KnobTable]) -> Iterator[Block]:
    yield Figure(
        error_against_time(tables),
        "Error against processor seconds of one computation, a line a choice. Rings: values in use."
        " Dashed: no value tried has a smaller error in less time.",
        wide=True,
    )
    deviation_V = release_deviation_V(results)
    header = (
        "stage",
        "choice",
        "in use",
        "its error",
        "beside the release's spread",
        "takes (s)",
        "recommended",
    )
    rows = [line for table in tables if (line := _line(table, deviation_V))]
    yield PageTable("Numerical choices", header, rows, heads=2)


def release_deviation_V(results: Results) -> float:
    """Standard deviation of the release over all that is uncertain, V; NaN without an answer."""
    answer = results.content("answer/pad_switch.json").get("answer")
    if not answer:
        return np.nan
    return float(answer["release_V"]["std"])


def _line(table: KnobTable, deviation_V: float) -> tuple[str, ...] | None:
    """A row of the table of choices."""
    if not table.curve:
        return None
    error = None
    seconds = "–"
    if table.shipped:
        error = table.shipped.errors.get(table.quantity)
        seconds = show(table.shipped.cpu_s, 2)
    return (
        table.stage,
        table.name,
        _short(table.shipped),
        str(error or "–"),
        _beside_spread(error, deviation_V),
        seconds,
        recommended(table, deviation_V),
    )


def _passed(row: CsvRow) -> str:
    """Whether a case passed, in words."""
    if row["passed"] == "True":
        return "passed"
    return f"not passed: {row.get('detail', '')}"


def _beside_spread(error: Error | None, deviation_V: float) -> str:
    """What an error moves the release by, beside its spread."""
    if error is None or not np.isfinite(error.release_V / deviation_V):
        return "–"
    return f"{error.release_V / deviation_V:.0%} of {show(deviation_V, 2)} V"


def recommended(table: KnobTable, deviation_V: float = np.nan) -> str:
    """The cheapest value that is good enough, or why none is recommended.

    Parameters
    ----------
    deviation_V : standard deviation of the release; NaN: not known.
    """
    curve = table.curve
    if len(curve) < 2:
        return "–"
    errors = np.array([error.error for _, error in curve])
    own_errors = np.nan_to_num([error.own_error for _, error in curve])
    best = int(errors.argmin())
    worst = int(errors.argmax())
    if errors[worst] - errors[best] <= TOLD_APART * np.hypot(own_errors[best], own_errors[worst]):
        return "values cannot be told apart"
    rises = np.diff(errors) > TOLD_APART * np.hypot(own_errors[1:], own_errors[:-1])
    if rises.any() or errors[-1] >= errors[0]:
        return "none: errors do not fall towards the reference"
    small = [
        _is_small(error, deviation_V) or error.error <= NEAR_BEST * errors[best]
        for _, error in curve
    ]
    value, error = min(
        (pair for pair, enough in zip(curve, small, strict=True) if enough),
        key=lambda pair: pair[0].cpu_s,
    )
    return f"{_short(value)}: {error} in {show(value.cpu_s, 2)} s"


def _is_small(error: Error, deviation_V: float) -> bool:
    if np.isfinite(error.release_V) and np.isfinite(deviation_V):
        return error.release_V <= SMALL_SHARE * deviation_V
    return error.unit.startswith("%") and error.error <= SMALL_PERCENT


def error_against_time(tables: Sequence[KnobTable]) -> str | None:
    """Error against processor seconds, both logarithmic: a panel a stage and unit, a line a
    knob.
    """
    panels: dict[tuple[str, str], list[KnobTable]] = {}
    for table in tables:
        if drawn_points(table):
            panels.setdefault((table.stage, table.curve[0][1].unit), []).append(table)
    if not panels:
        return None
    columns = min(PER_ROW, len(panels))
    rows = -(-len(panels) // columns)

    def plot(*axes):
        for axis, ((stage, unit), knobs) in zip(axes, panels.items(), strict=False):
            _draw_panel(axis, knobs)
            axis.xaxis.set_minor_locator(LogLocator(subs=(2, 5)))  # their labels have room
            axis.set(
                title=stage,
                xlabel="processor time (s)",
                ylabel=f"error ({unit})",
                xscale="log",
                yscale="log",
            )
        for axis in axes[len(panels) :]:
            axis.set_visible(False)

    label = "Numerical error against processor time, for each choice of each stage"
    legend = max(map(len, panels.values())) * LEGEND_LINE
    return draw(
        "accuracy", label, plot, (4.4 * columns, (3.2 + legend) * rows), columns=columns, rows=rows
    )


def drawn_points(table: KnobTable) -> list[tuple[float, float, bool]]:
    """Processor seconds, error and whether it is in use, of the values that logarithms can show."""
    return [
        (value.cpu_s, error.error, value.shipped)
        for value, error in table.curve
        if value.cpu_s > 0 and error.error > ROUNDING
    ]


def _draw_panel(axis, knobs: Sequence[KnobTable]) -> None:
    pooled = []
    for color, knob in zip(SERIES * len(knobs), knobs, strict=False):
        points = drawn_points(knob)
        pooled += points
        seconds, errors, shipped = map(np.array, zip(*sorted(points), strict=True))
        axis.plot(seconds, errors, ".-", color=color, label=f"{knob.name}: {knob.quantity}")
        axis.plot(
            seconds[shipped],
            errors[shipped],
            "o",
            color=INK,
            markerfacecolor="none",
            markersize=10,
            linewidth=0,
        )
    front = pareto_front([(seconds, error) for seconds, error, _ in pooled])
    axis.plot(*zip(*front, strict=True), "--", color=SOFT, linewidth=1, zorder=0)
    # below: nowhere else is free
    axis.legend(fontsize=8, loc="upper left", bbox_to_anchor=(0, -0.18))


def pareto_front(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points, by rising time, than which no other has a smaller or equal error in less or equal
    time.
    """
    front: list[tuple[float, float]] = []
    for seconds, error in sorted(points):
        if not front or error < front[-1][1]:
            front.append((seconds, error))
    return front


def _stability(results: Results) -> Iterator[Block]:
    tables = {
        name.removeprefix("stability/").removesuffix(".csv"): results.csv(name)
        for name in results.matching("stability/", ".csv")
    }
    failed = [
        f"{stage}: {row['case']}"
        for stage, rows in tables.items()
        for row in rows
        if row["passed"] != "True"
    ]
    total = sum(map(len, tables.values()))
    outcome = f"{total - len(failed)} of {total} cases passed."
    if failed:
        outcome += f" Not passed: {'; '.join(failed)}."
    yield outcome
    for stage, rows in tables.items():
        lines = [
            (
                row["case"],
                row.get("description", ""),
                row.get("checks", ""),
                _passed(row),
                show(row.get("cpu_s"), 2),
            )
            for row in rows
        ]
        header = ("case", "what is hard about it", "what must hold", "verdict", "takes (s)")
        yield PageTable(f"Hard cases of {stage}", header, lines)
