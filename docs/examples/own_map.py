# %% [markdown]
# # Your own map under a flat
#
# `asp.press` takes a measured map as it is and returns pressure and gap at each load. `asp.Film`
# levels it first, as a scene does. Here it is an AFM map of a diamond film (Lars Pastewka, CC BY
# 4.0), pressed on ruby.

# %%
import matplotlib.pyplot as plt
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

# %% [markdown]
# `pressed.pressure_GPa` and `pressed.gap_nm` have one map a load. With `periodic=False` the map
# stands alone on the half-space and may be a rectangle. `periodic=True`, the default, repeats it; a
# map whose edges differ then has steps there. Without `h_macro=` nothing yields. The map is pressed
# with the noise of its instrument, and without the roughness that the tip misses.

# %%
figure, axes = plt.subplots(figsize=(5.5, 3.4), layout="constrained")
for load_nN, pressure_GPa in zip(pressed.loads_nN, pressed.pressure_GPa):
    axes.hist(pressure_GPa[pressure_GPa > 0], np.linspace(0, 20, 41), label=f"{load_nN:g} nN")
axes.set(xlabel="pressure (GPa)", ylabel="sites in contact")
axes.legend()
figure.savefig("pressures.png", dpi=120)
