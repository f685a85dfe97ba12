"""The switch from dry to humid air."""

from collections.abc import Iterator

from workflow.report.available import Results, Row
from workflow.report.drawing import BLUE, ORANGE, draw
from workflow.report.numbers import cell, column, show
from workflow.report.page import Block, Figure, stage, table

OPENINGS = {"balance": (BLUE, "menisci in balance with the vapour"), "volume": (ORANGE, "their volume stays")}


@stage("Humid air", "device/humidity.csv")
def describe(results: Results) -> Iterator[Block]:
    """Release and sticking against humidity."""
    rows = results.csv("device/humidity.csv")
    yield (
        "Water condenses in narrow gaps and pulls. While the switch opens it stays in balance with the vapour, or its "
        "volume stays, where opening is too fast to evaporate it: both limits are shown. The air must have stood "
        "around the closed switch for some seconds, in which it condenses."
    )
    yield Figure(
        against_humidity(rows),
        "Left: release at central inputs; at zero the switch sticks. Right: share that sticks of the points with about "
        "this humidity, over all that is uncertain, with its 95 % interval.",
        wide=True,
        front=True,
    )
    yield table(
        "The switch against humidity",
        rows,
        {
            "humidity": lambda row: f"{float(row['humidity']):.1%}",
            "menisci": lambda row: OPENINGS[row["opening"]][1],
            "release (V)": _release,
            "work of opening (mJ/m²)": cell("energy_mJ_m2"),
            "pull-off (kPa)": cell("pull_off_kPa"),
            "sticks": lambda row: f"{float(row['stuck']):.0%}" if row["stuck"] else "–",
        },
        heads=2,
    )


def _release(row: Row) -> str:
    if not row["release_V"]:
        return "no answer"
    return "sticks" if float(row["release_V"]) == 0.0 else show(float(row["release_V"]))


def against_humidity(rows: list[Row]) -> str:
    """Release at central inputs, and the share that sticks."""

    def plot(release, stuck):
        for opening, (color, label) in OPENINGS.items():
            part = [row for row in rows if row["opening"] == opening and row["release_V"]]
            if part:
                release.plot(column(part, "humidity"), column(part, "release_V"), "o-", color=color, label=label)
        release.set(xlabel="relative humidity", ylabel="release (V)", ylim=(0, None))
        release.legend()
        part = [row for row in rows if row["stuck"]]
        if part:
            share, low, high = (column(part, name) for name in ("stuck", "stuck_low", "stuck_high"))
            stuck.errorbar(column(part, "humidity"), share, yerr=[share - low, high - share], fmt="o", color=BLUE)
        stuck.set(xlabel="relative humidity", ylabel="share that sticks", ylim=(-0.03, 1.03))

    return draw("humidity", "Release and sticking against humidity", plot, (9.4, 3.4), columns=2)
