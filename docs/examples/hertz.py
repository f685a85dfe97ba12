# %% [markdown]
# # Hertz, and the error of a grid
#
# A sphere has an exact solution. Press one on finer and finer grids. How fast does the error fall,
# and what does it cost?

# %%
import time

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

side_nm, radius_nm, load_nN, e_star = 200.0, 1000.0, 1000.0, 100.0
exact_radius = asp.theory.hertz_contact_radius(load_nN, radius_nm, e_star)
exact_approach = asp.theory.hertz_indentation(load_nN, radius_nm, e_star)
grids = (32, 64, 128, 256)
errors = []
seconds = []
asp.press(-np.eye(8), side_nm, load_nN, e_star, periodic=False)  # compiles, which is not timed
for pixels in grids:
    x = (np.arange(pixels) + 0.5) * side_nm / pixels - side_nm / 2
    distance = np.hypot(x[:, None], x)
    begin = time.process_time()
    sphere = asp.press(-(distance**2) / (2 * radius_nm), side_nm, load_nN, e_star, periodic=False)
    seconds.append(time.process_time() - begin)
    exact = asp.theory.hertz_pressure(distance, load_nN, radius_nm, e_star)
    errors.append(abs(sphere.pressure_GPa[0] - exact).sum() / exact.sum())
    radius = side_nm * np.sqrt(sphere.area_share[0] / np.pi)
    print(f"{pixels:4d}: contact radius {radius:.2f} nm, Hertz {exact_radius:.2f} nm;", end=" ")
    print(f"approach {sphere.approach_nm[0]:.4f} nm, Hertz {exact_approach:.4f} nm")

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
middle = np.abs(x).argmin()
left.plot(x, sphere.pressure_GPa[0][:, middle], ".", label=f"{grids[-1]} sites a side")
left.plot(x, exact[:, middle], label="Hertz")
left.set(xlabel="x (nm)", ylabel="pressure (GPa)", xlim=(-70, 70))
left.legend()
right.loglog(grids, errors, "o-", label="error of the pressures, relative")
right.loglog(grids, seconds, "s--", label="processor seconds")
right.set(xlabel="sites a side", xticks=grids, xticklabels=grids)
right.minorticks_off()
right.legend()
figure.savefig("hertz.png", dpi=120)
