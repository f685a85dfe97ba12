# %% [markdown]
# # Plastic flattening
#
# A wave is pressed until its crest flows. What stays when the load is gone, and how does the next
# contact differ?

# %%
import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

pixels, side_nm = 128, 200.0
x = np.arange(pixels) * side_nm / pixels
crest = np.cos(2 * np.pi * x / side_nm)
heights = -2.0 * (crest[:, None] + crest)  # touches at its lowest, nm
inputs = asp.ContactInputs(0.0, e_star=91.0, h_macro=3.0, h_prime=0.0, q0=0.03, hurst=0.8, rms=2.0)
settings = asp.ContactSettings(pixels=pixels, length_nm=side_nm, max_force_nN=40000.0)


def cycle_of(surface):
    """A cycle that keeps the surface as it is after it."""
    return asp.run_cycle(
        inputs, settings, 1, heights=surface, contact_at="lowest", keep_surface=True
    )


first = cycle_of(heights)
second = cycle_of(first.heights)
for name, cycle in {"first": first, "second": second}.items():
    loss, error = asp.dissipated_energy(cycle)
    print(f"{name} cycle: {loss:.1f} ± {error:.1f} nN nm lost")

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
left.plot(x, -heights[:, 0], label="before")
left.plot(x, -first.heights[:, 0], label="after")
left.set(xlabel="x (nm)", ylabel="height along the crest (nm)")
left.legend()
for name, cycle, style in (("first", first, "-"), ("second", second, "--")):
    right.plot(cycle.closing.separation_nm, cycle.closing.net_nN, style, label=f"{name} closing")
    right.plot(cycle.opening.separation_nm, cycle.opening.net_nN, style, label=f"{name} opening")
right.set(xlabel="mean separation (nm)", ylabel="force (nN)")
right.legend()
figure.savefig("plastic_flattening.png", dpi=120)
