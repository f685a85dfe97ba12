# %% [markdown] # From your own scans to a switch  Name your files, a folder or a container: all
# formats of a scene will do. Here they are a published diamond film, seen by AFM, TEM and stylus.
# It ships with Asperity (Lars Pastewka, CC BY 4.0).

# %%
import asperity as asp
from asperity.guards.bundle import ROOT

side_view = {"files": "80_Scale*", "tip_radius_nm": 0, "noise_nm": 0.29}  # TEM has no tip
stylus = {"files": "*stylus*", "tip_radius_nm": 5000}
instruments = (side_view, stylus)  # what is in them and has another tip than the AFM
container = ROOT / "config/measurements/uncd_diamond.zip"
film = asp.Film(container, tip_nm=21.5, instruments=instruments, line_alignment="none")
print("\n".join(film.lines()))
film.plot()

# %% [markdown] The first lines say what each measurement shows. Tip, noise and pixels end what it
# sees; what lies beyond is not used. Read the doubts before you go on: each has its remedy.  Now
# close a cell of the film on ruby. It is 4 µm wide, since shorter ones lack the film's long waves.
# The paper's material stands in for what you do not give.

# %%
diamond_on_ruby = {"e_star": 295.0, "h_macro": 16.5, "h_prime": 0.0}  # GPa
contact = film.press(diamond_on_ruby)
print(contact)
contact.plot().savefig("own_scan.png", dpi=120)

# %% [markdown] The maps show where the film touches. `contact.pressure_GPa`, `contact.gap_nm` and
# `contact.cycle` hold the numbers. They are those of a scene with the same inputs: digit for digit,
# where linear algebra runs on one thread (`OMP_NUM_THREADS=1`), as it does in a scene.  A switch
# lands on many such places. Few tall grains carry this film, so 64 cells are pressed, which tell by
# themselves how far they must be closed. A scene gives the interval of the answer as well.

# %%
switch = contact.switch(asp.DeviceSettings())
print("\n".join(switch.lines()))
