# %% [markdown] # How uncertain is the law?  Give each input a distribution, draw inputs and
# surfaces at random, and see the band of the law. For a film of your [own scans](own_scan.py), take
# `film.inputs(material)` for `table` and `contact.on_grid` for `settings`.

# %%
import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

measured = "our AFM"
table = asp.input_table(  # rows that are not named here are those of the paper's Table 1
    e_star=asp.InputRow(
        distribution="normal", values=(91.0, 3.8), source="Kim et al. (2013), Table 1"
    ),
    q0=asp.InputRow(values=(0.02, 0.03), source=measured),
    hurst=asp.InputRow(values=(0.7, 0.9), source=measured),
    rms=asp.InputRow(values=(4.0, 5.0), source=measured),
)
settings = asp.ContactSettings(pixels=256, max_force_nN=7000.0)
samples = asp.monte_carlo(table, settings, samples=24)
print(f"{len(samples.inputs['rms'])} laws, {len(samples.failed)} samples left out")

# %% [markdown] Parameters of the law. So few samples show the spread, not its causes: the workflow
# takes 800 and gives Sobol' indices with intervals.

# %%
for name, unit in (("d_c_nm", "nm"), ("C_r_GPa", "GPa"), ("rho_r_nm", "nm")):
    low, middle, high = np.quantile(getattr(samples.closing, name), (0.05, 0.5, 0.95))
    print(
        f"closing, {name.rpartition('_')[0]}: median {middle:.3g} {unit}, 5 to 95 % {low:.3g} to"
        f" {high:.3g} {unit}"
    )

# %%
touch = np.median(samples.closing.d_c_nm)
h = np.linspace(touch - 7, touch + 4, 300)
figure, panels = plt.subplots(1, 2, figsize=(9, 4), sharey=True, layout="constrained")
for axes, laws, colour, branch in zip(
    panels, (samples.closing, samples.opening), ("C0", "C1"), ("closing", "opening"), strict=True
):
    repulsive = 1e3 * np.array(
        [asp.pressure(at, laws)[1] for at in h]
    )  # (separations, samples), MPa
    low, middle, high = np.quantile(repulsive, (0.05, 0.5, 0.95), axis=1)
    axes.plot(h, repulsive, color="0.7", lw=0.6, zorder=1)
    axes.fill_between(h, low, high, color=colour, alpha=0.25, lw=0, label="5 to 95 %")
    axes.plot(h, middle, color=colour, lw=2, label="median")
    axes.plot([], color="0.7", lw=0.6, label="single samples")
    axes.set(xlim=(h[0], h[-1]), xlabel="mean separation (nm)", title=branch)
    axes.legend()
cell_MPa = 1e3 * settings.max_force_nN / settings.length_nm**2
panels[0].set(ylim=(0, cell_MPa), ylabel="repulsive pressure (MPa)")
figure.savefig("uncertainty.png", dpi=120)
