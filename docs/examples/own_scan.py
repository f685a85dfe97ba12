# %% [markdown]
# # Roughness of your own scans
#
# Name your files, a folder or a container: all formats of a scene will do. Here they are a
# published diamond film, seen by AFM, TEM and stylus. It ships with Asperity (Lars Pastewka, CC BY
# 4.0).

# %%
import asperity as asp
from asperity.guards.bundle import ROOT

side_view = {"files": "80_Scale*", "tip_radius_nm": 0, "noise_nm": 0.29}  # TEM has no tip
stylus = {"files": "*stylus*", "tip_radius_nm": 5000}
instruments = (side_view, stylus)  # what is in them and has another tip than the AFM
container = ROOT / "config/measurements/uncd_diamond.zip"
film = asp.Film(container, tip_nm=21.5, instruments=instruments, line_alignment="none")
print("\n".join(film.lines()))
film.plot().savefig("own_scan.png", dpi=120)

# %% [markdown]
# The first lines say what each measurement shows. Tip, noise and pixels end what it sees; what lies
# beyond is not used. Read the doubts before you go on: each has its remedy.

# %%
for name, estimate in film.description["estimates"].items():
    low, high = estimate["interval"]
    print(f"{name}: {low:.4g} to {high:.4g} {estimate.get('unit', '')}")
