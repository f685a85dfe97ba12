# %% [markdown]
# # A switch on a pad of your film
#
# From the film of [own scans](own_scan.py) to the voltage at which a switch lets go. The film is
# pressed on ruby. The paper's material stands in for what you do not give.

# %%
import asperity as asp
from asperity.guards.bundle import ROOT

instruments = (
    {"files": "80_Scale*", "tip_radius_nm": 0, "noise_nm": 0.29},
    {"files": "*stylus*", "tip_radius_nm": 5000},
)
container = ROOT / "config/measurements/uncd_diamond.zip"
film = asp.Film(container, tip_nm=21.5, instruments=instruments, line_alignment="none")
diamond_on_ruby = {"e_star": 295.0, "h_macro": 16.5, "h_prime": 0.0}  # GPa
contact = film.press(diamond_on_ruby)
print(contact)
contact.plot().savefig("switch_on_a_pad.png", dpi=120)

# %% [markdown]
# The cell is 4 µm wide, since shorter ones lack the film's long waves. The maps show where it
# touches. `contact.pressure_GPa`, `contact.gap_nm` and `contact.cycle` hold the numbers. They are
# those of a scene with the same inputs: digit for digit, where linear algebra runs on one thread
# (`OMP_NUM_THREADS=1`), as it does in a scene.
#
# A switch lands on many such places. Few tall grains carry this film, so 64 cells are pressed. They
# tell by themselves how far they must be closed. A scene gives the interval of the answer as well.

# %%
switch = contact.switch(asp.DeviceSettings())
print("\n".join(switch.lines()))
