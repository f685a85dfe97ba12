"""The switch from dry to humid air."""

from collections.abc import Iterator

from workflow.report.available import CsvRow, Results
from workflow.report.drawing import BLUE, ORANGE, draw
from workflow.report.numbers import cell, column, show
from workflow.report.page import Block, Figure, stage, table

OPENINGS = {
    "balance": (BLUE, "menisci in balance with the vapour"),
    "volume": (ORANGE, "their volume stays"),
}


@stage("Humid air", "humidity/humidity.csv")
def describe(results: Results) -> Iterator[Block]:
    """Release and sticking against humidity."""
    rows = results.csv("humidity/humidity.csv")
    yield (
        "Water condenses in narrow gaps and pulls. While the switch opens it stays in balance with"
        " the vapour, or its volume stays, where opening is too fast to evaporate it: both limits"
        " are shown. The air must have stood around the closed switch for some seconds, in which it"
        " condenses. How much it pulls depends on the contact angles of the walls"
        " (contact.air.contact_angles_deg): clean walls, 0°, are pulled most. Where liquid would be"
        " thinner than a molecule there is none; air this dry counts as dry."
    )
    releases = any(float(row["release_V"] or 0.0) for row in rows)
    some_free = any(float(row["stuck"] or 1.0) < 1.0 for row in rows)
    several = len({row["humidity"] for row in rows}) > 1
    if several and (releases or some_free):
        yield _figure(rows)
    else:  # its axes would be empty, or hold one point
        yield begins_to_stick(rows) or "The switch has no answer at any of these humidities."
    yield table(
        "The switch against humidity",
        rows,
        {
            "humidity": lambda row: f"{float(row['humidity']):.1%}",
            "menisci": lambda row: OPENINGS[row["opening"]][1],
            "liquid below (nm)": cell("reach_nm"),
            "release (V)": _release,
            "work of opening (mJ/m²)": cell("energy_mJ_m2"),
            "pull-off (kPa)": cell("pull_off_kPa"),
            "sticks": _sticking,
        },
        heads=2,
    )


def _figure(rows: list[CsvRow]) -> Figure:
    return Figure(
        against_humidity(rows),
        f"{begins_to_stick(rows)} Left: release at central inputs; at zero the switch sticks."
        " Right: share that sticks of the points with about this humidity, over all that is"
        " uncertain, with its 95 % interval.",
        wide=True,
        front=True,
    )


def begins_to_stick(rows: list[CsvRow]) -> str:
    """From which humidity on the switch sticks, for each limit of opening."""
    outcome_by_label = {}
    for opening, (_, label) in OPENINGS.items():
        known = [row for row in rows if row["opening"] == opening and row["release_V"]]
        if known:
            outcome_by_label[label] = _sticks_from(known)
    different = set(outcome_by_label.values())
    if not different:
        return ""
    if len(different) == 1:
        return f"At central inputs the switch {different.pop()}."
    outcomes = (f"{outcome} ({label})" for label, outcome in outcome_by_label.items())
    return f"At central inputs the switch {'; '.join(outcomes)}."


def _sticks_from(rows: list[CsvRow]) -> str:
    """From which of rising humidities on it sticks, in words."""
    tried = [float(row["humidity"]) for row in rows]
    stuck = [
        humidity
        for humidity, row in zip(tried, rows, strict=True)
        if float(row["release_V"]) == 0.0
    ]
    free = [humidity for humidity in tried if not stuck or humidity < stuck[0]]
    where = f"at {tried[0]:.0%} humidity"
    if len(tried) > 1:
        where = f"at each humidity from {tried[0]:.0%} to {tried[-1]:.0%}"
    if not stuck:
        return f"lets go {where}"
    if not free:
        return f"sticks {where}"
    return f"sticks from between {free[-1]:.1%} and {stuck[0]:.1%} humidity on"


def _release(row: CsvRow) -> str:
    if not row["release_V"]:
        return "no answer"
    if float(row["release_V"]) == 0.0:
        return "sticks"
    return show(float(row["release_V"]))


def _sticking(row: CsvRow) -> str:
    """How many of the nearest points stick."""
    if not row["stuck"]:
        return "–"
    return f"{float(row['stuck']):.0%} of {row['points']}"


def against_humidity(rows: list[CsvRow]) -> str:
    """Release at central inputs, and the share that sticks."""
    top = max((float(row["release_V"]) for row in rows if row["release_V"]), default=0.0) or 1.0

    def plot(release, stuck):
        for opening, (color, label) in OPENINGS.items():
            of_rows = [row for row in rows if row["opening"] == opening and row["release_V"]]
            if of_rows:
                percent = 100.0 * column(of_rows, "humidity")
                release.plot(percent, column(of_rows, "release_V"), "o-", color=color, label=label)
        release.set(ylabel="release (V)", ylim=(-0.03 * top, 1.1 * top))
        release.legend()
        of_rows = [row for row in rows if row["stuck"]]
        if of_rows:
            share, low, high = (
                column(of_rows, name) for name in ("stuck", "stuck_low", "stuck_high")
            )
            percent = 100.0 * column(of_rows, "humidity")
            stuck.errorbar(percent, share, yerr=[share - low, high - share], fmt="o", color=BLUE)
        stuck.set(ylabel="share that sticks", ylim=(-0.03, 1.03))
        for axis in (release, stuck):
            axis.set(xlabel="relative humidity (%)")

    return draw("humidity", "Release and sticking against humidity", plot, (9.4, 3.4), columns=2)
