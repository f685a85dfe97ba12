"""The exported law run by the tools it is meant for."""

import numpy as np
import pytest

from mesoscale.device.contact_law import pressure_GPa, slope_GPa_nm
from mesoscale.device.export import law_table, spice_subcircuit, spice_testbench, verilog_module
from mesoscale.law.compact import Law
from mesoscale.law.parameters import BRANCHES, PARAMETERS
from tests.mesoscale.device.simulators import by_ngspice, needs_ngspice, needs_openvaf

AREA = 1e6
NOMINAL = {
    "closing": Law(31.8, 15.1e-5, 6.4e-4, 3.31, hamaker=0.215),
    "opening": Law(28.48, 20.6e-5, 9.16e-4, 2.669, hamaker=0.215),
}


def test_table_holds_both_branches_with_their_kinks_and_ordered_quantiles():
    rng = np.random.default_rng(1)
    samples = {
        branch: Law(law.d_c_nm + rng.normal(0, 3, 200), law.C_a_GPa_nm, law.C_r_GPa, law.rho_r_nm, hamaker=0.2)
        for branch, law in NOMINAL.items()
    }
    rows = list(law_table(NOMINAL, samples))
    for branch in BRANCHES:
        of_branch = [row for row in rows if row["branch"] == branch]
        gaps = np.array([row["gap_nm"] for row in of_branch])
        law = NOMINAL[branch]
        assert np.all(np.diff(gaps) > 0)
        assert law.d_c_nm in gaps
        assert law.d_c_nm + law.rho_a_nm in gaps
        assert [row["pressure_GPa"] for row in of_branch] == pressure_GPa(gaps, law).tolist()
        assert all(row["pressure_q05_GPa"] <= row["pressure_q50_GPa"] <= row["pressure_q95_GPa"] for row in of_branch)


@needs_ngspice
def test_ngspice_reproduces_the_law(tmp_path):
    (tmp_path / "law.sub").write_text(spice_subcircuit(NOMINAL, AREA))
    deck = spice_testbench("law.sub", "out.txt", np.arange(0.0, 120.0, 0.25))
    separation, *forces = by_ngspice(tmp_path, deck)
    assert separation.size >= 480
    for branch, force in zip(BRANCHES, forces, strict=True):
        np.testing.assert_allclose(force, AREA * pressure_GPa(separation, NOMINAL[branch]), rtol=1e-6)


@needs_ngspice
def test_spice_instance_parameters_replace_the_defaults(tmp_path):
    (tmp_path / "law.sub").write_text(spice_subcircuit(NOMINAL, AREA))
    other = Law(20.0, 3e-4, 1e-4, 2.0, hamaker=0.25)
    settings = " ".join(f"{name}_closing={getattr(other, name):.12g}" for name in PARAMETERS)
    deck = spice_testbench("law.sub", "out.txt", np.arange(0.0, 60.0, 0.5)).replace(
        "params: opening=0", f"params: opening=0 {settings} hamaker=0.25 area=2e6 landed=0.5 adhesion=1"
    )
    separation, closing, _ = by_ngspice(tmp_path, deck)
    np.testing.assert_allclose(closing, AREA * pressure_GPa(separation, other), rtol=1e-6)


@needs_openvaf
def test_openvaf_compiles_the_module_and_gives_force_and_stiffness(tmp_path):
    import openvaf_py

    path = tmp_path / "asperity_contact.va"
    path.write_text(verilog_module(NOMINAL, AREA))
    (module,) = openvaf_py.compile_va(str(path))
    for opening, branch in enumerate(BRANCHES):
        law = NOMINAL[branch]
        for separation in (0.5, 12.0, 29.3, 33.1, 80.0):
            values = {f"{name}_{each}": float(getattr(NOMINAL[each], name)) for each in BRANCHES for name in PARAMETERS}
            values |= {"hamaker": 0.215, "rho_a_nm": 2.0, "shield_nm": 2.0, "mfactor": 1.0}
            values |= {"area_nm2": AREA, "landed": 1.0, "adhesion": 1.0, "opening": float(opening)}
            residuals, jacobian = module.run_init_eval({**values, "V(s,ref)": separation * 1e-9})
            force = -residuals[0][0]  # the module's contribution is what holds s against the contact
            assert force == pytest.approx(AREA * float(pressure_GPa(separation, law)) * 1e-9, rel=1e-9)
            stiffness = -jacobian[0][2]  # N/m
            assert stiffness == pytest.approx(AREA * float(slope_GPa_nm(separation, law)), rel=1e-9)


def test_verilog_names_every_parameter():
    text = verilog_module(NOMINAL, AREA)
    for branch in BRANCHES:
        for name in PARAMETERS:
            assert f"parameter real {name}_{branch} = {getattr(NOMINAL[branch], name):.12g}" in text
