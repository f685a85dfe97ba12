import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipe

from mesoscale.contact.asperity.engine import AsperityContact
from mesoscale.contact.cycle import run_cycle
from mesoscale.contact.energy import pull_off
from mesoscale.contact.engines import contact_on
from mesoscale.contact.numerics import Numerics
from mesoscale.contact.pressed import Contact
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs, contact_of
from mesoscale.inputs.table import input_table
from mesoscale.settings import ContactSettings, InputsSettings
from mesoscale.settings.inputs import WorkAndRangeSettings
from mesoscale.topography.synthesis import synthesize

INPUTS = ContactInputs(
    hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5
)


LAWS = ("clamped", "offset")


def walls(gap: np.ndarray, law: str, cutoff: float = 0.165) -> np.ndarray:
    """Distance of the walls at gaps."""
    return np.maximum(gap, 0.0) + cutoff if law == "offset" else np.maximum(gap, cutoff)


def test_plates_follow_hamaker():
    """A_H = 0.215e-18 J, gap 10 nm, 1 um^2: 11.41 nN."""
    settings = ContactSettings(
        mechanics="asperity", pixels=32, model="elastic", attraction="clamped"
    )
    contact = AsperityContact(np.zeros((32, 32)), INPUTS, settings)
    assert contact.attraction(10.0) == pytest.approx(-11.4061, rel=1e-5)
    assert contact.attraction(0.05) == contact.attraction(0.1)  # both below the cut-off gap
    offset = AsperityContact(
        np.zeros((32, 32)), INPUTS, settings.model_copy(update={"attraction": "offset"})
    )
    # the walls are 10 nm apart
    assert offset.attraction(10.0 - 0.165) == pytest.approx(-11.4061, rel=1e-5)
    # the same at touch
    assert offset.attraction(1e-12) == pytest.approx(contact.attraction(0.1), rel=1e-9)


def test_gaussian_heights_far_away_follow_the_asymptotic_series():
    """<(d - h)^-3> = d^-3 (1 + 6 s + 45 s^2 + ...), s = (sigma/d)^2; a realisation's skewness
    allowed for.
    """
    heights = synthesize(256, 1000.0, 0.2, 0.75, 1.0, 5)
    settings = ContactSettings(mechanics="asperity", pixels=256, model="elastic")
    contact = AsperityContact(heights, INPUTS, settings)
    separation = 20.0  # of the walls
    s = (1.0 / separation) ** 2
    series = 1 + 6 * s + 45 * s**2 - 10 * np.mean(heights**3) / separation**3
    plates = -0.215e6 / (6 * np.pi * separation**3)
    assert contact.attraction(separation - settings.gap_cutoff_nm) == pytest.approx(
        plates * series, rel=1e-4
    )


@pytest.mark.parametrize("bins", [64, 4096])
@pytest.mark.parametrize("touching", [True, False])
@pytest.mark.parametrize("law", LAWS)
def test_the_histogram_agrees_with_the_sum_over_all_sites(bins, touching, law):
    heights = synthesize(128, 1000.0, 0.05, 0.75, 8.5, 5)
    settings = ContactSettings(
        mechanics="asperity",
        pixels=128,
        model="elastic",
        attraction=law,
        reading={"touching_attracts": touching},
    )
    contact = AsperityContact(heights, INPUTS, settings, Numerics(gap_bins=bins))
    for separation in (60.0, 35.0, 20.0, 0.0):
        gap = heights + separation
        gap = walls(gap if touching else gap[gap >= 0], law)
        exact = -0.215 * (1000 / 128) ** 2 / (6 * np.pi) * np.sum(gap**-3.0)
        # next term of the expansion: (w / 2 g)^5 with g > 100 w, so the number of bins does not
        # matter
        assert contact.attraction(separation) == pytest.approx(exact, rel=1e-11)


MECHANICS = ("asperity", "coupled")


def flats(mechanics: str, **changes) -> Contact:
    settings = ContactSettings(mechanics=mechanics, pixels=32, model="elastic", **changes)
    return contact_on(np.zeros((32, 32)), INPUTS, settings)


def separated(contact: Contact, start: float, end: float = np.inf) -> float:
    """Work per area (nN/nm) that separates flats."""
    return -quad(contact.attraction, start, end, epsrel=1e-10)[0] / contact.length**2


@pytest.mark.parametrize("mechanics", MECHANICS)
@pytest.mark.parametrize("cutoff", [0.165, 0.3, 1.0])
@pytest.mark.parametrize("wavelength", [None, 100.0, 10.0])
@pytest.mark.parametrize("law", LAWS)
def test_flats_lose_the_energy_of_hamaker_and_gregory(mechanics, cutoff, wavelength, law):
    contact = flats(mechanics, gap_cutoff_nm=cutoff, retardation_nm=wavelength, attraction=law)
    start = 1e-12 if law == "offset" else cutoff  # walls one cut-off apart
    hamaker = INPUTS.hamaker / (12 * np.pi * cutoff**2)
    retarded = 1.0 / (1.0 + 5.32 * cutoff / wavelength) if wavelength else 1.0
    assert separated(contact, start) == pytest.approx(hamaker * retarded, rel=1e-8)


def test_a_sphere_by_derjaguin_has_gregorys_energy():
    """-A R / (6 h) [1 - (5.32 h / L) ln(1 + L / (5.32 h))]: 2 pi R times the flats' energy,
    integrated once more.
    """
    contact, wavelength = flats("asperity", retardation_nm=100.0), 100.0
    for h in (1.0, 20.0):
        x = 5.32 * h / wavelength
        gregory = INPUTS.hamaker / (6 * h) * (1 - x * np.log1p(1 / x))
        gap = h - 0.165
        ours = quad(lambda s: 2 * np.pi * separated(contact, s), gap, np.inf, epsrel=1e-7)[0]
        assert ours == pytest.approx(gregory, rel=1e-6)


@pytest.mark.parametrize("mechanics", MECHANICS)
def test_a_long_wavelength_retards_nothing(mechanics):
    usual, retarded = flats(mechanics), flats(mechanics, retardation_nm=1e6)
    assert retarded.attraction(5.0) == pytest.approx(usual.attraction(5.0), rel=1e-4)


@pytest.mark.parametrize("mechanics", MECHANICS)
def test_the_histogram_of_a_retarded_attraction_agrees_with_the_sum(mechanics):
    heights = synthesize(128, 1000.0, 0.05, 0.75, 8.5, 5)
    settings = ContactSettings(
        mechanics=mechanics, pixels=128, model="elastic", retardation_nm=50.0
    )
    contact = contact_on(heights, INPUTS, settings)
    for separation in (60.0, 35.0):  # before contact
        gap = walls(heights + separation, "offset")
        reach = 5.32 * gap / 50.0
        pulls = (1 + 1.5 * reach) / (1 + reach) ** 2 / gap**3
        exact = -0.215 * (1000 / 128) ** 2 / (6 * np.pi) * np.sum(pulls)
        # the expansion as without retardation; coupled mechanics has far sites already from 2 nm
        # on: (w / 4 nm)^5
        assert contact.attraction(separation) == pytest.approx(
            exact, rel=1e-11 if mechanics == "asperity" else 1e-9
        )


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("mechanics", MECHANICS)
def test_work_and_range_give_the_flats_that_work_and_range(mechanics, law):
    wanted = WorkAndRangeSettings(work_mJ_m2=46.3, range_nm=5.6)
    rows = InputsSettings(adhesion=wanted).rows(law)
    values = {
        **vars(INPUTS),
        "hamaker": rows["hamaker"].values[0],
        "gap_cutoff": rows["gap_cutoff"].values[0],
    }
    inputs, settings = contact_of(
        values, ContactSettings(mechanics=mechanics, pixels=32, model="elastic", attraction=law)
    )
    contact = contact_on(np.zeros((32, 32)), inputs, settings)
    touch = 1e-12
    work = separated(contact, touch, settings.gap_cutoff_nm) + separated(
        contact, settings.gap_cutoff_nm
    )
    assert work == pytest.approx(46.3e-3, rel=1e-8)
    assert work / (-contact.attraction(touch) / contact.length**2) == pytest.approx(5.6, rel=1e-8)


def test_two_ways_to_say_the_same_attraction_are_refused():
    given = input_table().rows[0].distribution
    with pytest.raises(InputError, match="adhesion and hamaker"):
        InputsSettings(
            adhesion=WorkAndRangeSettings(work_mJ_m2=50.0, range_nm=0.5),
            hamaker={"values": [given.a, 2.0 * given.b]},
        )


@pytest.mark.parametrize(
    ("law", "cutoff", "share"),
    [("offset", 0.165, 1.05), ("offset", 0.3, 1.0), ("clamped", 0.165, 3.13)],
)
def test_an_elastic_sphere_pulls_off_with_the_work_of_its_flats(law, cutoff, share):
    """Derjaguin, Muller and Toporov: 2 pi w R. `share` is the pull-off over that of the work beyond
    walls D0 apart.

    Clamped spends twice this work again within D0. On a grid a contact of few sites is a few per
    cent off.
    """
    radius, pixels, spacing = 100.0, 128, 0.5
    x = (np.arange(pixels) - pixels // 2) * spacing
    bowl = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)
    settings = ContactSettings(
        mechanics="coupled",
        pixels=pixels,
        length_nm=pixels * spacing,
        model="elastic",
        gap_cutoff_nm=cutoff,
        attraction=law,
    )
    contact = contact_on(bowl, INPUTS, settings)
    pull = 0.0
    for separation in np.linspace(
        contact.touching_separation + 0.5, contact.touching_separation - 0.5, 60
    ):
        force = (
            contact.move_to(separation, False).force
            if separation < contact.touching_separation
            else 0.0
        )
        pull = max(pull, -contact.attraction(separation) - force)
    work = INPUTS.hamaker / (12 * np.pi * cutoff**2)
    assert pull == pytest.approx(share * 2 * np.pi * work * radius, rel=0.05)


@pytest.mark.parametrize(("work", "cutoff", "expected"), [(0.21, 0.165, 51.0), (0.063, 0.3, 12.0)])
def test_a_flattened_sphere_pulls_off_over_the_dome_that_springs_back(work, cutoff, expected):
    """Mesarovic and Johnson (2000): released of the pressure H within a, the top is a dome that
    falls off by s(r).

    s = 4 H a / (pi E*) (pi/2 - E(r/a)), E the complete elliptic integral. The attraction over the
    dome is the pull-off, but for what the rim outside adds, a tenth. The clamped law pulls with
    more than twice as much.
    """
    hardness, radius, load, pixels, length = 6.0, 10.0, 300.0, 64, 32.0
    a = np.sqrt(load / (np.pi * hardness))
    hamaker = 12 * np.pi * cutoff**2 * work

    def pressure(r: float) -> float:
        fallen = 4 * hardness * a / (np.pi * INPUTS.e_star) * (np.pi / 2 - ellipe((r / a) ** 2))
        return hamaker / (6 * np.pi * (fallen + cutoff) ** 3)

    dome = quad(lambda r: 2 * np.pi * r * pressure(r), 0, a)[0]
    assert dome == pytest.approx(expected, rel=0.04)  # which is rounded
    x, y = ((np.arange(pixels) - pixels // 2 + at) * length / pixels for at in (0.37, -0.21))
    bowl = (x[:, None] ** 2 + y[None, :] ** 2) / (2 * radius)
    inputs = ContactInputs(
        **{**vars(INPUTS), "hamaker": hamaker, "h_macro": hardness, "h_prime": 0.0}
    )
    pulls = {}
    for law in LAWS:
        settings = ContactSettings(
            mechanics="coupled",
            pixels=pixels,
            length_nm=length,
            gap_cutoff_nm=cutoff,
            attraction=law,
        )
        pulls[law] = pull_off(
            run_cycle(inputs, settings, 0, load, heights=bowl, contact_at="lowest").opening
        )
    assert dome < pulls["offset"] < 1.15 * dome
    assert pulls["clamped"] > 2.0 * pulls["offset"]
