"""The life of a switch that is held."""

from collections.abc import Iterator
from typing import Any

from workflow.report.available import CsvRow, Results
from workflow.report.drawing import BLUE, GREEN, ORANGE, SOFT, draw
from workflow.report.numbers import cell, column, show, spread
from workflow.report.page import Block, Figure, stage, table
from workflow.report.verdict import volts

COLORS = {"least": SOFT, "central": BLUE, "most": ORANGE}
EFFECTS = {"beam": "creep of the beam", "tops": "creep of the tops", "bonds": "bonds"}
AGEING_COLORS = {"beam": ORANGE, "tops": GREEN, "bonds": BLUE, "all": SOFT}
PUBLISHED = "published lives of capacitive switches shorten tenfold for 5 to 7 V"
UNKNOWN = "the rates are not known"
SETTLED = "A measured drift of the same film would settle the rates."
CONTRADICTS = 0.01
NARROWED = "a measured drift leaves the rates so far open"
RATES = {
    "injection_A_m2": "injection",
    "barrier_eV": "barrier of emission",
    "traps_e_cm2": "most charge held",
    "recovery_exponent": "exponent of recovery",
    "activation_eV": "activation of injection",
}


@stage(
    "Held for years",
    "lifetime/lifetime.csv",
    "lifetime/holds.csv",
    "lifetime/lifetime.json",
    also=("lifetime/rates.json", "lifetime/ageing.csv"),
)
def describe(results: Results) -> Iterator[Block]:
    """Voltages against the time of hold, and what a hold voltage costs."""
    life = results.json("lifetime/lifetime.json")
    rows = results.csv("lifetime/lifetime.csv")
    narrowed = results.content("lifetime/rates.json")
    why = NARROWED if narrowed else UNKNOWN
    yield three_sentences(life, rows, why)
    yield Figure(
        _against_time(rows),
        "Release (left) and pull-in (right) against the time of hold. Lines: medians of the devices"
        f" by three guesses, since {why}; bands: 5 to 95 % of the devices.",
        wide=True,
        front=True,
    )
    yield (
        f"{_drive(life)} Charge enters where it touches, and by emission through narrow gaps; it"
        " lowers the field that brings it. The largest field"
        f" at a gap that just closes is {show(life['largest_field_V_nm'])} V/nm: a film breaks down"
        " below 1 V/nm, so that the fastest charge there is a bound."
        f" {'' if narrowed else SETTLED} {_allowed(life)}"
    )
    if ageing := results.rows("lifetime/ageing.csv"):
        yield of_ageing(life["ageing"], ageing)
        yield Figure(
            _ageing_against_time(ageing),
            "Release of the central switch without charge against the time of hold, by each effect"
            " of ageing alone and by all. Lines: central guess; bands: least to most ageing.",
        )
    if narrowed:
        yield of_drift(narrowed)
        yield table(
            "Rates before and after the measured drift, median and 5 to 95 %",
            [{"rate": name, **row} for name, row in narrowed["rates"].items()],
            {
                "rate": lambda row: f"{RATES[row['rate']]} ({row['unit']})",
                "before": lambda row: spread(row, "prior_q50", "prior_q05", "prior_q95"),
                "after": lambda row: spread(row, "posterior_q50", "posterior_q05", "posterior_q95"),
            },
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


def of_drift(narrowed: dict[str, Any]) -> str:
    """Which drift narrows the rates, and whether any rates give it."""
    words = f"{narrowed['rows']} shifts of {narrowed['file']} narrow the rates."
    if narrowed["source"]:
        words += f" Source: {narrowed['source']}."
    if narrowed["probability"] < CONTRADICTS:
        words += (
            " No rates give this drift: hardly any made-up ones fit as badly. An error is too"
            " small, the switch is another one, or a law of charging does not hold."
        )
    return words


def three_sentences(life: dict[str, Any], rows: list[CsvRow], why: str = UNKNOWN) -> str:
    """What a life of holding does, where it comes from, and what a volt costs."""
    first = {row["guess"]: row for row in rows if float(row["time_s"]) == 0.0}
    last = {row["guess"]: row for row in rows}
    fresh = volts(float(first["central"]["release_q50_V"]))
    low, middle, high = (
        volts(float(last[guess]["release_q50_V"])) for guess in ("least", "central", "most")
    )
    decades = [row["volts_a_decade"] for row in life["guesses"].values() if row["volts_a_decade"]]
    costs = "How fast it charges does not depend on the hold voltage here"
    if decades:
        span = " to ".join(
            dict.fromkeys(f"{show(volt, 2)}" for volt in (min(decades), max(decades)))
        )
        costs = f"It charges ten times as fast for each {span} V more of hold"
    return (
        f"Held at {volts(life['hold_V'])} for {show(life['years'])} years, the median release goes"
        f" from {fresh} to {middle} ({low} to {high}, since {why}). At first"
        f" {life['touching']:.2%} of the pulled area touches, and the mean field in the dielectric"
        f" is {show(life['contact_factor'])} times below that of full contact."
        f" {costs}; {PUBLISHED}."
    )


def _drive(life: dict[str, Any]) -> str:
    """How the electrode is driven."""
    cycles = life.get("cycles")
    if not cycles:
        return "The electrode is held at one voltage from first closing on."
    words = (
        f"The drive comes in cycles of {cycles['period_s']:g} s, of which the electrode is held"
        f" for {cycles['duty']:.3g}; charge leaks in the rests by a power law, whose exponent is"
        " assumed or measured."
    )
    if cycles["other_polarity"]:
        words += f" Of the hold {cycles['other_polarity']:.3g} is of the other polarity."
    return words


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
    final_V = {(row["effect"], row["guess"]): float(row["release_V"]) for row in rows}
    fresh = volts(float(rows[0]["release_V"]))
    changes = []
    for effect in ageing["strengths"]:
        low, middle, high = (
            volts(final_V[effect, guess]) for guess in ("most", "central", "least")
        )
        changes.append(f"{EFFECTS[effect]} it goes to {middle} ({low} to {high})")
    words = "; by ".join(changes) if changes else "no effect acts here"
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
