"""What the scene says of its switch: one quantity of one model, on the page, in `asperity compare`
and at a run's end.

It is the release, and the sticking, of the scene's electrode on the pad over all that is uncertain.
Where this interval cannot be had, the value at central inputs stands, with the reason.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from mesoscale.settings import DeviceSettings
from mesoscale.settings.definitions import BY_NAME
from mesoscale.settings.device import unit_of
from workflow.report.available import Results
from workflow.report.gates import gates_of, other_law_V
from workflow.report.numbers import show, shown_unit
from workflow.report.page import Gate

NAMES = {
    "rms_scatter": ("roughness from place to place", "the roughness from place to place"),
    "gap_cutoff_nm": ("D₀", "the pull-off of the contact, which tells D₀"),
    "thickness_um": ("thickness", "the thickness of the electrode"),
    "gap_um": ("gap", "the gap at rest"),
    "youngs_modulus_GPa": ("E of the beam", "Young's modulus of the electrode"),
    "residual_stress_MPa": ("stress", "the residual stress of the electrode"),
    "dielectric_nm": ("dielectric", "the thickness of the dielectric"),
    "permittivity": ("permittivity", "the permittivity of the dielectric"),
    "bow_nm": ("bow", "the bow of the electrode at rest"),
    "tilt_nm": ("tilt", "the tilt of the electrode at rest"),
    "temperature_C": ("temperature", "the temperature of the switch"),
    "shift_V": ("shift of the voltage", "the shift of the C–V curve"),
    "charge_e_cm2": ("charge", "the shift of the C–V curve"),
    "length_um": ("length", "the length of the electrode"),
    "hold_voltage_V": ("hold voltage", "the hold voltage"),
    "spring_N_per_m": ("spring", "the stiffness of the spring"),
    "width_um": ("width of the plate", "the width of the plate"),
}
CELLS = "number of cells"
DECIDED = 0.95
"""Probability from which on a switch is said to stick, or to let go."""
LITTLE = 0.05
"""Share of the interval: a measurement that takes off less is not named."""


@dataclass(frozen=True)
class Verdict:
    """Release and sticking, and what they hang on.

    Attributes
    ----------
    release_V : 5 %, median and 95 %, 0 where it sticks; without an interval the central value
        alone; None: not known.
    stuck : probability of sticking with its 95 % interval; None without an interval.
    no_interval : why there is none; empty where there is one.
    causes : shares of the variance, largest first.
    no_cause : why no cause is named; empty where they are.
    other_law_V : release at central inputs by this law of attraction and by the other one; None
        where not computed.
    next_step : what to do.
    """

    electrode: str
    release_V: tuple[float, ...] | None
    stuck: tuple[float, float, float] | None
    no_interval: str
    causes: tuple[tuple[str, float], ...]
    no_cause: str
    other_law_V: tuple[float, float] | None
    next_step: str

    @property
    def outcome(self) -> str:
        """What the switch does, in a sentence."""
        if self.release_V is None:
            return f"The release voltage is not known, because {self.no_interval}."
        if self.stuck is None:
            return (
                f"At central inputs the switch {does(*self.release_V)}; no interval, because"
                f" {self.no_interval}."
            )
        low, middle, high = self.release_V
        probability = self.stuck[1]
        if probability >= DECIDED:
            return f"The switch sticks, with a probability of {probability:.0%}."
        interval = interval_of(volts(low), volts(high))
        if probability <= 1 - DECIDED:
            return f"The switch lets go at {volts(middle)} {interval}; {probability:.0%} stick."
        median = f"is {volts(middle)}" if middle else "sticks"
        return (
            f"Whether the switch lets go is open: {probability:.0%} stick; the median {median}"
            f" {interval}."
        )

    @property
    def sentence(self) -> str:
        """Outcome and next step."""
        return f"{self.outcome} {self.next_step}"


def verdict(results: Results, gates: Sequence[Gate] | None = None) -> Verdict | None:
    """The verdict of a scene; None without a switch on a pad."""
    if not results.has("answer/pad_switch.json"):
        return None
    pad = results.json("answer/pad_switch.json")
    answer = pad.get("answer")
    release = None
    stuck = None
    no_interval = ""
    causes = ()
    no_cause = ""
    if answer:
        release = tuple(answer["release_V"]["quantiles"][q] for q in ("0.05", "0.5", "0.95"))
        stuck = tuple(answer["stuck"][key] for key in ("low", "value", "high"))
        causes, no_cause = causes_of(answer)
    else:
        if pad["central"]:
            release = (pad["central"]["release_V"],)
        else:
            no_interval = "; ".join(pad["gate"]["reasons"])
        no_interval = no_interval or pad["answer_status"]
    if gates is None:
        gates = gates_of(results)
    failed = [gate for gate in gates if gate.used and gate.answer and not gate.passed]
    electrode = "flat electrode"
    if pad.get("electrode", "bending") == "bending":
        electrode = "bending electrode"
    return Verdict(
        electrode,
        release,
        stuck,
        no_interval,
        causes,
        no_cause,
        other_law_V(results),
        _next(pad, failed, no_cause, results.coupled),
    )


def interval_of(low: str, high: str) -> str:
    """The ends of an interval, in words that no line end parts."""
    return f"(5\u00a0%:\u00a0{low}; 95\u00a0%:\u00a0{high})"


def volts(value: float) -> str:
    """A release voltage in words."""
    if value == 0:
        return "sticks"
    return f"{show(value)} V"


def does(release_V: float) -> str:
    """What a switch does, as a verb."""
    if release_V == 0:
        return "sticks"
    return f"lets go at {show(release_V)} V"


def in_words(name: str) -> str:
    """How the page calls what varies: in words, with its symbol."""
    if name in NAMES:
        return NAMES[name][0]
    if name not in BY_NAME:
        return name
    quantity = BY_NAME[name]
    if quantity.symbol in quantity.label.split():
        return quantity.label
    return f"{quantity.label} {quantity.symbol}"


def labelled(key: str) -> str:
    """A property of the device, or an input of the contact, with its unit."""
    if key in DeviceSettings.model_fields:
        return f"{NAMES[key][0]} ({shown_unit(unit_of(key))})"
    row = BY_NAME[key]
    return row.label if row.unit == "1" else f"{row.label} ({shown_unit(row.unit)})"


def causes_of(answer: dict[str, Any]) -> tuple[tuple[tuple[str, float], ...], str]:
    """Shares of the variance by cause, and why none is named."""
    rows = [(in_words(row["name"]), row["share_of_variance"]) for row in answer["sensitivity"]]
    rows.append((CELLS, answer["causes"]["cells"]))
    rows = [(name, share) for name, share in rows if share > 0]
    if not rows:
        return (), f"all {answer['points']} computed combinations of what is uncertain do the same"
    explained = answer["explained"]
    if explained < 0.5:  # of switches left out: less does not tell a cause
        many = f"the {answer['points']} computed switches"
        reason = (
            f"a fit to {many} explains only {explained:.0%} of the variance of those that are"
            " left out"
        )
        if explained <= 0:
            reason = (
                f"{many} are too few to tell, as a fit to all but one does not predict that one"
            )
        return (), reason
    return tuple(sorted(rows, key=lambda row: -row[1])), ""


def _freedom(pad: dict[str, Any]) -> str:
    """What would free a switch that sticks, with the least change of a property; a sentence."""
    tried = (pad.get("reserve") or {}).get("freed_by", ())
    rows = [row for row in tried if row["frees"] is not None]
    if tried and not rows:
        return "At central inputs no single property frees it, up to three times its value."
    if not rows:
        return "A stiffer or shorter beam might free it."
    nearest = min(rows, key=lambda row: abs(row["frees"] - row["value"]) / abs(row["value"] or 1.0))
    value = with_unit(nearest["frees"], nearest["unit"])
    return f"At central inputs it is freed by: {in_words(nearest['key'])} {value}."


def measured_of(pad: dict[str, Any]) -> dict[str, Any]:
    """What was measured of the device, by name."""
    return (pad.get("measured") or {}).get("measured", {})


def pull_in_shrinks_by(pad: dict[str, Any]) -> float:
    """Share by which a measured pull-in shrinks the interval of the release; 0 where it is
    measured, and of a plate, of which it is not.
    """
    if "pull_in_V" in measured_of(pad) or pad.get("electrode") == "flat":
        return 0.0
    return (pad.get("answer") or {}).get("pull_in_shrinks_by", 0.0)


def with_unit(value: float, unit: str) -> str:
    """A property of the device or an input, with its unit."""
    if unit == "1":
        return show(value)
    return f"{show(value)} {shown_unit(unit)}"


def _fewer_stick(pad: dict[str, Any]) -> str:
    """With which change of one property fewer switches stick; a sentence with a space before it."""
    rows = pad.get("sticking_by_key")
    if not rows:
        return ""
    row = rows[0]
    changed = f"{in_words(row['key'])} {with_unit(row['other'], row['unit'])}"
    now = f"{pad['answer']['stuck']['value']:.0%}"
    switches = f"the {pad['answer']['points']} switches"
    return f" With {changed}, {row['stuck']:.0%} of {switches} would stick instead of {now}."


def _next(pad: dict[str, Any], failed: Sequence[Gate], no_cause: str, coupled: bool) -> str:
    """What to do next, in a sentence; empty where nothing is known."""
    if failed:
        return f"Mend first what failed: {', '.join(gate.stage for gate in failed)}."
    answer = pad.get("answer")
    if not answer and not pad["central"]:
        return ""
    if not answer:
        return "The interval comes first."
    sticks = answer["stuck"]["value"] >= DECIDED
    if sticks and coupled:
        return f"Measure a pull-off force next (target calibration). {_freedom(pad)}"
    if sticks:
        return f"No better measurement would free it. {_freedom(pad)}"
    freed = ""
    if pad["central"] and pad["central"]["release_V"] == 0.0 and pad.get("reserve"):
        freed = f"{_freedom(pad)} "
    return f"{freed}{_narrows(pad, no_cause)}{_fewer_stick(pad)}".strip()


def _narrows(pad: dict[str, Any], no_cause: str) -> str:
    """What narrows the interval, in a sentence; empty where nothing is known."""
    answer = pad["answer"]
    rows = answer["sensitivity"]
    if no_cause and answer["explained"] <= 0:
        return "Compute more switches next (pad.points)."
    if not rows or answer["causes"]["cells"] > rows[0]["share_of_variance"]:
        return "Compute more cells next (pad.point_cells)."
    if no_cause:
        return "More switches might tell what decides it (pad.points)."
    by_pull_in = pull_in_shrinks_by(pad)
    if by_pull_in > max(LITTLE, rows[0]["interval_shrinks_by"]):
        return (
            "Measure next the pull-in of the device (device.measured): known exactly, it shrinks"
            f" the interval by {by_pull_in:.0%}."
        )
    name = rows[0]["name"]
    shrinks = f"known exactly, it shrinks the interval by {rows[0]['interval_shrinks_by']:.0%}"
    _, measured_name = NAMES.get(name, ("", f"the {in_words(name)}"))
    if rows[0]["varies"] == "each":
        return f"Control next {measured_name}: {shrinks}."
    if name == "rms_scatter":
        return f"Scan more places next: the roughness varies from place to place; {shrinks}."
    return f"Measure next {measured_name}: {shrinks}."
