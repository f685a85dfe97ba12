# %% [markdown]
# # Your own map under a flat
#
# `asp.press` takes a measured map as it is and returns pressure and gap at each load. `asp.Film`
# levels it first, as a scene does. Here it is an AFM map of a diamond film (Lars Pastewka, CC BY
# 4.0), pressed on ruby.

# %%
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

# %% [markdown]
# `pressed.pressure_GPa` and `pressed.gap_nm` have one map a load. With `periodic=False` the map
# stands alone on the half-space and may be a rectangle. `periodic=True`, the default, repeats it; a
# map whose edges differ then has steps there. Without `h_macro=` nothing yields. The map is pressed
# with the noise of its instrument, and without the roughness that the tip misses.

# %%
pressed.plot_pressures().savefig("pressures.png", dpi=120)
