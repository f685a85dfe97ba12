# %% [markdown] # A first contact curve  Press a rough film onto a flat, release it, and fit the
# compact force-separation law to both branches.

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

# %% [markdown] The tips of the film carry the force. Their plastic flow flattens them, so that the
# contact opens at a smaller separation than it closed at.

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4), layout="constrained")
side_um = settings.length_nm / 1000
above = film.mean() - film.T  # the flat comes from the side of the minima
image = left.imshow(above, extent=(0, side_um, 0, side_um), origin="lower", cmap="Greys_r")
left.contourf(
    above > cycle.closing.separation_nm.min(),
    levels=[0.5, 1],
    colors="C3",
    extent=(0, side_um, 0, side_um),
)
left.set(xlabel="x (µm)", ylabel="y (µm)", title="the film, and what touches at the largest force")
figure.colorbar(image, ax=left, label="height (nm)", shrink=0.85)
for name, branch, law, colour in zip(
    ("closing", "opening"),
    (cycle.closing, cycle.opening),
    asp.laws_of(cycle),
    ("C0", "C1"),
    strict=True,
):
    net_uN = 1e-3 * (branch.repulsive_nN + branch.attractive_nN)
    right.plot(branch.separation_nm, net_uN, color=colour, label=name)
    fitted = 1e-3 * sum(asp.force(branch.separation_nm, law, cycle.cell_area_nm2))
    right.plot(branch.separation_nm, fitted, "--", color=colour, label=f"law of {name}")
right.axhline(0, color="0.7", lw=0.8)
deepest = min(cycle.closing.separation_nm.min(), cycle.opening.separation_nm.min())
right.set(
    xlim=(deepest - 0.5, cycle.first_contact_nm + 3), ylim=(None, 1.05e-3 * settings.max_force_nN)
)
right.set(
    xlabel="mean separation (nm)",
    ylabel="force (µN), attraction below zero",
    title="one cell of 1 µm²",
)
right.legend()
figure.savefig("first_contact.png", dpi=120)
