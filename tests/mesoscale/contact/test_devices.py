"""One load by the array API, as on a GPU: here by `array-api-strict`, which is NumPy with nothing
that the standard lacks.
"""

import importlib.util
import types

import numpy as np
import pytest

import asperity as asp
from asperity import pressed_map
from mesoscale.contact.coupled import devices, one_load
from mesoscale.contact.coupled.base import Alone, Base, Repeated
from mesoscale.settings.contact import MaterialSettings

strict = pytest.importorskip("array_api_strict")

E_STAR = 100.0
SIDE = 200.0
SINGLE = 3e-6  # of the largest pressure: sums in single precision are in another order
FILM = (
    MaterialSettings(young_GPa=200.0, poisson=0.2, thickness_nm=5.0),
    MaterialSettings(young_GPa=70.0, poisson=0.2),
)
WITH_TORCH = importlib.util.find_spec("torch") is not None
LIBRARIES = [
    "array_api_strict",
    pytest.param("torch", marks=pytest.mark.skipif(not WITH_TORCH, reason="no PyTorch")),
]


def rough(seed: int, pixels: int, hurst: float = 0.7, cut: float = 0.5) -> np.ndarray:
    """A surface 0.5 nm high, whose shortest wave has 1 / cut sites."""
    random = np.random.default_rng(seed)
    waves = np.hypot(np.fft.fftfreq(pixels)[:, None], np.fft.rfftfreq(pixels))
    waves[0, 0] = np.inf
    size = np.where(waves <= cut, waves ** (-1.0 - hurst), 0.0)
    heights = np.fft.irfft2(size * np.exp(2j * np.pi * random.random(size.shape)), s=(pixels,) * 2)
    return 0.5 * heights / heights.std()


def moved_to(library: str, heights: np.ndarray):
    """Heights as an array of a library, on the processor."""
    if library == "torch":
        return importlib.import_module("torch").asarray(heights)
    return strict.asarray(heights)


def check_same(here: one_load.Pressed, there: one_load.Pressed, base: Base) -> None:
    """Compare a load with NumPy's: sites, pressures, gaps and separation."""
    assert here.settled
    assert there.settled
    pressure = devices.fetched(there.pressure)
    gap = devices.fetched(there.gap)
    assert isinstance(pressure, np.ndarray)
    assert not devices.is_numpy(there.pressure)
    largest = here.pressure.max()
    np.testing.assert_array_equal(pressure > 0.0, here.pressure > 0.0)
    np.testing.assert_allclose(pressure, here.pressure, atol=SINGLE * largest)
    # pressures over the whole map bend it by more than one site's
    bent = SINGLE * largest * base.spring * 10.0
    np.testing.assert_allclose(gap, here.gap, atol=bent)
    assert there.separation == pytest.approx(here.separation, abs=bent)
    # steps that end by a threshold may end one sooner or later
    assert abs(there.transforms - here.transforms) <= 2 + here.transforms // 10


def base_of(heights: np.ndarray, repeats: bool, bodies: tuple = ()) -> Base:
    spacing = SIDE / len(heights)
    if repeats:
        return Repeated(heights.shape, spacing, E_STAR, bodies)
    return Alone(heights.shape, spacing, E_STAR)


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("load", [3.0, 1000.0, 2e4])
@pytest.mark.parametrize("repeats", [True, False])
@pytest.mark.parametrize(
    ("pixels", "hurst", "cut"), [(128, 0.7, 0.06), (128, 0.2, 0.5), (97, 0.7, 0.5), (50, 0.8, 0.2)]
)
def test_a_load_is_numpys(library, pixels, hurst, cut, repeats, load):
    heights = rough(pixels, pixels, hurst, cut)
    if not repeats:
        heights = heights[: pixels - 7] + np.linspace(0.0, 1.0, pixels)
    here = one_load.press(heights, load, base_of(heights, repeats))
    base = base_of(heights, repeats)
    there = one_load.press(moved_to(library, heights), load, base)
    check_same(here, there, base)
    assert devices.fetched(there.pressure).sum() * base.site_area == pytest.approx(load, rel=1e-9)


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("share", [0.9, 0.999])
def test_a_load_near_full_contact_is_numpys(library, share):
    heights = rough(3, 96)
    waves = np.hypot(np.fft.fftfreq(96)[:, None], np.fft.rfftfreq(96)) * (
        96 * np.pi * E_STAR / SIDE
    )
    # the pressures that flatten it; their least part is the mean pressure of full contact
    full = -np.fft.irfft2(np.fft.rfft2(heights) * waves, s=heights.shape).min()
    base = base_of(heights, True)
    here = one_load.press(heights, share * full * SIDE**2, base_of(heights, True))
    there = one_load.press(moved_to(library, heights), share * full * SIDE**2, base)
    assert (here.pressure > 0.0).mean() > 0.9
    check_same(here, there, base)


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("repeats", [True, False])
@pytest.mark.parametrize(("load", "hardness"), [(100.0, 2.0), (2e4, 2.0), (2e4, 1e3)])
def test_a_load_that_yields_is_numpys(library, repeats, load, hardness):
    heights = rough(5, 101)
    base = base_of(heights, repeats)
    here = one_load.press_yielding(heights, load, hardness, base_of(heights, repeats))
    there = one_load.press_yielding(moved_to(library, heights), load, hardness, base)
    check_same(here, there, base)
    yielding = devices.fetched(there.pressure) == hardness
    np.testing.assert_array_equal(yielding, here.pressure == hardness)


@pytest.mark.parametrize("hardness", [np.inf, 2.0])
def test_a_separation_is_numpys(hardness):
    heights = rough(6, 128)
    separation = -float(heights.min()) - 0.6
    base = base_of(heights, True)
    here = one_load.press_to(heights, separation, base_of(heights, True), hardness)
    there = one_load.press_to(strict.asarray(heights), separation, base, hardness)
    check_same(here, there, base)


def test_layers_are_numpys():
    heights = rough(7, 128)
    base = base_of(heights, True, (FILM,))
    here = one_load.press(heights, 3000.0, base_of(heights, True, (FILM,)))
    check_same(here, one_load.press(strict.asarray(heights), 3000.0, base), base)


@pytest.mark.parametrize("shape", [(4, 4), (4, 9), (5, 3)])
def test_maps_of_a_few_sites_are_numpys(shape):
    heights = np.random.default_rng(5).normal(size=shape)
    repeats = shape[0] == shape[1]
    base = base_of(heights, repeats)
    here = one_load.press(heights, 20.0, base_of(heights, repeats))
    check_same(here, one_load.press(strict.asarray(heights), 20.0, base), base)


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize(
    "wanted",
    [
        {"loads_nN": [100.0, 2000.0, 4000.0, 5000.0, 6000.0, 7000.0]},
        {"loads_nN": 2000.0, "h_macro": 3.0},
        {"loads_nN": None, "approach_nm": [0.3, 0.6]},
    ],
)
def test_a_map_pressed_on_a_device_comes_back_as_numpys(monkeypatch, wanted, periodic):
    heights = rough(8, 64)
    here = asp.press(heights, SIDE, e_star=E_STAR, periodic=periodic, **wanted)
    placed = []

    def on_strict(array, device, transformed):
        placed.append((device, transformed))
        return strict.asarray(array)

    monkeypatch.setattr(pressed_map, "placed", on_strict)
    there = asp.press(heights, SIDE, e_star=E_STAR, periodic=periodic, device="cuda", **wanted)
    assert placed == [("cuda", heights.size * (1 if periodic else 4))]
    assert isinstance(there.pressure_GPa, np.ndarray)
    assert there.converged
    np.testing.assert_array_equal(there.pressure_GPa > 0.0, here.pressure_GPa > 0.0)
    largest = here.pressure_GPa.max()
    np.testing.assert_allclose(there.pressure_GPa, here.pressure_GPa, atol=1e-5 * largest)
    np.testing.assert_allclose(there.approach_nm, here.approach_nm, rtol=1e-4)


@pytest.mark.parametrize("device", ["gpu", "cuda:1", None, 0])
def test_what_is_no_device_is_refused_in_one_line(device):
    with pytest.raises(asp.InputError, match="accepted are 'cpu' and 'cuda'") as refusal:
        asp.press(rough(1, 16), SIDE, 10.0, E_STAR, device=device)
    assert "\n" not in str(refusal.value)


def test_a_size_effect_on_a_device_is_refused():
    with pytest.raises(asp.InputError, match=r"h_prime = 8.*device = 'cuda'.*leave out h_prime"):
        asp.press(rough(1, 16), SIDE, 10.0, E_STAR, h_macro=2.0, h_prime=8.0, device="cuda")


def library_with(gpu: bool, bytes_there: int = 0) -> types.ModuleType:
    """A CuPy that finds a GPU or none."""
    device = types.SimpleNamespace(mem_info=(0, bytes_there))
    library = types.ModuleType("cupy")
    library.cuda = types.SimpleNamespace(is_available=lambda: gpu, Device=lambda number: device)
    return library


def install(monkeypatch, **libraries) -> None:
    """Have these libraries installed, and no others."""
    real = importlib.import_module
    monkeypatch.setattr(importlib.util, "find_spec", libraries.get)
    monkeypatch.setattr(importlib, "import_module", lambda name: libraries.get(name) or real(name))


def test_a_device_without_its_library_says_what_to_install(monkeypatch):
    install(monkeypatch)
    with pytest.raises(asp.MissingExtra, match=r"needs CuPy or PyTorch.*'asperity-contact\[gpu\]'"):
        asp.press(rough(1, 16), SIDE, 10.0, E_STAR, device="cuda")


def test_a_machine_without_a_gpu_says_so(monkeypatch):
    install(monkeypatch, cupy=library_with(gpu=False))
    with pytest.raises(asp.InputError, match=r"no GPU for CuPy .* take device='cpu'"):
        asp.press(rough(1, 16), SIDE, 10.0, E_STAR, device="cuda")


@pytest.mark.parametrize(("periodic", "needed"), [(True, "0.0317"), (False, "0.0686")])
def test_a_map_beyond_the_memory_of_the_gpu_is_refused(monkeypatch, periodic, needed):
    install(monkeypatch, cupy=library_with(gpu=True, bytes_there=10**6))
    with pytest.raises(
        asp.InputError, match=f"needs {needed} GB of the GPU's memory, it has 0.001"
    ):
        asp.press(rough(1, 506), SIDE, 10.0, E_STAR, periodic=periodic, device="cuda")
