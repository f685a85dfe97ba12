# %% [markdown]
# # A first contact curve
#
# Close a rough film onto a flat, open it again, and fit the compact force-separation law to both branches.

# %%
import matplotlib.pyplot as plt

import asperity as asp

inputs = asp.ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5)
settings = asp.ContactSettings(pixels=256, max_force_nN=7000.0)
cycle = asp.run_cycle(inputs, settings, seed=1)
loss, error = asp.dissipated_energy(cycle)
print(f"converged: {cycle.converged}; lost to plastic flow: {loss:.0f} ± {error:.0f} nN nm")

# %% [markdown]
# The flow of the asperities flattens the film: opening loses contact at a smaller separation than closing found it.

# %%
figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for branch, law, colour in zip((cycle.closing, cycle.opening), asp.laws_of(cycle), ("C0", "C1"), strict=True):
    name = "closing" if branch is cycle.closing else "opening"
    axes.plot(branch.separation_nm, branch.repulsive_nN, color=colour, label=name)
    fitted = asp.force(branch.separation_nm, law, cycle.cell_area_nm2)[1]
    axes.plot(branch.separation_nm, fitted, "--", color=colour, label=f"law of {name}")
touching = [branch.separation_nm[branch.repulsive_nN > 0] for branch in (cycle.closing, cycle.opening)]
axes.set(
    xlim=(min(t.min() for t in touching) - 0.5, cycle.first_contact_nm + 2), ylim=(0, 1.05 * settings.max_force_nN)
)
axes.set(xlabel="mean separation (nm)", ylabel="repulsive force (nN)")
axes.legend()
figure.savefig("first_contact.png", dpi=120)
