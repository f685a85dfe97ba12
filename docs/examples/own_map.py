# %% [markdown] # Your map under a flat: pressure and gap  `asp.press` takes a measured map as it is
# and returns pressure and gap at each load. `asp.Film` levels it first, as a scene does. Here it is
# an AFM map of a diamond film (Lars Pastewka, CC BY 4.0), pressed on ruby.

# %%
import numpy as np

import asperity as asp
from asperity.guards.bundle import ROOT

instruments = (
    {"files": "80_Scale*", "tip_radius_nm": 0, "noise_nm": 0.29},
    {"files": "*stylus*", "tip_radius_nm": 5000},
)
container = ROOT / "config/measurements/uncd_diamond.zip"
film = asp.Film(container, tip_nm=21.5, instruments=instruments, line_alignment="none")
afm = min(film.maps, key=lambda scan: scan.length_nm)
pressed = asp.press(
    afm.heights_nm, afm.lengths_nm, [1e4, 4e4], e_star=295.0, h_macro=16.5, periodic=False
)
print("\n".join(pressed.lines()))
pressed.plot().savefig("own_map.png", dpi=120)

# %% [markdown] `pressed.pressure_GPa` and `pressed.gap_nm` have one map a load. With
# `periodic=False` the map stands alone on the half-space and may be a rectangle. `periodic=True`,
# the default, repeats it; a map whose edges differ then has steps there. Without `h_macro=` nothing
# yields. The map is pressed with the noise of its instrument, and without the roughness that the
# tip misses.  A sphere and a flat punch are maps, too. Hertz's contact radius, approach and largest
# pressure:

# %%
pixels, side, radius, load, e_star = 128, 200.0, 1000.0, 1000.0, 100.0
x = (np.arange(pixels) + 0.5) * side / pixels - side / 2
r = np.hypot(x[:, None], x)
sphere = asp.press(-(r**2) / (2 * radius), side, load, e_star, periodic=False)
a = (3 * load * radius / (4 * e_star)) ** (1 / 3)
print(f"contact radius: {side * np.sqrt(sphere.area_share[0] / np.pi):.2f} nm, Hertz {a:.2f} nm")
print(f"approach: {sphere.approach_nm[0]:.4f} nm, Hertz {a**2 / radius:.4f} nm")
print(
    f"pressure: {sphere.pressure_GPa.max():.3f} GPa, Hertz {3 * load / (2 * np.pi * a**2):.3f} GPa"
)
punch = asp.press(np.where(r < 50, 0, -500), side, load, e_star, periodic=False)
print(f"punch: approach {punch.approach_nm[0]:.4f} nm, exact {load / (2 * e_star * 50):.4f} nm")

# %% [markdown]
# Two maps on each other, with an attraction of your own, brought together by given distances:

# %%
waves = np.broadcast_to(0.1 * np.cos(2 * np.pi * x / 10), r.shape)


def attraction(gap_nm):
    return 0.2 / (6 * np.pi * (gap_nm + 0.3) ** 3)  # GPa


ball = -(r**2) / (2 * radius)
both = asp.press(
    ball, side, None, e_star, approach_nm=[0.2, 0.4], counterface=waves, attraction=attraction
)
print("\n".join(both.lines()))
print("attraction:", ", ".join(f"{force:.0f} nN" for force in both.attraction_nN))
