"""Words of the command line that say how a film, its material and its device are."""

import re
from argparse import Namespace
from fnmatch import fnmatch

import pytest
import yaml

from asperity.door import described, scene_lines, topography_of
from asperity.words import (
    SCALAR_KEYS,
    assumed_lines,
    beam_is_plated,
    bodies,
    device_of,
    material_of,
)
from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings
from mesoscale.settings.definitions import BY_NAME
from mesoscale.settings.device import MEASURABLE, PLATED_NICKEL


@pytest.mark.parametrize(
    ("words", "read"),
    [(["e_star=75", "e_star=80"], material_of), (["gap_um=2", "gap_um=3"], device_of)],
)
def test_a_number_that_is_given_twice_is_refused(words, read):
    with pytest.raises(InputError, match="is given twice; leave one of them out"):
        read(words)


def test_words_of_an_engineer_are_keys_of_the_device():
    words = ["ends=cantilever", "electrode=0.2:0.8", "gap_um=1.5\u00b5m", "material=aluminium"]
    stated = device_of([*words, "poisson_ratio=0.33", "hold_voltage_V=35V"])
    assert stated == {
        "ends": "cantilever",
        "electrode": (0.2, 0.8),
        "gap_um": 1.5,
        "youngs_modulus_GPa": 70.3,
        "poisson_ratio": 0.33,  # stated beside the material
        "density_g_cm3": 2.7,
        "excess_expansion_ppm_C": 20.5,
        "hold_voltage_V": 35.0,
    }


@pytest.mark.parametrize(
    ("word", "line"),
    [
        ("ends=cantilevr", "accepted are clamped, cantilever; did you mean cantilever"),
        ("electrode=0.2", "two shares of the length: electrode=0.2:0.8"),
        ("electrode=0.8:0.2", "two rising shares of the length"),
        ("material=unobtainium", "no material 'unobtainium' is known; known are aluminium"),
        ("gap_um=1,5", "a decimal comma; write gap_um=1.5"),
        ("gap_um=1500nm", "gap_um is in um, not in nm"),
        ("gap_um=5%", "gap_um is in um, not in %"),
        ("gap_um=two", "'two' is no number; write for instance gap_um=2.5"),
        ("gap_um=", "'' is no number"),
        ("gap_u=2", "gap_u is no key of the device; did you mean gap_um?"),
        ("hold_voltage_V=-5", "device: hold_voltage_V = -5.0: "),
        ("hold=35V", "hold is no key of the device; did you mean hold_voltage_V?"),
        ("stress=40MPa", "stress is no key of the device; did you mean residual_stress_MPa?"),
        ("pull_in=72", "did you mean pull_in_V?"),
        ("E=70", "did you mean youngs_modulus_GPa?"),
        ("e_star=75", "the contact's, not the device's; write --material e_star=75"),
        ("gap_um=-1", "device: gap_um = -1.0: accepted is above 0.01 um"),
        ("gap_um=3:1", "accepted is one number, such as gap_um=3; departures from it"),
        ("electrode=1:", "two shares of the length: electrode=0.2:0.8"),
        ("release_at=2", "device: release_at = 2.0: accepted is 'jump' or below 1"),
        ("release_at=half", "accepted are jump, a number such as release_at=0.5"),
        ("colour=2", "accepted is KEY=VALUE, with a key of material, ends"),
        ("pull_in_V=72", "value and standard error, pull_in_V=72+-2"),
        ("pull_in_V=72+-2%", "pull_in_V is in V, not in %"),
        ("resonance_kHz=52+-1", "needs the density of the beam"),
        ("humidity=40%", "the air's, not the device's; write --material humidity=40%"),
    ],
)
def test_a_word_that_is_not_understood_is_told_with_what_is_wrong_in_it(word, line):
    with pytest.raises(InputError, match=re.escape(line)):
        device_of([word])


@pytest.mark.parametrize(
    ("word", "values"),
    [
        ("humidity=40%", (0.4,)),
        ("humidity=10%:60%", (0.1, 0.6)),
        ("e_star=75GPa", (75.0,)),
        ("e_star=75+-4", (75.0, 4.0)),
        # 1 / [(1 - 0.44^2) / 78 + (1 - 0.17^2) / 73.1]
        ("e_star=gold/SiO2", (42.332,)),
    ],
)
def test_words_of_a_material_are_rows_of_inputs(word, values):
    (row,) = material_of([word]).values()
    assert row.values == values


@pytest.mark.parametrize(
    "word",
    ["e_star=gold", "e_star=", "e_star=1,5", "hamaker=0.2J", "humidity=140%", "e_star=-5+-1"],
)
def test_a_material_that_is_not_understood_is_one_line(word):
    with pytest.raises(InputError, match=re.escape(f"{word}: ")):
        material_of([word])


@pytest.mark.parametrize(
    ("word", "line"),
    [
        ("h_macro=3:1", "its first number is the larger; write h_macro=1:3"),
        ("e_star=75+--4", "a deviation of -4; accepted is 0 or more"),
        ("e_star=70:75:80", "accepted are e_star=75, e_star=70:80 (from, to)"),
        ("hardness=2", "hardness is no input; did you mean h_macro?"),
        ("e_stra=75", "no such input of the contact model; did you mean e_star?"),
        ("gap_um=2", "the device's, not the contact's; write --device gap_um=2"),
        ("gold", "accepted is NAME=VALUE, such as e_star=75"),
    ],
)
def test_a_wrong_word_of_a_material_is_told_with_what_is_wrong_in_it(word, line):
    with pytest.raises(InputError, match=re.escape(line)):
        material_of([word])


ODD_VALUES = ("0", "-1", "3:1", "1:2:3", "1,5", "5%", "5xx", "nan", "1e400", "5+--1", "+-", ":", "")
WORDS_OF_LIBRARIES = re.compile(
    "Input should|Value error|validation|Traceback|constrained|literal\\["
)


@pytest.mark.parametrize("value", ODD_VALUES)
def test_an_odd_value_of_any_key_is_a_line_of_ours(value):
    """Of every key of device and material: taken, or one line with key and what is accepted."""
    stated = [(device_of, name) for name in (*SCALAR_KEYS, *MEASURABLE)]
    stated += [(material_of, name) for name in BY_NAME]
    for read, name in stated:
        try:
            read([f"{name}={value}"])
        except InputError as error:
            line = str(error)
            assert name in line
            assert "\n" not in line
            assert not WORDS_OF_LIBRARIES.search(line), line


def test_a_beam_of_a_material_leaves_the_contact_as_it_is_and_says_so():
    device = device_of(["material=aluminium"])
    *_, line, _ = assumed_lines({}, device, "aluminium")
    assert "--material e_star=aluminium/silicon_nitride" in line
    stated = material_of(["e_star=aluminium/silicon_nitride"])
    assert not any("aluminium" in line for line in assumed_lines(stated, device, "aluminium"))


def files_with(**words):
    """Options of files as the command line has them."""
    names = ("channel", "unit", "size", "crop", "points", "detrend", "tip_nm")
    return Namespace(**dict.fromkeys(names) | words)


@pytest.mark.parametrize("tip", ["-1", "3:1", "5%", "1,5", ""])
def test_a_wrong_radius_of_the_tip_is_one_line_of_ours(tip):
    given = files_with(files=["a.txt"], tip_nm=tip, material=[], device=[])
    with pytest.raises(InputError, match=f"^--tip-nm={re.escape(tip)}: "):
        described(given, print)


def test_several_files_have_sizes_and_units_of_their_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("a.txt", "b[1].txt", "c.txt"):
        (tmp_path / name).write_text("")
    given = files_with(
        files=["a.txt", "b[1].txt", "c.txt"],
        size=["10", "b[1].txt=5x2.5"],
        unit=["um,nm", "c.txt=nm"],
    )
    instruments = topography_of(given)["instruments"]
    first = {
        name: next(item for item in instruments if fnmatch(name, item.files))
        for name in given.files
    }
    assert [first[name].size for name in given.files] == [(10.0,), (5.0, 2.5), (10.0,)]
    units = [(first[name].unit, first[name].height_unit) for name in given.files]
    assert units == [("um", "nm"), ("um", "nm"), ("nm", "nm")]


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ({"size": ["0"]}, "--size 0: a side is above 0"),
        ({"size": ["-1x2"]}, "--size -1x2: a side is above 0"),
        ({"size": ["1,5"]}, "--size 1,5: accepted is a number or two"),
        ({"size": ["10um"]}, "--size 10um: accepted is a number or two"),
        ({"size": ["b.txt=10"]}, "--size b.txt=10: no such file is given; did you mean a.txt?"),
        ({"size": ["a.txt="]}, "--size a.txt=: accepted is a number or two"),
        ({"unit": ["a.txt=inch"]}, "--unit a.txt=inch: accepted are m, mm"),
        ({"points": "0x0"}, "--points 0x0: accepted are two numbers such as 64x64"),
        ({"crop": "5:2,0:10"}, "--crop 5:2,0:10: each range rises"),
    ],
)
def test_a_wrong_option_of_files_is_one_line_of_ours(tmp_path, monkeypatch, words, line):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.txt").write_text("")
    with pytest.raises(InputError, match=f"^{re.escape(line)}"):
        topography_of(files_with(files=["a.txt"], **words))


def test_bodies_have_a_source_and_are_beams():
    for body in bodies().values():
        assert re.search(r"\((16th ed., )?(19|20)\d\d\)", body.source)
        DeviceSettings(**body.of_a_beam)


def test_a_beam_of_nickel_is_plated_and_its_contact_is_bulk():
    plated = DeviceSettings(**device_of(["material=nickel"]))
    assert plated.youngs_modulus_GPa == DeviceSettings().youngs_modulus_GPa
    assert plated.spread.youngs_modulus_GPa == PLATED_NICKEL
    assert beam_is_plated(["material=Ni", "gap_um=2"])
    stated = ["material=nickel", "youngs_modulus_GPa=199.5"]
    assert DeviceSettings(**device_of(stated)).youngs_modulus_GPa == 199.5
    assert not beam_is_plated(stated)
    assert not beam_is_plated(["material=gold"])
    assert bodies()["nickel"].young_GPa == 199.5


@pytest.mark.parametrize(
    "words",
    [
        ["ends=cantilever", "electrode=0.2:0.8", "material=gold"],
        ["gap_um=3", "release_at=0.5"],
        ["release_at=jump"],
    ],
)
def test_a_scene_of_words_is_the_device_that_they_state(tmp_path, words):
    """Also where the modulus is not stated, which then stays as unknown as it is."""
    stated = device_of(words)
    path = tmp_path / "words.yaml"
    path.write_text("\n".join(scene_lines(None, material_of(["e_star=Au/SiN"]), stated)))
    device = yaml.safe_load(path.read_text())["device"]
    assert DeviceSettings(**device) == DeviceSettings(**stated)


def test_what_was_measured_of_a_device_goes_into_its_scene(tmp_path):
    stated = device_of(["material=gold", "pull_in_V=72+-2V", "resonance_kHz=50±1"])
    path = tmp_path / "words.yaml"
    path.write_text("\n".join(scene_lines(None, material_of(["e_star=Au/SiN"]), stated)))
    device = DeviceSettings(**yaml.safe_load(path.read_text())["device"])
    assert device.measured.stated == {"pull_in_V": (72.0, 2.0), "resonance_kHz": (50.0, 1.0)}


def test_what_nobody_stated_is_told_with_its_source():
    material, device = assumed_lines(material_of(["e_star=75"]), device_of(["gap_um=2"]))
    assert "h_macro" in material
    assert "e_star" not in material
    assert "six glasses" in material
    assert "gap_um" not in device
    assert "length_um 510" in device


@pytest.mark.parametrize("unit", ["um", "\u00b5m", "\u03bcm"])
def test_micrometres_have_either_micro_sign(unit):
    given = Namespace(
        channel=None,
        unit=[f"{unit},nm"],
        size=None,
        crop=None,
        points=None,
        detrend=None,
        tip_nm=None,
    )
    (instrument,) = topography_of(given)["instruments"]
    assert (instrument.unit, instrument.height_unit) == ("um", "nm")
