# %% [markdown]
# # A layered film
#
# A stiff film on a soft base. Light contacts feel the film, heavy ones the base. The same map is
# pressed on the film, and on bodies of the film or the base alone.

# %%
import matplotlib.pyplot as plt

import asperity as asp

inputs = asp.ContactInputs(0.0, e_star=10.0, h_macro=2.0, h_prime=0.0, q0=0.03, hurst=0.8, rms=2.0)
base = {"young_GPa": 9.1, "poisson": 0.3}  # E* = E / (1 - nu^2) = 10 GPa; the flat is rigid
stiff = {"young_GPa": 91.0, "poisson": 0.3}
bodies = {
    "film alone": ([stiff],),
    "20 nm of film on the base": ([{**stiff, "thickness_nm": 20.0}, base],),
    "base alone": ([base],),
}
figure, axes = plt.subplots(figsize=(6, 3.8), layout="constrained")
for name, layers in bodies.items():
    settings = asp.ContactSettings(
        model="elastic", pixels=128, q1_per_nm=0.2, max_force_nN=20000.0, bodies=layers
    )
    modulus = 100.0 if name == "film alone" else 10.0  # that of the bases
    cycle = asp.run_cycle(asp.ContactInputs(**{**vars(inputs), "e_star": modulus}), settings, 1)
    closing = cycle.closing
    share = closing.contact_area_nm2 / cycle.cell_area_nm2
    axes.loglog(closing.repulsive_nN / cycle.cell_area_nm2 * 1000, share, ".-", label=name)
axes.set(xlabel="mean pressure (MPa)", ylabel="share in contact", xlim=(0.1, None))
axes.legend()
figure.savefig("layered_film.png", dpi=120)
