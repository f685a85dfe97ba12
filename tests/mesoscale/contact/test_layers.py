"""Bodies of elastic layers: exact compliances, an independent integration, and spheres that feel
one layer or all.
"""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.special import j0

from mesoscale.contact import ContactInputs
from mesoscale.contact.coupled import half_space, layers
from mesoscale.contact.coupled.engine import CoupledContact
from mesoscale.contact.coupled.grid import Grid
from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import Body, MaterialSettings, base_modulus

SILICA, NITRIDE = {"young_GPa": 72.0, "poisson": 0.17}, {"young_GPa": 250.0, "poisson": 0.25}
Q = np.logspace(-4, 2, 61)


def body(*materials: dict) -> Body:
    return tuple(MaterialSettings.model_validate(material) for material in materials)


def rigid() -> MaterialSettings:
    return MaterialSettings.model_construct(young_GPa=1e14, poisson=0.25, thickness_nm=None)


def test_layers_of_the_base_change_nothing():
    same = body({**NITRIDE, "thickness_nm": 2.5}, {**NITRIDE, "thickness_nm": 7.0}, NITRIDE)
    np.testing.assert_allclose(
        layers.compliance(same, Q) * Q / 2 * base_modulus([same]), 1.0, rtol=1e-12
    )


def test_a_film_that_vanishes_or_fills_all_is_a_half_space():
    for thickness, alone in ((1e-6, NITRIDE), (1e6, SILICA)):
        film = body({**SILICA, "thickness_nm": thickness}, NITRIDE)
        expected = layers.compliance(body(alone), Q[20:40])
        np.testing.assert_allclose(layers.compliance(film, Q[20:40]), expected, rtol=1e-5)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
def test_a_layer_bonded_to_a_rigid_base_has_the_closed_form(nu):
    """Two-dimensional layers: Jaffar, Int. J. Mech. Sci. 31 (1989) 229."""
    thickness, young = 3.0, 70.0
    w, k = np.minimum(Q * thickness, 300.0), 3.0 - 4.0 * nu
    shape = (2 * k * np.sinh(2 * w) - 4 * w) / (2 * k * np.cosh(2 * w) + 4 * w**2 + k**2 + 1)
    layered = (*body({"young_GPa": young, "poisson": nu, "thickness_nm": thickness}), rigid())
    expected = 2 * (1 - nu**2) / (young * Q) * shape
    np.testing.assert_allclose(layers.compliance(layered, Q), expected, rtol=1e-6)


@pytest.mark.parametrize("ratio", [1e6, 1e9, 1e12])
def test_a_far_stiffer_layer_is_a_plate(ratio):
    """Bending stiffness D on a half-space whose surface it keeps from stretching; settings accept
    no larger ratio.

    The shear of plate and base is left out, which is a share of about ratio^(-1/3).
    """
    thickness, young, nu, q = 2.0, 1e6, 0.2, np.logspace(-3, -2, 7)
    base = young / ratio
    plate = body(
        {"young_GPa": young, "poisson": nu, "thickness_nm": thickness},
        {"young_GPa": base, "poisson": nu},
    )
    bending, support = (
        young * thickness**3 / (12 * (1 - nu**2)),
        2 * base * (1 - nu) / ((1 + nu) * (3 - 4 * nu)),
    )
    np.testing.assert_allclose(
        layers.compliance(plate, q), 1 / (bending * q**4 + support * q), rtol=5e-3
    )


def integrated(stack: Body, q: float, depth: float) -> float:
    """The displacement by exponentials of the equations of elasticity, held at a depth of the
    base.
    """
    through, top = np.eye(4), 0.0
    for material in stack:
        bottom = depth if material.thickness_nm is None else top + material.thickness_nm
        shear = material.young_GPa / 2 / (1 + material.poisson)
        lame = 2 * shear * material.poisson / (1 - 2 * material.poisson)
        stiff = lame + 2 * shear
        rates = np.array(
            [
                [0, q, 1 / shear, 0],
                [-lame * q / stiff, 0, 0, 1 / stiff],
                [0, 0, 0, 0],
                [0, 0, -q, 0],
            ]
        )
        rates[2] = q * (stiff * q * np.eye(4)[0] + lame * rates[1])
        through, top = expm(rates * (bottom - top)) @ through, bottom
    return float(np.linalg.solve(through[:2, :2], through[:2, 3])[1])


@pytest.mark.parametrize("q", [0.02, 0.1, 0.5])
def test_layers_agree_with_the_equations_of_elasticity(q):
    stack = body(
        {**SILICA, "thickness_nm": 2.5},
        {**NITRIDE, "thickness_nm": 20.0},
        {"young_GPa": 116, "poisson": 0.32},
    )
    assert layers.compliance(stack, np.array([q]))[0] == pytest.approx(
        integrated(stack, q, 14 / q), rel=1e-8
    )


@pytest.mark.parametrize("young", [1e-6, 72.0, 1e6])
def test_the_spline_between_waves_is_exact(young):
    both = (body({"young_GPa": young, "poisson": 0.4, "thickness_nm": 2.5}, NITRIDE), body(SILICA))
    q = np.exp(np.random.default_rng(1).uniform(np.log(0.006), np.log(4.0), 200))
    share = sum(layers.compliance(one, q) for one in both) * q / 2 * base_modulus(both)
    np.testing.assert_allclose(
        layers.softness_spline(both, 0.006, 4.0)(np.log(q)), share, rtol=1e-7
    )


@pytest.mark.parametrize(("thickness", "feels"), [(400.0, SILICA), (0.1, NITRIDE)])
def test_a_sphere_feels_the_film_when_thick_and_the_base_when_thin(thickness, feels):
    contact_radius, pixels = 20.0, 128
    spacing = contact_radius / 8
    x = (np.arange(pixels) - pixels // 2 + 0.37) * spacing
    bowl = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * 1000.0)
    film = body({**SILICA, "thickness_nm": thickness}, NITRIDE)

    def force(stack: Body) -> float:
        inputs = ContactInputs(
            hamaker=0,
            e_star=base_modulus([stack]),
            h_macro=1,
            h_prime=0,
            q0=0.06,
            hurst=0.75,
            rms=1,
        )
        settings = ContactSettings(
            mechanics="coupled",
            model="elastic",
            pixels=pixels,
            length_nm=pixels * spacing,
            bodies=(stack,),
        )
        contact = CoupledContact(bowl.copy(), inputs, settings)
        contact.move_to(-0.4, with_flow=False)
        return contact.force

    assert force(film) == pytest.approx(force(body(feels)), rel=0.02)


def test_a_point_load_on_a_film_is_boussinesqs_and_what_the_film_adds():
    # F / (pi r) (1/E_film - 1/E_base) and a Hankel transform that dies with depth; a film's
    # displacement is local, so that the other cells add only their mean. Weights 1, 2, 1 take off
    # the shortest wave, of which the site is made.
    pixels, length, places = 256, 64.0, np.array([8, 12, 16, 24])
    film, site, q = (
        (body({**SILICA, "thickness_nm": 2.5}, NITRIDE),),
        length / pixels,
        np.linspace(1e-4, 16.0, 20001),
    )
    soft = layers.softness(film, q)
    local = np.trapezoid((soft - soft[-1]) * j0(q * site * places[:, None]), q)
    wanted = ((soft[-1] - 1) / (site * places) + local) / np.pi * site**2
    table = (half_space.influence(pixels, length, film) - half_space.influence(pixels, length, ()))[
        0
    ] * length
    found = sum(share * table[places + shift] for shift, share in ((-1, 0.25), (0, 0.5), (1, 0.25)))
    mean = 2 * (soft[0] - 1) / q[0] * (site / length) ** 2
    np.testing.assert_allclose(found + mean, wanted, rtol=0.04, atol=1e-3 * wanted[0])


def test_the_table_and_the_grid_are_the_same_bodies():
    both = (body({**SILICA, "thickness_nm": 2.5}, NITRIDE),)
    table = half_space.influence(32, 100.0, both)
    pressure = np.zeros(32 * 32)
    pressure[0] = 1.0
    moved = Grid(32, 100.0, 91.0, both).displacement(pressure).reshape(32, 32)
    np.testing.assert_allclose(moved[:17, :17], table * 100.0 / 91.0, rtol=1e-12, atol=1e-15)
    assert table[0, 0] > half_space.influence(32, 100.0, ())[0, 0]


@pytest.mark.parametrize(
    ("bodies", "words"),
    [
        ([[NITRIDE, NITRIDE]], "a base without one"),
        ([[{**NITRIDE, "thickness_nm": 2.0}]], "a base without one"),
        ([[]], "a base without one"),
        ([[{**NITRIDE, "thickness_nm": 0.0}, NITRIDE]], "leave it out"),
        ([[{"young_GPa": 1.0, "poisson": 0.5}]], "accepted is below 0.5"),
        (
            [[{"young_GPa": 1e-7, "poisson": 0.2, "thickness_nm": 2.0}, NITRIDE]],
            "accepted is 1e-06 or more",
        ),
        ([[NITRIDE]] * 3, "accepted is 2 entries or fewer"),
    ],
)
def test_bodies_without_sense_are_refused(bodies, words):
    with pytest.raises(InputError, match=words):
        ContactSettings(mechanics="coupled", bodies=bodies)


def test_single_asperities_have_no_layers():
    with pytest.raises(InputError, match="mechanics: coupled"):
        ContactSettings(mechanics="asperity", bodies=(body(NITRIDE),))
