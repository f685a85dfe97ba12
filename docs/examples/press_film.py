# %% [markdown]
# # Three lines on your scans
#
# Name your files, press the film, draw it. Here the files are a published diamond film, which ships
# with Asperity (Lars Pastewka, CC BY 4.0). The counterface is soft, as a metal is.

# %%
import asperity as asp
from asperity.guards.bundle import ROOT

instruments = (
    {"files": "80_Scale*", "tip_radius_nm": 0, "noise_nm": 0.29},  # TEM has no tip
    {"files": "*stylus*", "tip_radius_nm": 5000},
)
container = ROOT / "config/measurements/uncd_diamond.zip"

# %%
film = asp.Film(container, tip_nm=21.5, instruments=instruments, line_alignment="none")
contact = film.press({"e_star": 75.0, "h_macro": 1.3})  # GPa
contact.plot().savefig("press_film.png", dpi=120)

# %% [markdown]
# Left: gap and contact spots of a cell of the film at the largest load. Right: the force of closing
# and opening. Opening, the contact pulls. `print(contact)` says by how much.

# %%
print(contact)
