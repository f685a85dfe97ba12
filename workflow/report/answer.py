"""The first screen: the law with its intervals, the hysteresis, the switch, and what matters most."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from mesoscale.law.parameters import LAW
from workflow.report.available import Results, Row
from workflow.report.numbers import OUTPUTS, SYMBOLS, column, number, show
from workflow.report.page import Gate, Table
from workflow.report.stages import law
from workflow.report.stages.sensitivity import ranking
from workflow.report.verdict import release_cards, release_causes, verdict


def answer(results: Results, gates: Sequence[Gate]) -> dict[str, Any]:
    """Sentences, table and figure that open the report."""
    content: dict[str, Any] = {"verdict": verdict(results, gates), "method": "", "figure": None, "table": None}
    content["cards"] = release_cards(results)
    if results.has("uq/outputs.csv", "uq/samples.csv"):
        rows = {row["output"]: row for row in results.csv("uq/outputs.csv")}
        samples = results.csv("uq/samples.csv")
        content["method"] = (
            f"Numbers of the law on this screen come from the {results.response} at {len(samples)} samples of the "
            "inputs. Their intervals hold what the inputs leave open, not the scatter from one surface to the next."
        )
        content["table"] = _law_table(results, rows, samples)
        content["cards"] += _law_cards(results, rows, samples)
    if results.has("uq/sensitivity.csv") and ranking(results.csv("uq/sensitivity.csv"), "d_c_nm"):
        content["cards"].append(_cause_card(results))
    if results.has("device/switch.json") and not release_cards(results):
        content["cards"].append(_switch_card(results.json("device/switch.json")))
    if results.has("device/law.csv", "device/switch.json", "uq/samples.csv"):
        content["figure"] = law.band(results)
    return content


def _law_cards(results: Results, rows: dict[str, Row], samples: list[Row]) -> list[dict[str, str]]:
    closing, opening = (column(samples, f"{branch}_d_c_nm") for branch in ("closing", "opening"))
    d_c, delta = rows["d_c_nm"], rows["delta_d_c_nm"]
    return [
        {
            "title": "Contact begins at",
            "value": f"{show(np.nanmean(closing))} nm",
            "detail": f"mean separation d_c; 5 to 95 %: {_interval(d_c)} nm{_beside(d_c, results)}",
        },
        {
            "title": "Hysteresis",
            "value": f"{show(np.nanmean(opening - closing))} nm",
            "detail": f"shift of contact on opening; 5 to 95 %: {_interval(delta)} nm{_beside(delta, results)}",
        },
    ]


def _cause_card(results: Results) -> dict[str, str]:
    rows = results.csv("uq/sensitivity.csv")
    ranked = ranking(rows, "d_c_nm")
    name, share = ranked[0]
    words = f"{min(share, 1):.0%} of the variance of d_c"
    opening = ranking(rows, "delta_d_c_nm")
    if opening:
        pairs = [f"{SYMBOLS.get(key, key)} {min(part, 1):.0%}" for key, part in opening[:3]]
        words += "; of the hysteresis: " + ", ".join(pairs)
    if causes := release_causes(results):
        words += "; of the release: " + ", ".join(f"{symbol} {share:.0%}" for symbol, share in causes[:3])
    return {"title": "Main cause of the spread", "value": SYMBOLS.get(name, name), "detail": words}


def _switch_card(switch: dict[str, Any]) -> dict[str, str]:
    with_adhesion, without = switch["with_adhesion"], switch["without_adhesion"]
    stuck = with_adhesion["stiction_probability"]["value"]
    last = f"{switch['switch']['last_share']:.2%} of the electrode come off last"
    release = with_adhesion["release_V"]["quantiles"]
    free = f"{show(without['release_V']['quantiles']['0.5'])} V without adhesion"
    if stuck >= 0.5 or not release:
        value = f"{stuck:.0%} stick"
        detail = f"of the samples of the example switch, where {last}; "
        detail += (
            f"the others release at {show(release['0.5'])} V (median); {free}" if release else f"release at {free}"
        )
    else:
        value = f"{show(release['0.5'])} V"
        detail = f"median of the example switch; {free}; {stuck:.0%} stick, where {last}"
    return {"title": "Release", "value": value, "detail": detail}


def _law_table(results: Results, rows: dict[str, Row], samples: list[Row]) -> Table:
    lines = []
    for parameter in LAW:
        name = parameter.name
        symbol, unit, factor = OUTPUTS[name]
        cells = [f"{symbol} ({unit}), {parameter.meaning}"]
        for branch in ("closing", "opening"):
            values = column(samples, f"{branch}_{name}") * factor
            values = values[np.isfinite(values)]
            low, high = np.quantile(values, [0.05, 0.95])
            cells.append(f"{show(values.mean())} [{show(low)}, {show(high)}]")
        if results.beside_paper:
            mean, dev = (number(rows[name][f"paper_{key}"]) * factor for key in ("mean", "dev"))
            cells.append(f"{show(mean)} ± {show(dev)}")
        lines.append(cells)
    return Table(
        "The force–separation law: mean and 5 to 95 % interval over all uncertain inputs",
        ("parameter", "closing", "opening", *(["paper, closing (mean ± dev)"] if results.beside_paper else [])),
        lines,
    )


def _interval(row: Row) -> str:
    return f"{show(row['response_q05'])} to {show(row['response_q95'])}"


def _beside(row: Row, results: Results) -> str:
    return f"; the paper has {show(row['paper_mean'])} ± {show(row['paper_dev'])} nm" if results.beside_paper else ""
