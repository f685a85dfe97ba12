"""The first screen: the device, its release with the zone where it sticks, causes and next step."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from mesoscale.settings import DeviceSettings
from workflow.report.available import Results
from workflow.report.numbers import show
from workflow.report.stages.humidity import begins_to_stick
from workflow.report.stages.topography import first_map
from workflow.report.verdict import (
    DECIDED,
    LITTLE,
    Verdict,
    does,
    in_words,
    interval_of,
    measured_of,
    pull_in_shrinks_by,
    verdict,
    volts,
)

KINDS = {
    "common": "To measure: one unknown value",
    "each": "To control: differs from device to device",
}
BANDS = {"unknown": "not known: the typical device", "between": "from device to device"}
TELLING_SHARE = 0.25
"""Of the interval's width: bands whose ends err by more are not told apart."""
LEFT, RIGHT = 70.0, 410.0
"""Ends of the bar's axis in its picture."""
FLOOR, ROW = 62.0, 28.0
"""Where the axis lies under the bar, and how much lower for each band."""


@dataclass(frozen=True)
class First:
    """Pictures and words of the first screen."""

    said: Verdict
    release: str
    pull_in: str
    conditions: str
    humidity: str
    device: str
    surface: tuple[str, str] | None
    bar: str
    has_errors: bool
    causes: list[tuple[str, list[tuple[str, int]]]]
    known: str
    unsolved: str
    other_law: str


def first_screen(results: Results, gates: Any) -> First | None:
    """The first screen; None without a switch on a pad."""
    said = verdict(results, gates)
    if said is None:
        return None
    other = ""
    if said.other_law_V:
        by_this, by_other = map(does, said.other_law_V)
        work = {"clamped": "a third of", "offset": "three times"}[results.contact["attraction"]]
        other = (
            "The law of attraction is a choice that nothing here decides. At central inputs the"
            f" switch {by_this} by this law; by the other one, with {work} the work of adhesion, it"
            f" {by_other}."
        )
    answer = results.json("answer/pad_switch.json").get("answer") or {}
    named = bool(said.causes)
    causes = [(head, _largest(answer, kind)) for kind, head in KINDS.items()] if named else []
    bands = _bands(answer) if named else {}
    return First(
        said,
        release=_release(results),
        pull_in=_pull_in(results.json("answer/pad_switch.json")),
        conditions=_conditions(results),
        humidity=begins_to_stick(results.rows("humidity/humidity.csv")),
        device=_device(results),
        surface=first_map(results),
        bar=release_bar(said, bands, answer.get("quantile_error_V")),
        has_errors=bool(answer),
        causes=causes,
        known=_known(answer, bands) if named else "",
        unsolved=_unsolved(answer),
        other_law=other,
    )


def _release(results: Results) -> str:
    """Which voltage is called release, and what a C-V curve shows beside it."""
    pad = results.json("answer/pad_switch.json")
    fallen = {row["release_at"]: row["release_V"] for row in pad.get("by_capacitance", ())}
    share = _release_at(results)
    if share != "jump":
        words = (
            f"Release: where the capacitance has fallen to {share:.0%} of that while held, as the"
            " voltage falls. It sticks if it never does."
        )
        if not fallen.get("jump"):
            return words
        return f"{words} The switch jumps open at {show(fallen['jump'])} V, at central inputs."
    words = (
        "Release: where the closed switch jumps open as its voltage falls; it sticks if it never"
        " does."
    )
    if not fallen.get(0.5):
        return words
    return (
        f"{words} Its capacitance has fallen to half before, at {show(fallen[0.5])} V at central"
        " inputs (device.release_at)."
    )


def _release_at(results: Results) -> Any:
    """What the scene calls release."""
    if not results.has("scene.yaml"):
        return "jump"
    return results.record["scene"]["device"].get("release_at", "jump")


def _pull_in(pad: dict[str, Any]) -> str:
    """The voltage that closes it, in words; empty where it is not known."""
    if not pad.get("answer") and not pad["central"]:
        return ""
    touches = "touches" in (pad["central"] or {})
    verb = "touches before it would snap," if touches else "closes"
    pressed = " What its hold voltage has above that presses it." if touches else ""
    if not pad.get("answer"):
        closes = f"{verb} at {show(pad['central']['pull_in_V'])} V, at central inputs"
    else:
        quantiles = pad["answer"]["pull_in_V"]["quantiles"]
        low, middle, high = (f"{show(quantiles[q])} V" for q in ("0.05", "0.5", "0.95"))
        closes = f"{verb} at {middle} {interval_of(low, high)}"
    return f"It {closes}.{pressed} {_check(pad)}"


def _check(pad: dict[str, Any]) -> str:
    """What to do with this pull-in, and by how much that narrows the release."""
    if row := measured_of(pad).get("pull_in_V"):
        return f"Measured: {show(row['value'])} ± {show(row['error'], 2)} V."
    shrinks = pull_in_shrinks_by(pad)
    if shrinks < LITTLE:
        return "Check this against a wafer first."
    return f"Measure this first (device.measured): it shrinks the interval by {shrinks:.0%}."


def _conditions(results: Results) -> str:
    """The air, the temperature and the charge that the answer is of."""
    if not results.has("scene.yaml"):
        return ""
    scene = results.record["scene"]
    device = DeviceSettings(**scene["device"])
    air = scene["contact"].get("air") or {}
    ends = results.span_of("humidity")
    if ends and ends[0] == ends[1]:
        words = f"In air of {ends[0]:.0%} humidity"
    elif ends:
        words = f"In air of {ends[0]:.0%} to {ends[1]:.0%} humidity"
    elif air.get("humidity"):
        words = f"In air of {air['humidity']:.0%} humidity"
    else:
        words = "In dry air"
    charge = "charged as the scene states" if device.charged else "uncharged"
    return f"{words}, at {device.temperature_C:g} °C, {charge}."


def _largest(answer: dict[str, Any], kind: str) -> list[tuple[str, int]]:
    """What makes the most of the variance, of one kind; shares in percent."""
    shares = [
        (in_words(row["name"]), round(100 * row["share_of_variance"]))
        for row in answer["sensitivity"]
        if row["varies"] == kind
    ]
    return [(name, percent) for name, percent in shares if percent > 0][:3]


def _bands(answer: dict[str, Any]) -> dict[str, Any]:
    """What is not known, and what differs between devices; nothing where the switches are too few
    to tell them apart.
    """
    bands = {kind: answer["known"][f"{kind}_V"] for kind in BANDS}
    release_V = answer["release_V"]["quantiles"]
    width_V = release_V["0.95"] - release_V["0.05"]
    errors_V = [band[end]["error"] for band in bands.values() for end in ("0.05", "0.95")]
    if max(errors_V) > TELLING_SHARE * width_V:
        return {}
    return bands


def _known(answer: dict[str, Any], bands: dict[str, Any]) -> str:
    """What is not known, and what differs between devices, in words."""
    fitted = f"a fit to {answer['points']} switches"
    if not bands:
        return (
            f"What is not known and what differs from device to device cannot be told apart by"
            f" {fitted}. More switches would (pad.points). {_sticking(answer)}"
        )
    typical, device = (_span(bands[kind]) for kind in BANDS)
    return (
        f"Not known: where the typical device lets go, {typical}. From device to device:"
        f" {device}, all else known. Both by {fitted}, with its error. {_sticking(answer)}"
    )


def _span(band: dict[str, dict[str, float]]) -> str:
    """The ends of a band with their errors; a release of 0 is a switch that sticks."""
    low, high = band["0.05"], band["0.95"]
    if high["value"] == 0.0:
        return "it sticks"
    first = _with_error(low) if low["value"] else "from sticking"
    return f"{first} to {_with_error(high)} V"


def _with_error(end: dict[str, float]) -> str:
    return f"{show(end['value'])}\u00a0±\u00a0{show(end['error'], 1)}"


def _sticking(answer: dict[str, Any]) -> str:
    """How many of one batch may stick."""
    limit = answer["known"]["stuck_share"]["0.95"]
    value, allowed = limit["value"], limit["high"]
    if value > DECIDED:
        return "A whole batch may stick."
    words = f"With 95 % confidence, less than {_rate(value)} of one batch stick."
    if _rate(allowed) == _rate(value):
        return words
    if allowed > DECIDED:
        return f"{words} The error of this limit allows that all stick."
    return f"{words} The error of this limit allows up to {_rate(allowed)}."


def _unsolved(answer: dict[str, Any]) -> str:
    """That some switches never close, or have no answer, which are no random part of them; the
    reason of the first.
    """
    words = []
    never = answer.get("never_close")
    if never and never["value"] > 0.0:
        words.append(
            f"{_rate(never['value'])} of the devices never close at the stated hold voltage (95 %"
            f" interval {_rate(never['low'])} to {_rate(never['high'])}). They are left out."
        )
    if refused := answer.get("refused"):
        words.append(_without_answer(refused, answer["points"]))
    return " ".join(words)


def _without_answer(refused: Sequence[str], solved: int) -> str:
    return (
        f"Of {solved + len(refused)} switches, {len(refused)} without an answer are left"
        f" out. They may be those that stick. The reason of the first: {refused[0]}."
    )


def _rate(share: float) -> str:
    """A share of devices."""
    return f"{share:.0%}" if share > 0.095 else f"{share:.1%}"


def release_bar(
    said: Verdict,
    bands: dict[str, Any] | None = None,
    errors_V: dict[str, float] | None = None,
) -> str:
    """The release on an axis of volts: 5 to 95 % as a bar, the zone of sticking at its left end.

    Parameters
    ----------
    bands : 5 to 95 % of what is not known, and of what differs between devices.
    errors_V : of the 5 and 95 % of the release, by the number of switches.
    """
    if said.release_V is None:
        return ""
    others = said.other_law_V or ()
    bands = bands or {}
    ends = [band["0.95"]["value"] + band["0.95"]["error"] for band in bands.values()]
    if errors_V:
        ends.append(said.release_V[-1] + errors_V["0.95"])
    top = 1.15 * max(*said.release_V, *others, *ends, 1.0)
    floor = FLOOR + len(bands) * ROW

    def x(value: float) -> str:
        return f"{LEFT + (RIGHT - LEFT) * value / top:.1f}"

    middle = said.release_V[len(said.release_V) // 2]
    share = "" if said.stuck is None else f" {100 * said.stuck[1]:.0f}\u202f%"
    parts = [
        f'<rect class="zone" x="0" y="8" width="{LEFT - 8:g}" height="{floor - 8:g}" rx="4"/>',
        f'<text x="{LEFT / 2 - 4:g}" y="32" class="mid">sticks</text>',
        f'<text x="{LEFT / 2 - 4:g}" y="50" class="mid strong">{share}</text>',
        *_axis(top, floor, x),
        *(
            _band(kind, FLOOR + row * ROW, band, x)
            for row, (kind, band) in enumerate(bands.items())
        ),
    ]
    if len(said.release_V) == 3 and said.release_V[2] > 0:
        low, _, high = said.release_V
        parts.append(f'<path class="interval" d="M{x(low)} 36H{x(high)}"/>')
        if errors_V:
            from_V = max(low - errors_V["0.05"], 0.0)
            to_V = high + errors_V["0.95"]
            parts.append(f'<path class="interval error" d="M{x(from_V)} 36H{x(to_V)}"/>')
    if middle > 0:
        parts += [
            f'<path class="median" d="M{x(middle)} 24v24"/>',
            f'<text x="{x(middle)}" y="18" class="mid strong">{show(middle)} V</text>',
        ]
    if others and others[1] > 0:
        parts.append(
            f'<circle class="other" cx="{x(others[1])}" cy="36" r="5"><title>other'
            " law</title></circle>"
        )
    label = f"Release voltage: {', '.join(volts(value) for value in said.release_V)}"
    return (
        f'<svg class="bar" viewBox="0 0 420 {floor + 40:g}" role="img"'
        f' aria-label="{label}">{"".join(parts)}</svg>'
    )


def _axis(top: float, floor: float, x: Callable[[float], str]) -> Iterator[str]:
    """The axis of volts, from 0 to a little below `top`."""
    steps = (0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1e3, 1e4, 1e5)
    step = next(step for step in steps if top / step <= 6)
    yield f'<path class="axis" d="M{LEFT:g} {floor:g}H{RIGHT:g}"/>'
    for k in range(int(top / step) + 1):
        at = x(k * step)
        yield f'<path class="axis" d="M{at} {floor:g}v5"/>'
        yield f'<text x="{at}" y="{floor + 20:g}" class="mid">{k * step:g}</text>'
    middle = (LEFT + RIGHT) / 2
    yield f'<text x="{middle:g}" y="{floor + 36:g}" class="mid">release voltage (V)</text>'


def _band(kind: str, above: float, band: dict[str, Any], x: Callable[[float], str]) -> str:
    """A band as a bar under its name, with its error as a thin line."""
    low, high = (band[end] for end in ("0.05", "0.95"))
    from_V = max(low["value"] - low["error"], 0.0)
    to_V = high["value"] + high["error"]
    y = above + 10
    return (
        f'<text x="{LEFT + 4:g}" y="{above:g}" class="name">{BANDS[kind]}</text>'
        f'<path class="{kind} error" d="M{x(from_V)} {y:g}H{x(to_V)}"/>'
        f'<path class="{kind}" d="M{x(low["value"])} {y:g}H{x(high["value"])}"/>'
    )


def _device(results: Results) -> str:
    """A picture of the switch with its sizes, not to scale."""
    if not results.has("scene.yaml"):
        return ""
    device = DeviceSettings(**results.record["scene"]["device"])
    rough = "".join(f"l4 {3 * (-1) ** k * (1 + k * 7 % 3) / 2:g}" for k in range(70))
    anchors = "M10 40h12v110H10zM378 40h12v110h-12z"
    if device.kind == "plate":
        metal = (
            '<path class="metal" d="M90 110h220"/><path class="rest" d="M200 30v10l-8 5 16'
            ' 8-16 8 16 8-16 8 8 5v28"/>'
        )
        size = f"plate on a spring of {show(device.spring_N_per_m)} N/m"
    elif device.ends == "cantilever":
        anchors = "M10 40h12v110H10z"
        metal = '<path class="metal" d="M20 40h30q110 0 190 50q50 20 100 20"/>'
        size = f"cantilever of {device.length_um:g} × {device.width_um:g} µm"
    else:
        metal = '<path class="metal" d="M20 40h30q25 0 60 46q20 24 90 24t90-24q35-46 60-46h30"/>'
        size = f"beam of {device.length_um:g} × {device.width_um:g} µm, bending"
    hold = (
        f"held at {device.hold_voltage_V:g} V"
        if device.hold_voltage_V
        else "held at its pull-in voltage"
    )
    return (
        '<svg class="device" viewBox="0 0 400 190" role="img" aria-label="The switch:'
        f' {size}"><path class="rest" d="M20 40H380"/><path class="anchor"'
        f' d="{anchors}"/>{metal}<path class="rough" d="M60 116{rough}V138H60z"/><rect'
        ' class="anchor" x="60" y="138" width="280" height="12"/><text x="200" y="24"'
        f' class="mid">{size}</text><text x="200" y="62" class="mid">gap {device.gap_um:g}'
        f' µm</text><text x="200" y="168" class="mid">dielectric of {device.dielectric_nm:g} nm,'
        f' rough</text><text x="200" y="185" class="mid">{hold}</text></svg>'
    )
