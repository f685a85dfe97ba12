"""Material files: the shipped ones are sound, and a bad one is refused in one line."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from asperity.guards.errors import InputError
from atomistic.materials import load_material, load_materials, oxide_glasses
from atomistic.settings import ElasticSettings, HardnessSettings

FOLDER = Path(__file__).parents[2] / "config" / "materials"
ATOMIC_MASS_U = {"Si": 28.085, "Ti": 47.867, "O": 15.999}
AVOGADRO = 6.02214076e23


def test_the_defaults_of_the_settings_are_among_the_shipped_materials():
    materials = load_materials(FOLDER)
    oxides = oxide_glasses(materials.values())
    hardness, elastic = HardnessSettings(), ElasticSettings()
    assert hardness.material in oxides
    assert materials[elastic.counter_body].polycrystal is not None
    assert materials[elastic.material].network_glass is not None


@pytest.mark.parametrize(
    ("name", "quenched_g_cm3"), [("silicon_dioxide", 2.33), ("titanium_dioxide", 3.8)]
)
def test_number_density_of_a_quenched_glass_is_that_of_its_stated_density(name, quenched_g_cm3):
    material = load_material(FOLDER / f"{name}.yaml")
    assert f"{quenched_g_cm3} g/cm3" in material.sources["asperity"]
    unit_u = sum(ATOMIC_MASS_U[element] * count for element, count in material.formula.items())
    per_nm3 = quenched_g_cm3 * 1e-21 * AVOGADRO / unit_u * sum(material.formula.values())
    # both are printed with two or three digits
    assert material.part("oxide_glass").quenched.atoms_per_nm3 == pytest.approx(per_nm3, rel=5e-3)


def test_polycrystalline_titanium_is_the_average_of_its_crystal():
    """Voigt-Reuss-Hill average of a hexagonal crystal (Hill, Proc. Phys. Soc. A 65, 349 (1952))."""
    body = load_material(FOLDER / "titanium.yaml").part("polycrystal")
    # GPa, 298 K: Fisher and Renken, doi:10.1103/PhysRev.135.A482
    C11, C12, C13, C33, C44 = (162.4, 92.0, 69.0, 180.7, 46.7)
    C = np.zeros((6, 6))
    C[:3, :3] = [[C11, C12, C13], [C12, C11, C13], [C13, C13, C33]]
    C[3:, 3:] = np.diag([C44, C44, (C11 - C12) / 2])
    S = np.linalg.inv(C)

    def average(matrix, shear):
        trace, rest = np.trace(matrix[:3, :3]), matrix[0, 1] + matrix[0, 2] + matrix[1, 2]
        return (trace + 2 * rest) / 9, (trace - rest + shear * np.trace(matrix[3:, 3:])) / 15

    bulk_high, shear_high = average(C, 3)
    compressibility, compliance = average(S, 0.75)
    bulk, shear = (
        (bulk_high + 1 / (9 * compressibility)) / 2,
        (shear_high + 1 / (4 * compliance)) / 2,
    )
    assert 9 * bulk * shear / (3 * bulk + shear) == pytest.approx(
        body.young_GPa, abs=body.young_std_GPa
    )
    assert (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)) == pytest.approx(
        body.poisson_ratio, abs=0.01
    )


def changed(tmp_path, name, where, value):
    """A copy of a shipped file with one value changed; None removes the key."""
    content = yaml.safe_load((FOLDER / f"{name}.yaml").read_text(encoding="utf-8"))
    *above, last = where.split("/")
    section = content
    for key in above:
        section = section[key]
    if value is None:
        del section[last]
    else:
        section[last] = value
    path = tmp_path / f"{name}.yaml"
    path.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("name", "where", "value", "words"),
    [
        (
            "silicon_dioxide",
            "oxide_glass/densty",
            2.2,
            ["oxide_glass", "densty", "accepted are density_g_cm3"],
        ),
        ("silicon_dioxide", "oxide_glas", {}, ["oxide_glas'", "accepted are name, formula"]),
        ("silicon_dioxide", "oxide_glass/cutoff_A", None, ["oxide_glass.cutoff_A", "is missing"]),
        (
            "silicon_dioxide",
            "oxide_glass/density_g_cm3",
            -2.2,
            ["density_g_cm3", "above 0", "-2.2"],
        ),
        ("silicon_dioxide", "oxide_glass/density_g_cm3", float("nan"), ["density_g_cm3", "number"]),
        (
            "silicon_dioxide",
            "oxide_glass/density_g_cm3",
            22,
            ["density_g_cm3 = 22", "2.05 to 2.45"],
        ),
        ("silicon_dioxide", "oxide_glass/bond_range_A", [1.7, 1.5], ["bond_range_A", "must rise"]),
        (
            "silicon_dioxide",
            "oxide_glass/cutoff_A",
            1.5,
            ["cutoff_A = 1.5", "longer than bond_A = 1.61"],
        ),
        ("silicon_dioxide", "oxide_glass/cutoff_A", 4, ["cutoff_A", "3 or less"]),
        (
            "silicon_dioxide",
            "oxide_glass/quenched/source",
            "nobody",
            ["nobody", "not listed under `sources`"],
        ),
        ("silicon_dioxide", "formula", {"Si": 1, "N": 2}, ["crystals.stishovite.sites", "Si, N"]),
        ("silicon_dioxide", "formula", {"$(1+1)": 1}, ["formula", "$(1+1)", "match pattern"]),
        ("silicon_dioxide", "name", "quartz", ["name", "'silicon_dioxide'", "'quartz'"]),
        (
            "silicon",
            "crystals/silicon/spacegroup",
            231,
            ["crystals.silicon.spacegroup", "230", "231"],
        ),
        ("silicon", "crystals/silicon/cell", [5.4, 5.4, 5.4, 90, 90, 180], ["cell", "below 180"]),
        (
            "silicon",
            "crystals/silicon/supercell",
            [3, 3, 0],
            ["supercell", "1 or more"],
        ),
        (
            "silicon_nitride",
            "network_glass/density_g_cm3",
            [3.4, 2.6],
            ["density_g_cm3", "must rise"],
        ),
        ("silicon_nitride", "network_glass/masses_u", {"Si": 28}, ["masses_u", "must have Si, N"]),
        (
            "silicon_nitride",
            "network_glass/tersoff/elements/Si/S",
            2.4,
            ["Si", "S = 2.4", "R = 2.5"],
        ),
        (
            "silicon_nitride",
            "network_glass/tersoff/elements/Si/lambda",
            None,
            ["Si.lambda", "is missing"],
        ),
        (
            "titanium",
            "polycrystal/poisson_ratio",
            0.5,
            ["polycrystal.poisson_ratio", "below 0.5"],
        ),
        (
            "titanium",
            "polycrystal/young_GPa",
            "stiff",
            ["polycrystal.young_GPa", "stiff", "number"],
        ),
    ],
)
def test_a_bad_file_gets_one_line_that_names_it(tmp_path, name, where, value, words):
    path = changed(tmp_path, name, where, value)
    with pytest.raises(InputError) as error:
        load_material(path)
    message = str(error.value)
    assert "\n" not in message
    assert all(word in message for word in [str(path), *words]), message


@pytest.mark.parametrize(
    "content", ["", "[1, 2", "!!python/object/apply:os.system ['true']", "name: [\n"]
)
def test_unreadable_files(tmp_path, content):
    path = tmp_path / "mine.yaml"
    path.write_text(content)
    with pytest.raises(InputError, match=r"mine\.yaml"):
        load_material(path)
    with pytest.raises(InputError, match="cannot be read"):
        load_material(tmp_path / "none.yaml")


def test_two_files_of_one_oxide_are_refused(tmp_path):
    changed(tmp_path, "silicon_dioxide", "name", "silicon_dioxide")
    twin = changed(tmp_path, "silicon_dioxide", "name", "twin")
    twin.rename(tmp_path / "twin.yaml")
    changed(tmp_path, "silicon_dioxide", "crystals", {})
    with pytest.raises(
        InputError, match=r"twin\.yaml: oxide glass SiO2 stands in .*silicon_dioxide\.yaml too"
    ):
        load_materials(tmp_path)
