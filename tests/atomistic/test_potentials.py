import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from asperity.guards.errors import InputError
from atomistic.constants import COULOMB_EV_A
from atomistic.potentials import TABLE_START_A, load_potential

POTENTIALS = Path(__file__).parents[2] / "config" / "potentials"
PMMCS = POTENTIALS / "pmmcs.yaml"


@pytest.mark.parametrize("path", sorted(POTENTIALS.glob("*.yaml")), ids=lambda path: path.stem)
def test_force_is_minus_the_slope_of_the_energy_and_both_vanish_at_the_cutoff(path):
    potential = load_potential(path)
    r = np.linspace(1.2, potential.cutoff_A - 0.01, 300)
    step = 1e-5
    for first in potential.species:
        for second in potential.species:
            energy_after, _ = potential.energy_and_force(first, second, r + step)
            energy_before, _ = potential.energy_and_force(first, second, r - step)
            _, force = potential.energy_and_force(first, second, r)
            slope = (energy_after - energy_before) / (2 * step)
            np.testing.assert_allclose(force, -slope, rtol=1e-6, atol=1e-6)
            near_cutoff = np.array([potential.cutoff_A - 1e-6])
            np.testing.assert_allclose(
                potential.energy_and_force(first, second, near_cutoff), 0, atol=1e-5
            )


def test_morse_term_as_published():
    """At r0 the Si-O Morse term is -D; what is left is the damped Coulomb sum and C / r^12."""
    potential = load_potential(PMMCS)
    close, far = np.array([2.1]), np.array([2.4])
    silicon_oxygen, _ = potential.energy_and_force("Si", "O", close)
    # screened below the bare sum
    assert -COULOMB_EV_A * 2.88 / 2.1 - 0.340554 < silicon_oxygen[0] < -5
    assert potential.energy_and_force("Si", "O", far)[0][0] > silicon_oxygen[0]


def test_halved_energies_are_half_the_table():
    potential = load_potential(PMMCS)

    def numbers(scale):
        lines = [line.split() for line in potential.table(("Si", "O"), scale).splitlines()]
        return np.array(
            [line[1:] for line in lines if len(line) == 4 and line[0].isdigit()], dtype=float
        )

    full, halved = numbers(1.0), numbers(0.5)
    assert full[0, 0] == TABLE_START_A
    np.testing.assert_array_equal(full[:, 0], halved[:, 0])
    np.testing.assert_allclose(halved[:, 1:], 0.5 * full[:, 1:], rtol=1e-11)


def changed(tmp_path, change):
    content = yaml.safe_load(PMMCS.read_text())
    change(content)
    path = tmp_path / "mine.yaml"
    path.write_text(json.dumps(content))  # YAML without aliases
    return path


def drop_pair(content):
    content["pairs"] = [pair for pair in content["pairs"] if pair["species"] != ["Ti", "O"]]


def charge_silicon(content):
    content["species"]["Si"]["charge_e"] = 2.0


def soften_core(content):
    content["pairs"][0]["terms"] = [
        {
            "term": "buckingham",
            "A_eV": 100.0,
            "rho_A": 0.2,
            "C_eV_A6": 50.0,
            "source": "asperity",
            "confidence": "low",
        }
    ]


def misname_source(content):
    content["coulomb"]["source"] = "nobody"


def name_a_command(content):
    content["species"]["Ti\nshell touch pwned"] = content["species"]["Ti"]


def name_a_formula(content):
    content["species"]["$(1+1)"] = content["species"]["Ti"]


def misspell_key(content):
    content["cutof_A"] = 5


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (drop_pair, ["pair O-Ti is missing"]),
        (charge_silicon, ["SiO2", "charge -0.4 e", "neutral"]),
        (soften_core, ["Si-O attracts", "repulsive core"]),
        (misname_source, ["nobody", "sources"]),
        (misspell_key, ["cutof_A"]),
        (name_a_command, ["species", "touch pwned", "should match pattern"]),
        (name_a_formula, ["species", "$(1+1)", "should match pattern"]),
    ],
)
def test_a_bad_file_gets_one_line_that_names_it(tmp_path, change, words):
    path = changed(tmp_path, change)
    with pytest.raises(InputError) as error:
        load_potential(path)
    message = str(error.value)
    assert "\n" not in message
    assert all(word in message for word in [str(path), *words]), message


@pytest.mark.parametrize(
    "content",
    [
        "",
        "[1, 2",
        "!!python/object/apply:os.system ['true']",
        "a: &a [x]\nb: [*a, *a]",
        'cutoff_A: !!int ""',
    ],
)
def test_unreadable_files(tmp_path, content):
    path = tmp_path / "mine.yaml"
    path.write_text(content)
    with pytest.raises(InputError, match=r"mine\.yaml"):
        load_potential(path)
    with pytest.raises(InputError, match="cannot be read"):
        load_potential(tmp_path / "none.yaml")
