"""What stands in people's files for missing points, heights, directions, units, formats: kinds in
several dresses.
"""

import bz2
import gzip
import lzma
import re
import zipfile

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.settings import InstrumentSettings, TopographySettings
from mesoscale.topography.description.choice import STEPS_TO_TELL
from mesoscale.topography.measurements.channels import base_of, holds_heights, is_backward
from mesoscale.topography.measurements.cleaning import STAND_INS, Scan, clean
from mesoscale.topography.measurements.loading import load_measurements, write_gwy
from mesoscale.topography.measurements.missing import without_stand_ins
from mesoscale.topography.measurements.opening import write_channels
from mesoscale.topography.synthesis import synthesize_spectrum

SIDE, PIXELS = 500.0, 128


def surface(seed=0, pixels=PIXELS):
    """Heights of RMS 4 nm, correlated over many pixels as those of scans are, with tilt and
    noise.
    """
    heights = synthesize_spectrum(pixels, SIDE, lambda q: np.maximum(q, 0.03) ** -3.6, 4.0, seed)
    noise = 0.03 * np.random.default_rng(seed).standard_normal(heights.shape)
    return heights + noise + 0.2 * np.arange(pixels)[:, None]


def load(path, **instrument):
    settings = TopographySettings()
    if instrument:
        settings = TopographySettings(instruments=(InstrumentSettings(files="*", **instrument),))
    (measured,) = load_measurements(path, settings=settings)
    return measured.data


def refusal(path, **instrument):
    with pytest.raises(InputError) as error:
        load(path, **instrument)
    assert "\n" not in str(error.value)
    return str(error.value)


def matrix(
    path,
    heights,
    words=None,
    header="# Channel: Height\n# Width: 0.5 um\n# Height: 0.5 um\n# Value units: nm\n",
):
    """A text map as Gwyddion exports it; `words` replace values by place."""
    rows = [[f"{value:.5g}" for value in line] for line in heights.T]
    for (x, y), word in (words or {}).items():
        rows[y][x] = word
    path.write_text(header + "\n".join("\t".join(row) for row in rows) + "\n")
    return path


# Numbers and words that stand for missing points


def spread(heights, value, rng):
    places = rng.random(heights.shape) < 0.01
    return np.where(places, value, heights)


def patched(heights, value, rng):
    heights = heights.copy()
    for _ in range(5):
        x, y = rng.integers(0, PIXELS - 5, 2)
        heights[x : x + 5, y : y + 5] = value
    return heights


def lined(heights, value, rng):
    heights = heights.copy()
    heights[rng.integers(5, PIXELS - 5, 3), :] = value  # across the scan lines
    return heights


def half_lined(heights, value, rng):
    heights = heights.copy()
    heights[: PIXELS // 2, 40:44] = value  # parts of scan lines
    return heights


@pytest.mark.parametrize("value", [-9999.0, 9999.0, -32768.0, 0.0, 1e30, 3.4e38, -99.0])
@pytest.mark.parametrize("place", [spread, patched, lined, half_lined])
def test_a_number_that_stands_for_missing_points_is_missing(tmp_path, place, value):
    """Also 0 among heights that are counted from afar, and numbers beyond what a surface has."""
    true = surface() + 150.0
    changed = place(true, value, np.random.default_rng(1))
    path = tmp_path / "scan.gwy"
    write_gwy(path, Scan(changed, (SIDE, SIDE), "scan"))
    scan = load(path)
    assert np.array_equal(np.isnan(scan.heights_nm), changed != true)
    (step,) = (step for step in scan.steps if step.startswith(STAND_INS))
    assert f"{np.mean(changed != true):.2%}" in step
    assert f"exactly at {value:.6g} nm" in step
    assert STEPS_TO_TELL[STAND_INS][0] == "missing_points"
    plain = clean(Scan(true, (SIDE, SIDE), "true"), TopographySettings())
    # what is filled from neighbours is smoother: 3 % of the points at most
    assert clean(scan, TopographySettings()).rms_nm == pytest.approx(plain.rms_nm, rel=0.03)


def test_a_number_that_was_levelled_with_the_map_is_missing():
    """-9999 nm less a plane are many numbers, all of them far away."""
    true = surface()
    holes = np.random.default_rng(1).random(true.shape) < 0.01
    levelled = np.where(holes, -9999.0, true) - 0.2 * np.arange(PIXELS)[:, None]
    found, numbers = without_stand_ins(levelled)
    assert np.array_equal(np.isnan(found), holes)
    assert not numbers[0].exact


def test_two_numbers_may_stand_for_missing_points(tmp_path):
    true = surface()
    changed = true.copy()
    changed[10:14, 10:14], changed[50:53, 90:94] = -32768.0, 32767.0
    write_gwy(tmp_path / "scan.gwy", Scan(changed, (SIDE, SIDE), "scan"))
    assert np.array_equal(np.isnan(load(tmp_path / "scan.gwy").heights_nm), changed != true)


def terraces(rng):
    return np.repeat(np.repeat(rng.integers(0, 6, (16, 16)) * 0.5, 8, 0), 8, 1)


def grating(rng):
    return np.where(np.arange(PIXELS)[:, None] % 16 < 8, 100.0, 0.0) + np.zeros((1, PIXELS))


def eight_bit(rng):
    return np.round(surface() / 0.5) * 0.5


def cut_flat(rng):
    return np.maximum(surface(), 2.0)


def pits(rng):
    """Deep pits with walls that a tip rounds."""
    depth = synthesize_spectrum(PIXELS, SIDE, lambda q: np.maximum(q, 0.03) ** -4.0, 1.0, 5)
    return surface() - 60.0 * np.clip(depth - 1.5, 0.0, None)


def dusty(rng):
    x = np.arange(PIXELS)
    return surface() + 200.0 * np.exp(-((x[:, None] - 40) ** 2 + (x[None, :] - 70) ** 2) / 8.0)


@pytest.mark.parametrize("make", [terraces, grating, eight_bit, cut_flat, pits, dusty])
def test_steps_plateaus_pits_dust_and_coarse_digits_are_heights(make):
    heights = make(np.random.default_rng(3))
    assert without_stand_ins(heights)[1] == []


@pytest.mark.parametrize(
    "word", ["***", "---", "-", "n/a", "#N/A", "", "null", "1.#QNAN", "OVER", "--", "?"]
)
def test_a_word_among_numbers_loses_one_point_and_no_line(tmp_path, word):
    heights = surface()
    rng = np.random.default_rng(2)
    words = {(int(x), int(y)): word for x, y in rng.integers(0, PIXELS, (40, 2))}
    scan = load(matrix(tmp_path / "scan.txt", heights, words))
    assert scan.heights_nm.shape == (PIXELS, PIXELS)
    assert int(np.isnan(scan.heights_nm).sum()) == len(words)
    assert any(step.startswith(STAND_INS) for step in scan.steps)


def test_a_whole_line_of_words_is_a_line_of_missing_points(tmp_path):
    words = {(x, 30): "***" for x in range(PIXELS)}
    scan = load(matrix(tmp_path / "scan.txt", surface(), words))
    assert np.flatnonzero(np.isnan(scan.heights_nm).all(axis=0)).tolist() == [30]


def test_a_map_with_a_line_of_fewer_numbers_is_refused(tmp_path):
    path = matrix(tmp_path / "scan.txt", surface())
    lines = path.read_text().splitlines()
    lines[40] = "\t".join(lines[40].split("\t")[:-3])
    path.write_text("\n".join(lines) + "\n")
    assert "number" in refusal(path)


def line_rows():
    x = np.arange(512) * 2.0
    return x, surface(4, 512)[:, 100]


@pytest.mark.parametrize("word", ["9999", "-9999", "1e10", "***", "NaN", "", "n/a"])
def test_missing_points_of_a_line_are_filled_where_they_are(tmp_path, word):
    x, z = line_rows()
    rows = [f"{a:.4f},{b:.5f}" for a, b in zip(x, z, strict=True)]
    for k in range(20, 500, 50):
        rows[k] = f"{x[k]:.4f},{word}"
    (tmp_path / "line.csv").write_text("x (nm),z (nm)\n" + "\n".join(rows) + "\n")
    profile = load(tmp_path / "line.csv")
    assert len(profile.heights_nm) == 512
    assert not profile.resampled
    assert profile.heights_nm.std() == pytest.approx(z.std(), rel=0.01)
    assert any(step.startswith("filled 10 missing points") for step in profile.steps)


def test_one_pixel_in_fifty_is_a_spike_of_any_height():
    """The far quantile of differences is then that of spikes."""
    true, rng = surface(), np.random.default_rng(1)
    places = rng.random(true.shape) < 0.02
    spiked = np.where(places, true + rng.uniform(50.0, 90.0, true.shape), true)
    plain, cleaned = (
        clean(Scan(z, (SIDE, SIDE), "a"), TopographySettings()) for z in (true, spiked)
    )
    assert cleaned.rms_nm == pytest.approx(plain.rms_nm, rel=0.02)
    assert any(step.startswith("replaced many spikes") for step in cleaned.steps)


# Which channels and columns hold heights


@pytest.mark.parametrize(
    "name",
    [
        "Deformation",
        "Indentation",
        "Zerr",
        "ZErr",
        "DeflectionTrace",
        "Adhesion",
        "Dissipation",
        "DMTModulus",
        "Amplitude",
        "AmplitudeRetrace",
        "Phase2Trace",
        "Friction",
        "vDeflection",
        "excitation_forward",
        "skeleton",
        "grain_masks/above",
        "ordered_traces/above",
        "Ablenkung",
        "Regelabweichung",
        "Amplitudenfehler",
        "Déflexion",
        "Deformación",
        "Fase",
        "Erreur",
        "Výchylka",
        "Отклонение",
        "たわみ",
        "变形",
        "위상",
        "Excitation",
        "Current",
        "Strom",
        "Erro",
        "thumbnail",
    ],
)
def test_what_is_no_height_is_known_by_its_name(name):
    assert not holds_heights(name)


@pytest.mark.parametrize(
    "name",
    [
        "Height",
        "HeightSensor",
        "Z",
        "ZSensor",
        "Topography",
        "Höhe",
        "Hauteur",
        "Altura",
        "高さ",
        "Высота",
        "Default",
        "layer0",
        "image",
        "measuredHeight",
        "z_forward",
        "Elevation",
        "Relief",
        "Z-AxisSensor",
    ],
)
def test_a_height_is_not_refused_by_its_name(name):
    assert holds_heights(name)
    assert holds_heights("Height of grains")
    assert holds_heights("Height I")


PAIRS = [
    ("HeightTrace", "HeightRetrace"),
    ("Z_forward", "Z_backward"),
    ("Z (Fw)", "Z (Bw)"),
    ("Z →", "Z ←"),
    ("Height->", "Height<-"),
    ("Topography Fwd", "Topography Bwd"),
    ("ZSENSORTRACE", "ZSENSORRETRACE"),
    ("Höhe vorwärts", "Höhe rückwärts"),
    ("Höhe (hin)", "Höhe (zurück)"),
    ("Hauteur aller", "Hauteur retour"),
    ("Altura ida", "Altura vuelta"),
    ("Altezza andata", "Altezza ritorno"),
    ("Высота вперёд", "Высота назад"),
    ("高さ 往路", "高さ 復路"),
    ("高度 正向", "高度 反向"),
    ("Z L->R", "Z R->L"),
    ("topo_f", "topo_b"),
    ("Height left to right", "Height right to left"),
    ("Forward Up Z", "Backward Up Z"),
]


@pytest.mark.parametrize(("there", "back"), PAIRS)
def test_both_directions_are_one_channel_and_forward_is_taken(tmp_path, there, back):
    assert base_of(there) == base_of(back) != ""
    assert is_backward(back)
    assert not is_backward(there)
    heights = surface() * 1e-9
    write_channels(
        tmp_path / "a.gwy", {back: (heights + 1e-6, "m"), there: (heights, "m")}, (5e-7, 5e-7)
    )
    assert load(tmp_path / "a.gwy").heights_nm == pytest.approx(1e9 * heights)


def test_numbers_of_channels_are_no_directions():
    assert base_of("Height 1") != base_of("Height 2")


def test_the_channel_of_heights_is_taken_where_others_are_known_not_to_be(tmp_path):
    channels = {"Deformation": (surface() * 1e-10, "m"), "Height Sensor": (surface() * 1e-9, "m")}
    write_channels(tmp_path / "a.gwy", channels, (5e-7, 5e-7))
    assert load(tmp_path / "a.gwy").heights_nm == pytest.approx(surface())
    write_channels(tmp_path / "b.gwy", {"Deformation": channels["Deformation"]}, (5e-7, 5e-7))
    assert "no channel of heights" in refusal(tmp_path / "b.gwy")
    assert "it has Deformation" in refusal(tmp_path / "b.gwy")
    write_channels(
        tmp_path / "c.gwy", {"Strange": channels["Deformation"], **channels}, (5e-7, 5e-7)
    )
    assert load(tmp_path / "c.gwy").heights_nm == pytest.approx(surface())  # called a height


def test_a_gwyddion_file_has_amperes(tmp_path):
    write_channels(tmp_path / "a.gwy", {"Channel": (surface(), "A")}, (5e-7, 5e-7))
    assert "no channel of heights" in refusal(tmp_path / "a.gwy")
    header = "# Channel: Data\n# Width: 0.5 um\n# Height: 0.5 um\n# Value units: A\n"
    assert "no channel of heights" in refusal(matrix(tmp_path / "a.txt", surface(), header=header))
    x, z = line_rows()
    np.savetxt(
        tmp_path / "a.csv",
        np.stack([x, z], 1),
        delimiter=",",
        header="Lateral (nm), Raw (A)",
        comments="",
    )
    # of a stylus: ångström
    assert load(tmp_path / "a.csv").heights_nm.std() == pytest.approx(0.1 * z.std(), rel=0.01)


@pytest.mark.parametrize(
    "heads",
    [
        "Z piezo (nm)\tDeflection (nm)",
        "Z (nm)\tCurrent (A)",
        "Z (nm)\tI (A)",
        "Separation (nm)\tForce (nN)",
        "Z (nm)\tAmplitude (nm)",
        "Extension (nm)\tDeflection (nm)",
        "Height (nm)\tPhase (deg)",
        "Time (s)\tHeight (nm)",
        "Frequency (kHz)\tAmplitude (nm)",
        "Bias (V)\tZ (nm)",
        "Weg (nm)\tStrom (nA)",
        "Z [nm]\tHeight Sensor [nm]",
    ],
)
def test_a_table_of_a_curve_is_no_surface(tmp_path, heads):
    x, z = line_rows()
    np.savetxt(
        tmp_path / "curve.txt", np.stack([x, z], 1), delimiter="\t", header=heads, comments=""
    )
    assert "a table of" in refusal(tmp_path / "curve.txt")


def test_columns_of_a_wide_table_are_found_by_their_heads(tmp_path):
    x, z = line_rows()
    table = np.stack([np.arange(512), x, 3 * z, z + 1, z], 1)
    heads = "Index\tDistance (nm)\tDeflection (nm)\tHeight backward (nm)\tHeight forward (nm)"
    np.savetxt(tmp_path / "wide.txt", table, delimiter="\t", header=heads, comments="", fmt="%.5f")
    assert load(tmp_path / "wide.txt").heights_nm == pytest.approx(z, abs=1e-4)
    heads = "Index\tDistance (nm)\tPhase (deg)\tHeight raw (nm)\tHeight (nm)"
    np.savetxt(tmp_path / "two.txt", table, delimiter="\t", header=heads, comments="", fmt="%.5f")
    assert "several columns of heights: Height raw (nm), Height (nm)" in refusal(
        tmp_path / "two.txt"
    )
    assert load(tmp_path / "two.txt", channel="Height").heights_nm == pytest.approx(z, abs=1e-4)
    assert "holds no heights" in refusal(tmp_path / "two.txt", channel="Phase")


def test_a_table_of_spectra_is_not_asked_for_the_size_of_a_map(tmp_path):
    heads = "Bias calc (V)\tCurrent (A)\tLI Demod 1 X (A)\tLI Demod 1 Y (A)\tPhase (deg)"
    table = np.random.default_rng(0).standard_normal((512, 5))
    np.savetxt(tmp_path / "spectrum.dat", table, delimiter="\t", header=heads, comments="")
    np.savetxt(tmp_path / "bare.dat", table, delimiter="\t")
    for name in ("spectrum.dat", "bare.dat"):
        assert "size" not in refusal(tmp_path / name)


def test_data_sets_that_are_no_heights_are_not_listed(tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name in ("z_forward", "excitation_forward", "skeleton", "grain_masks/above"):
            file[name] = surface()
    assert load(tmp_path / "a.h5", size=(500.0, 500.0), unit="nm").heights_nm == pytest.approx(
        surface()
    )


def test_a_container_of_a_channel_without_heights_is_refused(tmp_path):
    import json

    channels = {"Height": (surface() * 1e-9, "m"), "Deflection": (surface() * 1e-9, "m")}
    write_channels(tmp_path / "a.gwy", channels, (5e-7, 5e-7))
    for source, fine in ((0, True), (1, False)):
        entry = {"name": "scan", "data_source": source, "datafile": {"original": "a.gwy"}}
        path = tmp_path / f"film_{source}.zip"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("meta.yml", json.dumps({"surfaces": [{"topographies": [entry]}]}))
            archive.write(tmp_path / "a.gwy", "a.gwy")
        if fine:
            assert load(path).heights_nm == pytest.approx(surface())
        else:
            assert "takes channel 'Deflection', which holds no heights" in refusal(path)


# Text as people export it


@pytest.mark.parametrize(
    ("heads", "factors"),
    [
        ("Distance [micrometers]\tHeight [nanometers]", (1e3, 1.0)),
        ("X_(microns)\tZ_(nm)", (1e3, 1.0)),
        ("Länge (Mikrometer)\tHöhe (nm)", (1e3, 1.0)),
        ("Distance in µm\tHeight in Angstrom", (1e3, 0.1)),
        ("x / Millimeters\tz / Micrometers", (1e6, 1e3)),
        ("Distance_um\tHeight_nm", (1e3, 1.0)),
        ("длина (мкм)\tвысота (нм)", (1e3, 1.0)),
    ],
)
def test_units_in_words_are_read(tmp_path, heads, factors):
    x, z = line_rows()
    table = np.stack([x / factors[0], z / factors[1]], 1)
    np.savetxt(
        tmp_path / "line.txt", table, delimiter="\t", header=heads, comments="", encoding="utf-8"
    )
    profile = load(tmp_path / "line.txt")
    assert profile.length_nm == pytest.approx(1024.0)
    assert profile.heights_nm == pytest.approx(z)


def test_a_line_of_units_below_the_names_is_read(tmp_path):
    x, z = line_rows()
    table = np.stack([x / 1e3, z], 1)
    np.savetxt(tmp_path / "line.txt", table, delimiter="\t", header="X\tZ\n[um]\t[nm]", comments="")
    assert load(tmp_path / "line.txt").length_nm == pytest.approx(1024.0)


def quoted(a, b):
    return f'"{a:.5f}";"{b:.5f}"'.replace(".", ",")


def quoted_commas(a, b):
    return f'"{a:.5f}","{b:.5f}"'.replace(".", ",")


def fortran(a, b):
    return f"{a:.6E}  {b:.6E}".replace("E", "D")


def minus(a, b):
    return f"{a:.5f}\t{b:.5f}".replace("-", "\u2212")


def semicolons(a, b):
    return f"{a:.5f};{b:.5f}"


def blanks(a, b):
    return f"   {a:.5f}     {b:.5f}  "


@pytest.mark.parametrize("row", [quoted, quoted_commas, fortran, minus, semicolons, blanks])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_numbers_are_read_in_all_spellings(tmp_path, row, encoding):
    if row is minus and encoding == "latin-1":
        pytest.skip("Latin-1 has no such minus")
    x, z = line_rows()
    (tmp_path / "line.csv").write_text(
        "\n".join(row(a, b) for a, b in zip(x, z, strict=True)), encoding=encoding
    )
    profile = load(tmp_path / "line.csv", unit="nm")
    assert profile.length_nm == pytest.approx(1024.0)
    assert profile.heights_nm == pytest.approx(z, abs=1e-4)


def test_heights_alone_with_decimal_commas_are_one_column(tmp_path):
    _, z = line_rows()
    (tmp_path / "line.txt").write_text("\n".join(f"{value:.4f}".replace(".", ",") for value in z))
    assert load(
        tmp_path / "line.txt", size=(1.0,), unit="um", height_unit="nm"
    ).heights_nm == pytest.approx(z, abs=1e-3)


def points_of(heights, kept):
    n = len(heights)
    x, y = np.meshgrid(np.arange(n) * 2.0, np.arange(n) * 2.0, indexing="ij")
    return np.stack([x[kept], y[kept], heights[kept]], 1)


@pytest.mark.parametrize("heads", ["x (nm)\ty (nm)\tz (nm)", ""])
def test_points_on_a_grid_with_holes_are_a_map_with_missing_points(tmp_path, heads):
    heights = surface()
    kept = np.random.default_rng(0).random(heights.shape) > 0.03
    points = np.random.default_rng(1).permutation(points_of(heights, kept))
    np.savetxt(tmp_path / "p.xyz", points, delimiter="\t", header=heads, comments="", fmt="%.4f")
    scan = load(tmp_path / "p.xyz", **({} if heads else {"unit": "nm"}))
    assert scan.lengths_nm == pytest.approx((256.0, 256.0))
    assert np.array_equal(np.isnan(scan.heights_nm), ~kept)
    assert scan.heights_nm[kept] == pytest.approx(heights[kept], abs=1e-3)


# Every remedy that is printed works


def test_heights_alone_take_a_length_and_a_unit(tmp_path):
    _, z = line_rows()
    np.savetxt(tmp_path / "alone.txt", z)
    asked = refusal(tmp_path / "alone.txt")
    assert "--size 1 --unit um,nm" in asked
    profile = load(tmp_path / "alone.txt", size=(1.0,), unit="um", height_unit="nm")
    assert profile.length_nm == pytest.approx(1000.0)
    assert profile.heights_nm == pytest.approx(z)


def test_a_channel_without_unit_takes_one(tmp_path):
    write_channels(tmp_path / "a.gwy", {"Height": (surface(), "")}, (5e-7, 5e-7))
    asked = refusal(tmp_path / "a.gwy")
    assert "channel Height has no unit" in asked
    assert "--unit nm" in asked
    assert load(tmp_path / "a.gwy", unit="nm").heights_nm == pytest.approx(surface())


def test_numpy_files_take_a_size_and_a_unit(tmp_path):
    np.save(tmp_path / "a.npy", surface())
    asked = refusal(tmp_path / "a.npy")
    assert "--size 1x1 --unit um,nm" in asked
    scan = load(tmp_path / "a.npy", size=(500.0, 500.0), unit="nm")
    assert scan.lengths_nm == pytest.approx((500.0, 500.0))
    assert scan.heights_nm == pytest.approx(surface())


@pytest.mark.parametrize("number", [np.nan, -9999.0])
def test_a_round_aperture_is_cut_to_its_largest_rectangle(tmp_path, number):
    x = np.arange(PIXELS) - PIXELS / 2 + 0.5
    inside = np.hypot(x[:, None], x[None, :]) < PIXELS / 2
    heights = np.where(inside, surface(), number)
    heights[60, 60] = number  # a small hole is filled, not cut off
    write_gwy(tmp_path / "a.gwy", Scan(heights, (SIDE, SIDE), "a"))
    with pytest.raises(InputError, match=r"21\.\d% of the pixels are missing.*--crop"):
        clean(load(tmp_path / "a.gwy"), TopographySettings())
    scan = load(tmp_path / "a.gwy", crop="largest")
    side = PIXELS / np.sqrt(2)  # of the largest square in a circle
    assert scan.heights_nm.shape[0] * scan.heights_nm.shape[1] == pytest.approx(side**2, rel=0.05)
    assert np.isnan(scan.heights_nm).sum() <= 1
    assert scan.pixel_nm == pytest.approx((SIDE / PIXELS, SIDE / PIXELS))
    clean(scan, TopographySettings())


def test_a_stated_part_is_taken_and_must_lie_inside(tmp_path):
    write_gwy(tmp_path / "a.gwy", Scan(surface(), (SIDE, SIDE), "a"))
    scan = load(tmp_path / "a.gwy", crop=(10, 90, 20, 60))
    assert scan.heights_nm == pytest.approx(surface()[10:90, 20:60])
    assert "accepted are 0:128, 0:128" in refusal(tmp_path / "a.gwy", crop=(10, 190, 20, 60))
    assert "at least 32 a side" in refusal(tmp_path / "a.gwy", crop=(10, 20, 20, 60))


def test_points_on_no_grid_take_numbers_of_places(tmp_path):
    heights, rng = surface(), np.random.default_rng(0)
    points = points_of(heights, np.ones(heights.shape, dtype=bool))
    points[:, :2] += rng.uniform(-0.6, 0.6, (len(points), 2))
    np.savetxt(
        tmp_path / "p.xyz", points, delimiter="\t", header="x (nm)\ty (nm)\tz (nm)", comments=""
    )
    asked = refusal(tmp_path / "p.xyz")
    assert "no regular grid" in asked
    places = tuple(int(count) for count in re.search(r"--points (\d+)x(\d+)", asked).groups())
    scan = load(tmp_path / "p.xyz", points=places)
    assert np.isnan(scan.heights_nm).mean() < 0.05
    assert np.nanstd(scan.heights_nm) == pytest.approx(heights.std(), rel=0.02)
    assert "points for 1000 x 1000 places; state how many places" in refusal(
        tmp_path / "p.xyz", points=(1000, 1000)
    )
    write_gwy(tmp_path / "a.gwy", Scan(heights, (SIDE, SIDE), "a"))
    assert "is no list of points" in refusal(tmp_path / "a.gwy", points=(64, 64))


# What a file is


@pytest.mark.parametrize(
    ("suffix", "opens"), [("gz", gzip.open), ("bz2", bz2.open), ("xz", lzma.open)]
)
def test_a_packed_file_is_unpacked(tmp_path, suffix, opens):
    write_gwy(tmp_path / "a.gwy", Scan(surface(), (SIDE, SIDE), "a"))
    with opens(tmp_path / f"a.gwy.{suffix}", "wb") as stream:
        stream.write((tmp_path / "a.gwy").read_bytes())
    assert load(tmp_path / f"a.gwy.{suffix}").heights_nm == pytest.approx(surface())
    whole = (tmp_path / f"a.gwy.{suffix}").read_bytes()
    (tmp_path / f"b.gwy.{suffix}").write_bytes(whole[: len(whole) // 2])
    assert "cannot be unpacked" in refusal(tmp_path / f"b.gwy.{suffix}")


def test_one_scan_in_an_archive_is_read_and_several_are_named(tmp_path):
    write_gwy(tmp_path / "a.gwy", Scan(surface(), (SIDE, SIDE), "a"))
    with zipfile.ZipFile(tmp_path / "one.zip", "w") as archive:
        archive.write(tmp_path / "a.gwy", "folder/a.gwy")
        archive.writestr("__MACOSX/._a.gwy", "x")
    assert load(tmp_path / "one.zip").heights_nm == pytest.approx(surface())
    with zipfile.ZipFile(tmp_path / "two.zip", "w") as archive:
        for name in ("a.gwy", "b.gwy"):
            archive.write(tmp_path / "a.gwy", name)
    assert "it holds a.gwy, b.gwy; unpack it" in refusal(tmp_path / "two.zip")


def test_a_gwyddion_simple_field_is_read(tmp_path):
    from gsffile import write_gsf

    metadata = {"XReal": 5e-7, "YReal": 4e-7, "XYUnits": "m", "ZUnits": "m", "Title": "Height"}
    write_gsf(tmp_path / "a.gsf", (surface() * 1e-9).T.astype(np.float32), metadata)
    scan = load(tmp_path / "a.gsf")
    assert scan.lengths_nm == pytest.approx((500.0, 400.0))
    assert scan.heights_nm == pytest.approx(surface(), abs=1e-4)
    write_gsf(tmp_path / "b.gsf", np.ones((40, 40), np.float32), metadata | {"ZUnits": "A"})
    assert "no channel of heights" in refusal(tmp_path / "b.gsf")
    (tmp_path / "c.gsf").write_bytes((tmp_path / "a.gsf").read_bytes()[:5000])
    assert "is the file complete?" in refusal(tmp_path / "c.gsf")


def nanonis(heights_m, unmeasured=0):
    """A scan of Nanonis with its tunnel current; the last lines were not measured."""
    rows = np.asarray(heights_m.T, dtype=">f4").copy()
    rows[len(rows) - unmeasured :] = np.nan
    nx, ny = heights_m.shape
    table = ["\tChannel\tName\tUnit\tDirection\tCalibration\tOffset"]
    table += ["\t14\tZ\tm\tboth\t1E-9\t0", "\t0\tCurrent\tA\tboth\t1E-9\t0", ""]
    keys = {
        "NANONIS_VERSION": "2",
        "SCAN_PIXELS": f"       {nx}       {ny}",
        "SCAN_TIME": "  1E+0  1E+0",
        "SCAN_RANGE": "  5.0E-7  4.0E-7",
        "SCAN_OFFSET": "  0E+0  0E+0",
        "SCAN_ANGLE": "0",
        "SCAN_DIR": "up",
        "BIAS": "1E+0",
        "ACQ_TIME": "10",
    }
    head = "".join(f":{key}:\n{value}\n" for key, value in keys.items())
    head += ":DATA_INFO:\n" + "\n".join(table) + "\n:SCANIT_END:\n\n\n"
    blocks = [rows, rows[:, ::-1], 1e-12 * rows, 1e-12 * rows]
    return head.encode() + b"\x1a\x04" + b"".join(block.tobytes() for block in blocks)


@pytest.mark.parametrize("name", ["a.sxm", "a.SXM"])
def test_a_scan_of_nanonis_is_read(tmp_path, name):
    (tmp_path / name).write_bytes(nanonis(surface() * 1e-9))
    scan = load(tmp_path / name)
    assert scan.lengths_nm == pytest.approx((500.0, 400.0))
    assert scan.heights_nm == pytest.approx(surface(), abs=1e-4)
    (tmp_path / "cut.sxm").write_bytes(nanonis(surface() * 1e-9)[:9000])
    assert "is the file complete?" in refusal(tmp_path / "cut.sxm")


def test_lines_that_an_aborted_scan_lacks_are_cut_off(tmp_path):
    (tmp_path / "a.sxm").write_bytes(nanonis(surface() * 1e-9, unmeasured=40))
    cleaned = clean(load(tmp_path / "a.sxm"), TopographySettings())
    assert cleaned.heights_nm.shape == (PIXELS, PIXELS - 40)
    assert any(step.startswith("cut off the end of an aborted scan") for step in cleaned.steps)


@pytest.mark.parametrize(
    ("name", "begins", "words"),
    [
        ("a.dat", b"[Paramco32]\r\nVersion=\xb5",
        "an image of Createc, which is not read; open it in Gwyddion"),
        ("a.VERT", b"ParVERT30\r\n0.1 0.2 0.3\r\n", "a spectrum of Createc"),
        ("a.3ds", b'Grid dim="20 x 20"\r\n', "a grid of spectra of Nanonis"),
        ("a.stl", b"solid part\nfacet normal 0 0 1\n", "a mesh of triangles"),
        ("a.stl", b"\0" * 84 + b"\x01" * 50, "a mesh of triangles"),
        ("a.sur", b"DSCOMPRESSED" + b"\0" * 600,
        "Digital Surf, compressed, which is not read; save it without"),
        ("a.pro", b"DSCOMPRESSED" + b"\0" * 600, "Digital Surf, compressed"),
        ("a.mtrx", b"ONTMATRX0101" + b"\0" * 100, "Omicron MATRIX"),
        ("a.jpk-qi-data", b"PK\x03\x04" + b"\0" * 100, "a force map of JPK"),
        ("a.sm4", b"\xaa\x00S\x00T\x00i\x00M\x00a\x00" + b"\0" * 100, "RHK"),
        ("a.png", b"\x89PNG\r\n\x1a\n" + b"\0" * 100, "a picture"),
        ("a.gwy", b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 12\n",
        "a pointer of Git LFS"),
        ("a.ibw", b"<!DOCTYPE html><html>404</html>", "a web page"),
        ("a.7z", b"7z\xbc\xaf\x27\x1c" + b"\0" * 100, "an archive, which is not read; unpack it"),
        ("a.gwy", b"", "the file is empty"),
        ("a.xyzabc", b"MYFORMAT1.0\n\x01\x02\x03" + b"\xfe" * 400, "begins with"),
    ],
)  # fmt: skip
def test_a_format_that_is_not_read_is_named_with_a_way_out(tmp_path, name, begins, words):
    (tmp_path / name).write_bytes(begins)
    assert words in refusal(tmp_path / name)


def test_a_cut_file_is_told_by_its_own_reader(tmp_path):
    write_gwy(tmp_path / "a.gwy", Scan(surface(), (SIDE, SIDE), "a"))
    (tmp_path / "cut.gwy").write_bytes((tmp_path / "a.gwy").read_bytes()[:20_000])
    assert "(Gwyddion: " in refusal(tmp_path / "cut.gwy")
    np.save(tmp_path / "a.npy", surface())
    (tmp_path / "cut.npy").write_bytes((tmp_path / "a.npy").read_bytes()[:5000])
    assert "is the file complete?" in refusal(tmp_path / "cut.npy", size=(1.0, 1.0), unit="um")
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["z"] = surface()
    (tmp_path / "cut.h5").write_bytes((tmp_path / "a.h5").read_bytes()[:9000])
    assert "(Hierarchical data format (HDF5): " in refusal(tmp_path / "cut.h5")
