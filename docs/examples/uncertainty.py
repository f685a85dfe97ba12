# %% [markdown]
# # How uncertain is the law?
#
# Give each input a distribution, draw inputs and surfaces at random, and see the band of the law.
# For a film of your [own scans](own_scan.py), take `film.inputs(material)` for `table` and
# `contact.on_grid` for `settings`.

# %%
import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

paper, measured = "Kim et al. (2013), Table 1", "our AFM"
table = asp.input_table(  # rows that are not named here are those of the paper's Table 1
    e_star=asp.InputRow(distribution="normal", values=(91.0, 3.8), source=paper),
    q0=asp.InputRow(values=(0.02, 0.03), source=measured),
    hurst=asp.InputRow(values=(0.7, 0.9), source=measured),
    rms=asp.InputRow(values=(4.0, 5.0), source=measured),
)
settings = asp.ContactSettings(pixels=256, max_force_nN=7000.0)
samples = asp.monte_carlo(table, settings, samples=24)
print(f"{len(samples.inputs['rms'])} laws, {len(samples.failed)} samples left out")

# %% [markdown]
# Parameters of the law. So few samples show the spread, not its causes: the workflow takes 800 and
# gives Sobol' indices with intervals.

# %%
for name, unit in (("d_c_nm", "nm"), ("C_r_GPa", "GPa"), ("rho_r_nm", "nm")):
    low, middle, high = np.quantile(getattr(samples.closing, name), (0.05, 0.5, 0.95))
    parameter = name.rpartition("_")[0]
    print(f"closing, {parameter}: {middle:.3g} {unit}, 5 to 95 % {low:.3g} to {high:.3g}")

# %%
touch = np.median(samples.closing.d_c_nm)
separations = np.linspace(touch - 7, touch + 4, 300)
figure, panels = plt.subplots(1, 2, figsize=(9, 4), sharey=True, layout="constrained")
for axes, branch, colour in zip(panels, ("closing", "opening"), ("C0", "C1")):
    laws = getattr(samples, branch)
    curves_MPa = 1000 * np.array([asp.pressure(h, laws)[1] for h in separations])
    low, middle, high = np.quantile(curves_MPa, (0.05, 0.5, 0.95), axis=1)
    axes.plot(separations, curves_MPa, color="0.7", lw=0.6)
    axes.fill_between(separations, low, high, color=colour, alpha=0.25, lw=0, label="5 to 95 %")
    axes.plot(separations, middle, color=colour, lw=2, label="median; grey: single samples")
    axes.set(xlabel="mean separation (nm)", title=branch)
    axes.legend()
cell_MPa = 1000 * settings.max_force_nN / settings.length_nm**2
panels[0].set(ylim=(0, cell_MPa), ylabel="repulsive pressure (MPa)")
figure.savefig("uncertainty.png", dpi=120)
