# %% [markdown]
# # Adhesion and pull-off
#
# A smooth sphere that attracts a flat is pulled off. Soft spheres follow Johnson, Kendall and
# Roberts (JKR), stiff ones Derjaguin, Muller and Toporov (DMT). `mechanics="adhesive"` lets the
# attraction deform the walls. It lies between the two theories.

# %%
import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

pixels, side_nm, radius_nm, e_star = 96, 60.0, 30.0, 20.0
hamaker, touch_gap_nm = 0.5, 0.4
work_of_adhesion = hamaker / (12 * np.pi * touch_gap_nm**2)  # nN/nm, of the law `offset`
x = (np.arange(pixels) + 0.5) * side_nm / pixels - side_nm / 2
sphere = (x[:, None] ** 2 + x**2) / (2 * radius_nm)
inputs = asp.ContactInputs(hamaker, e_star, 50.0, 0.0, q0=0.1, hurst=0.8, rms=1.0)
settings = asp.ContactSettings(
    mechanics="adhesive",
    model="elastic",
    pixels=pixels,
    length_nm=side_nm,
    max_force_nN=60.0,
    gap_cutoff_nm=touch_gap_nm,
)
cycle = asp.run_cycle(inputs, settings, 1, heights=sphere, contact_at="lowest")
tabor = asp.theory.tabor_parameter(radius_nm, e_star, work_of_adhesion, touch_gap_nm)
limits = {
    "JKR": asp.theory.jkr_pull_off(radius_nm, work_of_adhesion),
    "DMT": asp.theory.dmt_pull_off(radius_nm, work_of_adhesion),
}
print(f"pull-off {-cycle.opening.net_nN.min():.2f} nN, Tabor's parameter {tabor:.2f};", limits)

# %%
figure, axes = plt.subplots(figsize=(6, 3.8), layout="constrained")
axes.plot(cycle.closing.separation_nm, cycle.closing.net_nN, label="closing")
axes.plot(cycle.opening.separation_nm, cycle.opening.net_nN, label="opening")
for colour, (name, pull_nN) in zip(("C2", "C3"), limits.items()):
    axes.axhline(-pull_nN, ls=":", color=colour, label=f"pull-off by {name}")
axes.set(xlabel="mean separation (nm)", ylabel="net force (nN)", ylim=(-1.3 * pull_nN, 60))
axes.set(xlim=(9, 14))
axes.legend()
figure.savefig("pull_off.png", dpi=120)
