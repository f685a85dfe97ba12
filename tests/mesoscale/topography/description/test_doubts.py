"""Each doubt fires where its cause is, and stays silent on maps of one plain surface."""

from collections import Counter

import numpy as np
import pytest

import asperity as asp
from mesoscale.topography.description.choice import _unit_doubt
from mesoscale.topography.description.heights import Z
from mesoscale.topography.height_synthesis import synthesize_heights
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.synthetic_scans import dilate, surface_patch

PLAIN = {"rms": 4.0, "q0": 0.02, "slope": 3.6}


def heights(length_nm=3000.0, pixels=256, seed=0, **other):
    """A map of a plain surface, which has waves down to the pixels."""
    known = PLAIN | other
    spectrum = RoughSpectrum.from_rms(
        known["rms"], known["q0"], known["slope"], np.pi * pixels / length_nm
    )
    return surface_patch(spectrum, pixels, length_nm, np.random.default_rng(seed))


def film(*maps, length_nm=3000.0, **settings):
    scans = [
        Scan(z, (length_nm, length_nm), f"m{k}") if isinstance(z, np.ndarray) else z
        for k, z in enumerate(maps)
    ]
    return asp.Film(scans, tip_nm=5.0, **settings)


def codes(found):
    return {doubt["code"] for doubt in found.description["doubts"]}


def along_lines(height):
    return heights() + height * np.sin(np.linspace(0, 20, 256))


def pits():
    z = heights()
    z[:6, 50:56] -= 2000.0
    z[-6:, 90:96] += 2000.0
    return z


def aborted():
    z = heights()
    z[:, 200:] = 0.0
    return z


def bowed():
    x = np.linspace(-1, 1, 256)
    return heights() + 40.0 * (x[:, None] ** 2 + x**2)


def grainy(seed):
    spectrum = RoughSpectrum.from_rms(8.0, 0.025, 3.0, 1.5)
    chart = np.exp(0.3 * Z)
    chart = tuple((chart - chart.mean()) / chart.std())
    surface = synthesize_heights(512, 1000.0, spectrum.psd, chart, 8.0, seed)
    return Scan(dilate(surface, 10.0, 1000.0 / 512), (1000.0, 1000.0), f"g{seed}")


def peaked():
    """A surface whose spectrum has a peak that no power law has."""
    z, x = heights(), np.linspace(0, 3000.0, 256)
    rng = np.random.default_rng(0)
    for angle, phase in rng.uniform(0, 2 * np.pi, (60, 2)):
        z = z + 1.5 * np.cos(0.06 * (np.cos(angle) * x[:, None] + np.sin(angle) * x) + phase)
    return z


LAW = {"description": "power_law"}
CAUSES = {
    "form": lambda: film(bowed()),
    "aborted_scan": lambda: film(aborted()),
    "alignment_took_roughness": lambda: film(along_lines(9.0)),
    "anisotropic": lambda: film(Scan(heights()[:, :64], (3000.0, 3000.0), "stretched")),
    "gap": lambda: film(
        *(
            Scan(heights(side, q0=0.0005, rms=100.0), (side, side), f"{side}")
            for side in (100.0, 2e4)
        )
    ),
    "one_place": lambda: film(heights()),
    "no_power_law": lambda: film(heights(1000.0), length_nm=1000.0),
    "flat_spectrum": lambda: film(heights(q0=0.1), **LAW),
    "no_plateau": lambda: film(heights(1000.0), length_nm=1000.0, **LAW),
    "short_range": lambda: film(heights(15_000.0), length_nm=15_000.0, **LAW),
    "no_common_power_law": lambda: film(peaked(), **LAW),
    "hurst_outside": lambda: film(heights(slope=4.6), **LAW),
    "finer_waves": lambda: film(heights(6000.0), length_nm=6000.0),
    "too_few_waves": lambda: film(np.random.default_rng(0).standard_normal((256, 256))),
    "rms_unlike_measured": lambda: film(pits()),
    "unseen_waves": lambda: film(heights(250.0), length_nm=250.0),
    "waves_beyond_cell": lambda: film(heights(2e4, slope=4.0, q0=0.0004), length_nm=2e4),
    "tip_on_grains": lambda: film(grainy(1), grainy(2)),
}


@pytest.mark.parametrize("code", CAUSES)
def test_it_fires_where_its_cause_is(code):
    assert code in codes(CAUSES[code]())


@pytest.mark.parametrize(
    ("factor", "length_nm"),
    [
        (1e3, 3000.0),  # heights in nm, taken as um
        (1e3, 1e5),
        (1.0, 10.0),  # a length in um, taken as nm
        (1e-3, 3000.0),  # heights in nm, taken as pm
    ],
)
def test_a_map_that_is_most_likely_in_another_unit_is_doubted(factor, length_nm):
    record = {
        "rms_nm": factor * PLAIN["rms"],
        "length_x_nm": length_nm,
    }
    (doubt,) = _unit_doubt("map", record)
    assert doubt.code == "unit_unlikely"
    assert "--unit um,nm" in doubt.remedy


@pytest.mark.parametrize(
    ("rms_nm", "length_nm"),
    [(4.0, 3000.0), (15.0, 250.0), (0.05, 500.0), (2000.0, 1e6), (0.0, 1000.0)],
)
def test_a_plain_map_is_in_its_unit(rms_nm, length_nm):
    """Mica has 0.05 nm, an optical map of 1 mm may have 2 um."""
    assert not list(_unit_doubt("map", {"rms_nm": rms_nm, "length_x_nm": length_nm}))


def test_an_overhanging_line_is_named(tmp_path):
    t = np.linspace(0.0, 40.0 * np.pi, 4001)
    rows = np.stack(
        [
            100.0 * t + 130.0 * np.sin(t),
            50.0 * np.cos(t) + np.random.default_rng(0).normal(size=t.size),
        ],
        1,
    )
    np.savetxt(
        tmp_path / "fold.txt", rows, header="x (nm), height (nm)", delimiter=",", comments=""
    )
    assert "overhang" in codes(asp.Film(tmp_path / "fold.txt", tip_nm=0.0))


def test_a_mask_over_measured_pixels_is_named(tmp_path):
    from gwyfile.objects import GwyContainer, GwyDataField

    def layer(values, unit):
        return GwyDataField(values, xreal=3e-6, yreal=3e-6, si_unit_xy="m", si_unit_z=unit)

    file, z = GwyContainer(), heights()
    file["/0/data/title"], file["/0/data"] = "Height", layer(1e-9 * z, "m")
    file["/0/mask"] = layer((z > 6.0).astype(float), "")
    file.tofile(str(tmp_path / "grains.gwy"))
    assert "marked_pixels" in codes(asp.Film(tmp_path / "grains.gwy", tip_nm=5.0))


def test_places_of_one_plain_surface_are_not_doubted():
    """Twelve films of four places each: of a rate of 5 %, three alarms of a kind have a chance of 2
    %.
    """
    found = Counter()
    for seed in range(12):
        rng = np.random.default_rng(seed)
        maps = [
            heights(seed=10 * seed + k) * np.exp(0.06 * rng.standard_normal()) for k in range(4)
        ]
        found.update(codes(film(*maps)))
    assert all(count <= 2 for count in found.values()), found
