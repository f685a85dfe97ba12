"""Words of the command line that say how a film, its material and its device are."""

import re
from argparse import Namespace

import pytest
import yaml

from asperity.door import scene_lines, topography_of
from asperity.words import assumed_lines, beam_is_plated, bodies, device_of, material_of
from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import PLATED_NICKEL


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
        unit=f"{unit},nm",
        size=None,
        crop=None,
        points=None,
        detrend=None,
        tip_nm=None,
    )
    (instrument,) = topography_of(given)["instruments"]
    assert (instrument.unit, instrument.height_unit) == ("um", "nm")
