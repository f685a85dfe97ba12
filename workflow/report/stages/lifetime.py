"""The life of a switch that is held."""

from collections.abc import Iterator
from typing import Any

from workflow.report.available import CsvRow, Results
from workflow.report.drawing import BLUE, GREEN, ORANGE, SOFT, draw
from workflow.report.numbers import cell, column, show
from workflow.report.page import Block, Figure, stage, table
from workflow.report.verdict import volts

COLORS = {"least": SOFT, "central": BLUE, "most": ORANGE}
EFFECTS = {"beam": "creep of the beam", "tops": "creep of the tops", "bonds": "bonds"}
AGEING_COLORS = {"beam": ORANGE, "tops": GREEN, "bonds": BLUE, "all": SOFT}
PUBLISHED = "published lives of capacitive switches shorten tenfold for 5 to 7 V"
UNKNOWN = "the rates are not known"


@stage(
    "Held for years",
    "lifetime/lifetime.csv",
    "lifetime/holds.csv",
    "lifetime/lifetime.json",
    also=("lifetime/ageing.csv",),
)
def describe(results: Results) -> Iterator[Block]:
    """Voltages against the time of hold, and what a hold voltage costs."""
    life = results.json("lifetime/lifetime.json")
    rows = results.csv("lifetime/lifetime.csv")
    yield three_sentences(life, rows)
    yield Figure(
        _against_time(rows),
        "Release (left) and pull-in (right) against the time of hold. Lines: medians of the devices"
        f" by three guesses, since {UNKNOWN}; bands: 5 to 95 % of the devices.",
        wide=True,
        front=True,
    )
    yield (
        "The electrode is held at one voltage from first closing on. Charge enters where it"
        " touches, and by emission through narrow gaps; it lowers the field that brings it. The"
        " largest field"
        f" at a gap that just closes is {show(life['largest_field_V_nm'])} V/nm: a film breaks down"
        " below 1 V/nm, so that the fastest charge there is a bound. A measured drift of the same"
        f" film would settle the rates. {_allowed(life)}"
    )
    if ageing := results.rows("lifetime/ageing.csv"):
        yield of_ageing(life["ageing"], ageing)
        yield Figure(
            _ageing_against_time(ageing),
            "Release of the central switch without charge against the time of hold, by each effect"
            " of ageing alone and by all. Lines: central guess; bands: least to most ageing.",
        )
    holds = [row for row in results.csv("lifetime/holds.csv") if row["guess"] == "central"]
    yield table(
        "The end of the life at other hold voltages, at the central guess; shares that fail are"
        " normal tails",
        holds[::2],
        {
            "hold": lambda row: volts(float(row["hold_V"])),
            "shift": lambda row: volts(float(row["shift_V"])),
            "sticks": cell("sticking", 2),
            "opens by itself": cell("lost", 2),
            "s to a shift of 1 V": cell("time_to_1V_s", 2),
        },
        heads=1,
    )


def three_sentences(life: dict[str, Any], rows: list[CsvRow]) -> str:
    """What a life of holding does, where it comes from, and what a volt costs."""
    first = {row["guess"]: row for row in rows if float(row["time_s"]) == 0.0}
    last = {row["guess"]: row for row in rows}
    fresh = volts(float(first["central"]["release_q50_V"]))
    low, middle, high = (
        volts(float(last[guess]["release_q50_V"])) for guess in ("least", "central", "most")
    )
    decades = [of["volts_a_decade"] for of in life["guesses"].values() if of["volts_a_decade"]]
    costs = "How fast it charges does not depend on the hold voltage here"
    if decades:
        span = " to ".join(
            dict.fromkeys(f"{show(volt, 2)}" for volt in (min(decades), max(decades)))
        )
        costs = f"It charges ten times as fast for each {span} V more of hold"
    return (
        f"Held at {volts(life['hold_V'])} for {show(life['years'])} years, the median release goes"
        f" from {fresh} to {middle} ({low} to {high}, since {UNKNOWN}). At first"
        f" {life['touching']:.2%} of the pulled area touches, and the mean field in the dielectric"
        f" is {show(life['contact_factor'])} times below that of full contact."
        f" {costs}; {PUBLISHED}."
    )


def _allowed(life: dict[str, Any]) -> str:
    """The largest hold voltage with no more than one failure in a million, by each guess."""
    largest = []
    for guess, of_guess in life["guesses"].items():
        hold_V = of_guess["highest_hold_V"]
        words = "none" if hold_V is None else volts(hold_V)
        if hold_V == of_guess["tried_V"]:
            words = f"at least {words}"
        largest.append(f"{words} ({guess} charge)")
    return (
        f"With no more than one failure in a million the largest hold is {', '.join(largest)},"
        " extrapolated by normal tails."
    )


def of_ageing(ageing: dict[str, Any], rows: list[CsvRow]) -> str:
    """What creep and bonds do by the end of the life, and that menisci are there before."""
    ends = {(row["effect"], row["guess"]): float(row["release_V"]) for row in rows}
    fresh = volts(float(rows[0]["release_V"]))
    said = []
    for effect in ageing["strengths"]:
        low, middle, high = (volts(ends[effect, guess]) for guess in ("most", "central", "least"))
        said.append(f"{EFFECTS[effect]} it goes to {middle} ({low} to {high})")
    words = "; by ".join(said) if said else "no effect acts here"
    return (
        f"Without charge the central switch lets go at {fresh} at first. By {words}. Ranges of"
        " relaxing shares, grains, hardness and bonds are assumptions. Menisci form within"
        f" {show(1e3 * ageing['menisci_99_s'], 2)} ms of closing, so that only shorter holds have"
        " fewer."
    )


def _ageing_against_time(rows: list[CsvRow]) -> str:
    def plot(axis):
        for effect, color in AGEING_COLORS.items():
            by_guess = {
                guess: [
                    row
                    for row in rows
                    if (row["effect"], row["guess"]) == (effect, guess) and float(row["time_s"])
                ]
                for guess in COLORS
            }
            if not by_guess["central"]:
                continue
            times = column(by_guess["central"], "time_s")
            low, middle, high = (
                column(by_guess[guess], "release_V") for guess in ("most", "central", "least")
            )
            axis.fill_between(times, low, high, color=color, alpha=0.15, linewidth=0)
            axis.plot(times, middle, color=color, label=EFFECTS.get(effect, effect))
        axis.set(xscale="log", xlabel="time of hold (s)", ylabel="release (V)")
        axis.legend()

    return draw("lifetime-ageing", "Release against hold time, by ageing", plot)


def _against_time(rows: list[CsvRow]) -> str:
    def plot(release, pull_in):
        for axis, name in ((release, "release"), (pull_in, "pull_in")):
            for guess, color in COLORS.items():
                of_guess = [
                    row for row in rows if row["guess"] == guess and float(row["time_s"]) > 0.0
                ]
                times = column(of_guess, "time_s")
                low, middle, high = (
                    column(of_guess, f"{name}_{end}_V") for end in ("q05", "q50", "q95")
                )
                axis.fill_between(times, low, high, color=color, alpha=0.15, linewidth=0)
                axis.plot(times, middle, color=color, label=f"{guess} charge")
            axis.set(xscale="log", xlabel="time of hold (s)")
        release.set(ylabel="release (V)")
        pull_in.set(ylabel="pull-in (V)")
        release.legend()

    return draw("lifetime", "Release and pull-in against hold time", plot, (9.4, 3.4), columns=2)
