"""The report page: complete, self-contained, only what exists, alive in a real browser."""

import base64
import io
import json
import re
import shutil
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import matplotlib
import numpy as np
import pytest
from PIL import Image

from mesoscale.inputs.table import from_rows
from tests.workflow.browser import probed
from workflow.files.results import write_csv
from workflow.report.available import Results
from workflow.report.drawing import draw
from workflow.report.figures import figures_of
from workflow.report.gates import gates_of, trust
from workflow.report.numbers import show
from workflow.report.page import Figure
from workflow.report.render import render
from workflow.report.stages import pad
from workflow.report.stages.humidity import OPENINGS, against_humidity, begins_to_stick
from workflow.report.stages.humidity import describe as describe_humidity
from workflow.report.stages.inputs import _distribution, stated_beside_computed
from workflow.report.stages.topography import first_map
from workflow.report.studies import Error, KnobTable, Value, pareto_front, recommended, tables_of

ROOT = Path(__file__).resolve().parents[2]
SECTIONS = (
    "hardness",
    "elastic",
    "topography",
    "contact",
    "law",
    "uncertainty",
    "sensitivity",
    "pad",
    "answer",
)
ON_TOP = ("history", "calibration", "accuracy", "stability")


@pytest.fixture(scope="module")
def page(page_of):
    return page_of("paper")


def test_figures_of_the_page_stand_alone(page):
    """Each is one whole SVG in colours that any program knows."""
    figures = figures_of(page)
    assert len(figures) == len(re.findall(r'id="[\w-]+-figure_1"', page))
    assert {"budget-bars", "spots", "fig4"} <= figures.keys()
    for name, picture in figures.items():
        root = ElementTree.fromstring(picture)
        assert root.tag == "{http://www.w3.org/2000/svg}svg", name
        assert not re.search(r"var\(--(?!width)", picture), name
    assert "#0072b2" in figures["budget-bars"], "the blue of the light page"


def test_every_table_of_a_report_has_its_caption_and_none_is_left():
    rules = "".join(path.read_text() for path in (ROOT / "workflow/rules").glob("*.smk"))
    tables = set(re.findall(r'captioned\(f"{RESULTS}/([\w/]+)\.csv"\)', rules))
    folder = ROOT / "workflow/report/captions"
    captions = {str(file.relative_to(folder).with_suffix("")) for file in folder.rglob("*.rst")}
    assert tables == captions - {"page", "figure", "workflow"}


class Outline(HTMLParser):
    """Ids, references and images of a page."""

    def __init__(self):
        super().__init__()
        self.ids, self.outside, self.loaded, self.labels, self.figures = [], [], [], 0, 0

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        if "id" in attributes:
            self.ids.append(attributes["id"])
        for name in ("src", "href", "xlink:href", "action", "data"):
            value = attributes.get(name) or ""
            if value and not value.startswith(("#", "data:")):
                (self.outside if tag == "a" else self.loaded).append(value)
        if tag == "svg":
            self.figures += 1
            self.labels += bool(attributes.get("aria-label"))


def outline(page):
    parser = Outline()
    parser.feed(page)
    return parser


def test_every_stage_has_its_method_and_every_figure_is_drawn(page):
    for anchor in (*SECTIONS, *ON_TOP):
        assert f'id="{anchor}"><summary>' in page
    for number in (4, 5, 7, 8, 9, 10, 11):
        assert f"Figure {number} of the paper" in page
    assert "the paper&#39;s Table 2" in page
    assert "the paper&#39;s Table 3" in page


def test_the_page_is_short(page):
    """Of all stages at once: 1,200 words that are not folded, in five parts with an index that
    stays.
    """
    body = re.sub(
        r"<(details|svg|script|noscript|style).*?</\1>",
        "",
        page[page.index("<body>") :],
        flags=re.DOTALL,
    )
    words = re.sub(r"<[^>]*>", " ", body).replace("\u202f", "").split()
    assert len(words) <= 1250  # the numerical errors of each stage among them
    assert re.findall(r'href="#(part-\w+)">', page[: page.index("<main>")]) == [
        f"part-{name}" for name in ("budget", "switch", "contact", "from", "trust")
    ]
    assert "nav { position: sticky" in page


def test_crystals_are_named(page):
    assert "beta crystal, GGA" in page
    assert "a03 crystal" not in page


def test_page_is_self_contained_small_and_well_formed(made_up, page):
    found = outline(page)
    root, paths = made_up
    results = {path.relative_to(root).as_posix() for path in paths}
    assert set(found.loaded) == set()
    linked = set(found.outside)
    assert results <= linked, "a file behind the page that it does not link"
    assert all(re.fullmatch(r"[\w.][\w./-]*", name) and ".." not in name for name in linked)
    assert "@import" not in page
    assert "<script" not in page
    assert "http-equiv" in page
    assert len(page.encode()) < 2e6
    twice = {name for name in found.ids if found.ids.count(name) > 1}
    assert not twice, "ids of two figures collide"
    assert found.labels == found.figures, "a figure without a text alternative"


def test_only_what_exists_is_shown(made_up):
    root, paths = made_up
    few = [path for path in paths if path.name in ("inputs.csv", "scene.yaml")]
    page = render(Results(root, few, "few"))
    assert re.findall(r'<section id="([^"]+)"', page) == ["first", "part-from", "part-trust"]


def test_gates_tell_what_failed_and_text_is_escaped(made_up, page):
    root, paths = made_up
    found = {gate.stage: gate for gate in gates_of(Results(root, paths, "made_up"))}
    assert not found["hardness"].passed
    assert found["law"].passed
    (remark,) = found["law"].reasons
    assert remark == "1 of 3 fits miss their curve by up to 20% of its maximum"
    assert not found["uncertainty"].passed
    assert 'class="fail"' in page
    assert "&lt;gave&gt;" in page
    assert "<gave>" not in page


def test_a_stage_that_no_input_comes_from_shows_no_red_gate(made_up):
    root, paths = made_up
    results = Results(root, paths, "made_up")
    unused = [{**row, "origin": "literature"} for row in results.csv("inputs.csv")]
    results.csv = lambda name: unused if name == "inputs.csv" else Results.csv(results, name)
    gates = gates_of(results)
    (gate,) = [gate for gate in gates if gate.stage == "hardness"]
    assert not gate.passed
    assert not gate.used
    assert trust(gates)[0] == "pass"


def test_a_stated_input_stands_beside_the_computed_one_with_its_effect(made_up):
    root, paths = made_up
    results = Results(
        root,
        [path for path in paths if path.name in ("inputs.csv", "e_star.json", "fit.json")],
        "x",
    )
    results.paths |= {"answer/pad_switch.json"}
    rows = [
        {**row, "origin": "literature"}
        for row in results.csv("inputs.csv")
        if row["parameter"] == "e_star"
    ]
    stated = from_rows(rows).rows[0].distribution
    shifted = {"distribution": "normal", "a": float(stated.quantile(0.5)) + 10, "b": 2.0}
    deviation = float(np.diff(stated.quantile([0.16, 0.84]))[0]) / 2
    answer = {
        "sensitivity": [{"name": "e_star", "share_of_variance": 0.25}],
        "release_V": {"std": 0.6},
    }
    files = {
        "elastic/e_star.json": {"inputs": {"e_star": shifted}},
        "answer/pad_switch.json": {"answer": answer},
    }
    results.csv = lambda _: rows
    results.json = lambda name: files.get(name, {})
    ((_, _, computed, effect),) = stated_beside_computed(results)
    assert computed.startswith(show(shifted["a"]))
    assert effect == f"by about {show(10 / deviation * 0.5 * 0.6)} V"
    rows[0]["origin"] = "elastic"
    assert list(stated_beside_computed(results)) == []


def test_the_pad_says_what_its_answer_is_made_of(made_up):
    root, paths = made_up
    results = Results(
        root, [path for path in paths if path.parent.name in ("pad", "answer")], "made_up"
    )
    spread = {"std": 0.5, "quantiles": {"0.05": 6.0, "0.5": 7.0, "0.95": 8.0}}
    answer = {
        **dict.fromkeys(("release_V", "pull_in_V", "capacitance_fF"), spread),
        "quantile_error_V": {"0.05": 0.3, "0.5": 0.1, "0.95": 0.2},
        "causes": {"cells": 0.3},
        "sensitivity": [
            {
                "name": "rms",
                "varies": "common",
                "share_of_variance": 0.7,
                "interval_shrinks_by": 0.4,
            }
        ],
        **{
            "points": 64,
            "refused": ["too soft"],
            "deepened": 0,
            "cells_error_V": 0.3,
            "explained": 0.9,
        },
    }
    results.json = lambda name: (
        Results.json(results, name) | ({"answer": answer} if "pad_switch" in name else {})
    )
    (behind,) = [
        block
        for block in pad.describe(results).blocks
        if "Behind the interval" in getattr(block, "caption", "")
    ]
    assert ("switches computed; of them without an answer", "65; 1") in behind.rows


def test_the_page_shows_the_release_by_key_and_why_a_curve_ends(page):
    section = page[page.index('id="answer"><summary>') :]
    section = section[: section.index("</details>")]
    section = section.replace("\u00a0", " ")
    for label in (
        "thickness (µm)",
        "length (µm)",
        "gap (µm)",
        "stress (MPa)",
        "dielectric (nm)",
        "hold voltage (V)",
    ):
        assert f'<th scope="row">{label}</th>' in section
    assert "never closes this switch" in section
    assert page.index("if one property of the device were another") < page.index(
        'id="answer"><summary>'
    )


def test_only_scene_paper_compares_with_the_paper(page_of, page):
    own = page_of("own")
    said = own[own.index("<body>") : own.index('id="provenance"')]
    assert not re.search(r"the paper|Table [123]|>paper<|> paper", said)
    assert len(re.findall(r"the paper|Table [123]", page)) > 20


def test_same_results_give_the_same_page(made_up, page):
    root, paths = made_up
    assert render(Results(root, paths, "paper")) == page


def test_synthetic_scans_and_unused_stages_are_named(page):
    assert '<span class="badge synthetic">' in page
    assert "they are no measurement" in page


def test_studies_recommend_the_cheapest_good_setting(made_up):
    root, paths = made_up
    (table,) = tables_of("contact", Results(root, paths, "made_up").csv("accuracy/contact.csv"))
    # the larger of both outputs' errors, 300/steps^2 %: 20 steps come below 1 %
    assert recommended(table) == "20: C_r 0.75 ± 0.07% in 0.20 s"


def made_up_knob(errors, own=0.01, unit="V", volts=np.nan):
    """A knob with one quantity, finer and twice as long with each value; the first is in use."""
    values = [
        Value(
            str(k), k == 0, 2.0**k, {"release": Error("release", error, own, unit, volts * error)}
        )
        for k, error in enumerate(errors)
    ]
    return KnobTable("pad", "steps", "finer", values)


def test_no_value_is_recommended_by_errors_that_do_not_fall():
    """The steps, depths and sites that a table of scene reduced once recommended."""
    for errors in ((0.055, 0.074, 0.138), (0.33, 1.10, 0.009), (0.16, 0.30)):
        assert recommended(made_up_knob(errors)) == "none: errors do not fall towards the reference"


def test_values_whose_errors_hide_their_difference_are_called_so():
    assert recommended(made_up_knob((0.3, 0.25, 0.28), own=0.1)) == "values cannot be told apart"


def test_an_error_small_beside_the_release_needs_no_more_time():
    knob = made_up_knob((0.09, 0.01), volts=1.0)
    assert recommended(knob, deviation_V=1.0).startswith("0: release 0.090")
    assert recommended(knob, deviation_V=0.5).startswith("1: release 0.010")


def test_the_front_of_error_and_time_holds_what_nothing_beats():
    assert pareto_front([(1, 3), (2, 4), (3, 1), (3, 2), (5, 1)]) == [(1, 3), (3, 1)]


def test_every_stage_has_a_line_on_its_numerical_error(page):
    table = page[page.index("Numerical errors; ") :]
    table = table[: table.index("</table>")]
    assert (
        "elastic, topography, uncertainty, pad, circuit, failure</th><td>not measured in this scene"
        in table
    )
    assert "asperity run paper accuracy measures all" in table
    assert "sites a side, 128</td><td>release 0.040 V</td><td>0.040 V</td>" in table


def test_numbers_that_rest_on_failed_gates_say_so(page):
    """The made-up scene takes H′ from a hardness stage that failed."""
    assert (
        "Rests on failed gates: hardness. hardness: only 2 of 9 runs &lt;gave&gt; a hardness."
        in page
    )
    # the first screen and the parts behind it
    assert page.count("Rests on failed gates: hardness.") == 4
    assert "hardness, whose gate failed" in page


def test_stability_tells_what_did_not_pass(page):
    assert "1 of 2 cases passed" in page
    assert "Not passed: contact: spikes." in page


def test_history_says_its_answer(page):
    assert "The last cycle loses 1.6\u202f% of the energy that the first one lost" in page


def test_figures_follow_the_page_colours():
    svg = draw("one", "a line", lambda axis: axis.plot([0, 1], [0, 1], color="#020301"))
    assert "var(--series-1)" in svg
    assert not re.search(r"#0[12]0[123]0[1-6]", svg)
    assert "url(#" not in svg or "url(#one-" in svg


def test_pictures_are_light_and_lose_nothing():
    heights = np.random.default_rng(0).normal(size=(40, 60))

    def plot(axis):
        axis.imshow(heights, cmap="cividis", interpolation="none")
        axis.plot(np.linspace(0, 59, 200), np.linspace(0, 39, 200) ** 0.9)

    svg = draw("map", "a map", plot)
    (encoded,) = re.findall(r"data:image/png;base64,([^\"]+)", svg)
    picture = Image.open(io.BytesIO(base64.b64decode(encoded)))
    assert picture.mode == "P"
    shades = np.asarray(picture.convert("RGBA"))[:, :, :3].astype(int)
    scaled = (heights - heights.min()) / np.ptp(heights)
    expected = matplotlib.colormaps["cividis"](scaled, bytes=True)[:, :, :3].astype(int)
    # of 255; rounding
    assert any(np.abs(shades - turned).max() <= 2 for turned in (expected, expected[::-1]))
    assert max(len(part) for part in re.findall(r'\bd="[^"]*?\.(\d+)', svg)) <= 2


def test_numbers_read_well():
    assert show(31.8) == "31.8"
    assert show(-3.32) == "−3.32"
    assert show(0.000151) == "1.51·10⁻⁴"
    assert show("") == "–"
    assert show(0) == "0"


PROBE = Path(__file__).with_name("probe.js").read_text()


def test_figures_fit_a_phone_and_can_be_read_there(page, tmp_path):
    found, _ = probed(page, tmp_path, 390, PROBE)
    assert found["width"] == 390
    assert found["sticks_out"] == 0
    assert found["overflow"] <= 0, "the page scrolls sideways"
    assert found["smallest_text"] >= 8  # pixels


def test_page_lives_in_a_real_browser(page, tmp_path):
    found, said = probed(page, tmp_path, 1280, PROBE)
    assert found["errors"] == []
    assert "CONSOLE" not in said, re.findall(r".*CONSOLE.*", said)
    assert found["empty"] == 0
    assert found["overflow"] <= 0, "the page scrolls sideways"


def test_calibration_shows_inputs_and_predictions_and_what_contradicts(page):
    section = page[page.index('id="calibration"><summary') :]
    section = section[: section.index("</details>")]
    assert section.count("5.00 [4.50, 5.50]") > 7
    assert "made up, no measurement" in section
    assert "closing separation at 140 nN (nm)" in section
    assert "release (V)" in section
    assert "hardness (hardness.csv) contradicts what the other measurements" in page
    assert "3 points of curves lie outside" in section


def test_a_chain_that_has_not_converged_shows_no_posterior(made_up, tmp_path):
    root = tmp_path / "results"
    shutil.copytree(made_up[0] / "calibration", root / "calibration")
    path = root / "calibration/posterior.json"
    content = json.loads(path.read_text())
    failed = {"passed": False, "reasons": ["the chain has not converged: R-hat 1.2, above 1.01"]}
    path.write_text(json.dumps(content | {"gate": failed, "checksum": None}))
    page = render(Results(root, sorted(root.rglob("*.*")), "made_up"))
    assert "R-hat 1.2, above 1.01" in page
    assert "there is no posterior" in page
    assert "Inputs before and after" not in page


def test_an_input_that_is_fixed_says_so():
    assert _distribution({"distribution": "fixed", "a": "0", "b": ""}) == "fixed at 0"


def test_an_input_given_by_samples_shows_their_quantiles():
    row = {"distribution": f"samples {json.dumps([k / 100 for k in range(101)])}", "a": "", "b": ""}
    assert _distribution(row) == "samples, median 0.500, 5 to 95 %: 0.0500 to 0.950"


def test_the_page_says_from_which_humidity_on_the_switch_sticks():
    rows = [
        {"humidity": str(humidity), "opening": opening, "release_V": str(release)}
        for opening, releases in (("balance", (5.0, 4.0, 0.0)), ("volume", (5.0, 4.0, 3.0)))
        for humidity, release in zip((0.0, 0.3, 0.5), releases, strict=True)
    ]
    said = begins_to_stick(rows)
    assert said.startswith(
        "At central inputs the switch sticks from between 30.0% and 50.0% humidity on (menisci"
    )
    assert said.endswith("lets go at each humidity from 0% to 50% (their volume stays).")
    one = [{"humidity": "0.4", "opening": opening, "release_V": "0.0"} for opening in OPENINGS]
    assert begins_to_stick(one) == "At central inputs the switch sticks at 40% humidity."
    assert "<svg" in against_humidity([{**row, "stuck": ""} for row in rows])


def test_a_switch_that_sticks_in_any_air_has_no_empty_axes(tmp_path):
    row = dict.fromkeys(("reach_nm", "energy_mJ_m2", "pull_off_kPa"), 1.0)
    row |= {"opening": "balance", "release_V": 0.0, "points": 3}
    rows = [{**row, "humidity": 0.1, "stuck": 1.0}, {**row, "humidity": 0.9, "stuck": 1.0}]
    for released, drawn in ((0.0, 0), (2.0, 1)):
        rows[0]["release_V"] = released
        write_csv(tmp_path / "humidity/humidity.csv", rows)
        results = Results(tmp_path, [tmp_path / "humidity/humidity.csv"], "any")
        shown = describe_humidity(results)
        assert shown is not None
        assert sum(isinstance(block, Figure) for block in shown.blocks) == drawn


def test_the_first_map_of_measured_scans_is_in_view_and_no_made_up_one():
    scans = {"scans/02_line": {"line": np.zeros(8)}, "scans/03_film": {"heights": np.eye(8)}}
    attributes = {name: {"length_x_nm": 2000.0, "rms_nm": 3.96} for name in scans}
    parameters: dict[str, Any] = {}
    results = SimpleNamespace(
        has=lambda *names: True,
        json=lambda name: parameters,
        h5=lambda name: (scans, {}, attributes),
    )
    picture, words = first_map(results)
    assert words == "Your surface: 03_film, RMS 3.96 nm; 1 more below."
    assert "data:image/png" in picture
    parameters["synthetic"] = True
    assert first_map(results) is None
