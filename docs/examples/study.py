# %% [markdown]
# # A study on your own map
#
# Twenty cycles on one map: five hardnesses, four loads. What does the hardness do to the pull-off?
# The map is a random one here. Yours comes from `asp.Film("scan.gwy").maps[0]`, as
# `scan.heights_nm` and `scan.lengths_nm`.

# %%
import matplotlib.pyplot as plt
import pandas as pd

import asperity as asp

film = asp.ContactInputs(
    hamaker=0.2, e_star=90.0, h_macro=2.0, h_prime=0.0, q0=0.02, hurst=0.8, rms=4.0
)
# a random surface touches at its lowest points, a measured map at its highest: hence the minus
heights = -asp.random_surface(film, asp.ContactSettings(pixels=128), seed=1)

# %%
rows = []
for h_macro in (0.7, 1.0, 1.5, 2.2, 3.2):  # GPa
    for load_nN in (500, 1000, 2000, 4000):
        cycle = asp.cycle(heights, 1000.0, load_nN, 90.0, h_macro=h_macro, hamaker=0.2)
        lost_aJ, error_aJ = asp.dissipated_energy(cycle)
        rows.append((h_macro, load_nN, -cycle.opening.net_nN.min(), lost_aJ, cycle.converged))
table = pd.DataFrame(rows, columns=["h_macro", "load_nN", "pull_off_nN", "lost_aJ", "converged"])
print(table.round(1).to_string(index=False))

# %% [markdown]
# Soft tips flatten more. They then attract over a larger area, and pull off later.

# %%
figure, axes = plt.subplots(figsize=(5.5, 3.8), layout="constrained")
for h_macro, of_hardness in table.groupby("h_macro"):
    axes.plot(of_hardness.load_nN, of_hardness.pull_off_nN, "o-", label=f"{h_macro} GPa")
axes.set(xlabel="largest load (nN)", ylabel="pull-off (nN)")
axes.legend(title="hardness")
figure.savefig("study.png", dpi=120)
