# %% [markdown]
# # A first contact
#
# Press a rough film onto a flat, release it, and fit the compact law to both branches.

# %%
import matplotlib.pyplot as plt

import asperity as asp

inputs = asp.ContactInputs(
    hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5
)
settings = asp.ContactSettings(pixels=256, max_force_nN=7000.0)
film = asp.random_surface(inputs, settings, seed=1)
cycle = asp.run_cycle(inputs, settings, seed=1, heights=film, contact_at="lowest")
loss, error = asp.dissipated_energy(cycle)
print(f"converged: {cycle.converged}; lost to plastic flow: {loss:.0f} ± {error:.0f} nN nm")

# %% [markdown]
# The tips of the film carry the force. Plastic flow flattens them. The contact therefore opens at a
# smaller separation than it closed at.

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4), layout="constrained")
side_um = settings.length_nm / 1000
square = (0, side_um, 0, side_um)
above = film.mean() - film.T  # the flat comes from the side of the minima
touching = above > cycle.closing.separation_nm.min()
image = left.imshow(above, extent=square, origin="lower", cmap="Greys_r")
left.contourf(touching, levels=[0.5, 1], colors="C3", extent=square)
left.set(xlabel="x (µm)", ylabel="y (µm)", title="the film, and what touches at the largest force")
figure.colorbar(image, ax=left, label="height (nm)", shrink=0.85)
branches = {"closing": cycle.closing, "opening": cycle.opening}
for (name, branch), law, colour in zip(branches.items(), asp.laws_of(cycle), ("C0", "C1")):
    fitted_nN = sum(asp.force(branch.separation_nm, law, cycle.cell_area_nm2))
    right.plot(branch.separation_nm, branch.net_nN / 1000, color=colour, label=name)
    right.plot(branch.separation_nm, fitted_nN / 1000, "--", color=colour, label=f"law of {name}")
right.axhline(0, color="0.7", lw=0.8)
deepest = min(branch.separation_nm.min() for branch in branches.values())
right.set(xlim=(deepest - 0.5, cycle.first_contact_nm + 3), title="one cell of 1 µm²")
right.set(ylim=(None, 1.05e-3 * settings.max_force_nN), xlabel="mean separation (nm)")
right.set(ylabel="force (µN), attraction below zero")
right.legend()
figure.savefig("first_contact.png", dpi=120)
