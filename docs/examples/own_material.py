# %% [markdown]
# # Your own material
#
# A material enters the contact by four numbers: E*, two of hardness, and the Hamaker constant. Here fused silica
# on fused silica stands beside the paper's silicon nitride, on the same surface.
#
# | | silicon nitride on titanium | fused silica on fused silica |
# | --- | --- | --- |
# | E* (GPa) | 91 | 37 = 72 / (2 (1 − 0.17²)) |
# | H_macro (GPa) | 1.95 | 9 |
# | H′ (GPa nm^½) | 8.375 | 0: no size effect of indentation assumed |
# | Hamaker constant (10⁻¹⁸ J) | 0.215 | 0.065 |
#
# Silicon nitride: Table 1 of Kim et al. (2013). Silica: E, ν and hardness from W. C. Oliver and G. M. Pharr,
# J. Mater. Res. 7, 1564 (1992); Hamaker constant from L. Bergström, Adv. Colloid Interface Sci. 70, 125 (1997).
# The numbers of silica are rounded and quoted from memory of the sources: look them up before you use them.

# %%
import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

SURFACE = {"q0": 0.025, "hurst": 0.75, "rms": 8.5}
MATERIALS = {
    "silicon nitride": asp.ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, **SURFACE),
    "fused silica": asp.ContactInputs(
        hamaker=0.065, e_star=72 / (2 * (1 - 0.17**2)), h_macro=9.0, h_prime=0.0, **SURFACE
    ),
}
settings = asp.ContactSettings(pixels=256, max_force_nN=7000.0)
cycles = {name: asp.run_cycle(inputs, settings, seed=1) for name, inputs in MATERIALS.items()}
for name, cycle in cycles.items():
    lost, error = asp.dissipated_energy(cycle)
    spent = asp.work(cycle.closing)[0]
    print(f"{name}: work of closing {spent:.0f} nN nm, of which {lost / spent:.0%} is lost to plastic flow")

# %% [markdown]
# The law is fitted to each branch. Its pressure is the force over the area of the cell, attraction included.

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
for (name, cycle), colour in zip(cycles.items(), ("C0", "C1"), strict=True):
    closing, opening = asp.laws_of(cycle)
    deepest = cycle.closing.separation_nm.min()
    h = np.linspace(deepest, cycle.first_contact_nm + 3, 400)
    for law, line, branch in ((closing, "-", "closing"), (opening, "--", "opening")):
        attractive, repulsive = asp.pressure(h, law)
        label = f"{name}, {branch}"
        left.plot(h, 1e3 * repulsive, line, color=colour, label=label)
        right.plot(h, 1e3 * attractive, line, color=colour, label=label)
for axes, name in ((left, "repulsive pressure (MPa)"), (right, "attractive pressure (MPa)")):
    axes.set(xlabel="mean separation (nm)", ylabel=name)
left.set(ylim=(0, None))
left.legend()
figure.savefig("own_material.png", dpi=120)
