# %% [markdown]
# # Your own scan
#
# Load a scan of the microscope, measure its roughness, and close a contact on it.
#
# Here the film is synthetic, with known roughness, and stands in a Gwyddion file in a temporary folder. With a scan of
# your own, drop the next cell and name your file instead: any format that SurfaceTopography reads will do.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from mesoscale.topography.measurements.loading import write_gwy

TRUTH = asp.ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.7, rms=5.0)
folder = tempfile.TemporaryDirectory()
film = Path(folder.name) / "film.gwy"
SIDE_NM = 5000.0
heights = asp.random_surface(TRUTH, asp.ContactSettings(pixels=1024, length_nm=SIDE_NM), seed=1)
write_gwy(film, asp.Scan(heights, (SIDE_NM, SIDE_NM), "film"))

# %% [markdown]
# Roughness of one scan. With several scans of the film the ranges also hold its scatter from place to place.
# The gate says whether the numbers can be trusted.

# %%
scan = asp.load_scan(film)
roughness = asp.measure_roughness([scan])
print("gate passed:", roughness["gate"]["passed"])
for name, estimate in roughness["estimates"].items():
    low, high = estimate["interval"]
    print(f"{name}: {estimate['value']:.3g} {estimate['unit']}, 90 % interval {low:.3g} to {high:.3g}")

# %% [markdown]
# One contact on the scan itself, and five on random surfaces of the measured roughness, at the pressure that the
# paper closes to, 7 MPa. What the scan does not give (E*, hardness, Hamaker constant) is the paper's.

# %%
inputs = asp.ContactInputs(**asp.input_table(topography=roughness).medians())
pressed, length_nm = asp.contacting_heights(asp.clean(scan, asp.TopographySettings()))
settings = asp.ContactSettings(pixels=len(pressed), length_nm=length_nm, max_force_nN=7e-3 * length_nm**2)
on_scan = asp.run_cycle(inputs, settings, seed=1, heights=pressed)
on_random = [asp.run_cycle(inputs, settings, seed) for seed in range(2, 7)]
print(f"scan: first contact at {on_scan.first_contact_nm:.1f} nm")
print("random surfaces:", ", ".join(f"{cycle.first_contact_nm:.1f}" for cycle in on_random), "nm")

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
side_um = length_nm / 1000
limit = 3 * scan.rms_nm
image = left.imshow(scan.heights_nm.T, extent=(0, side_um, 0, side_um), cmap="viridis", vmin=-limit, vmax=limit)
left.set(xlabel="x (µm)", ylabel="y (µm)", title=f"RMS height {scan.rms_nm:.1f} nm")
figure.colorbar(image, ax=left, label="height (nm)", extend="both", shrink=0.85)
for k, cycle in enumerate([*on_random, on_scan]):
    label = "the scan" if cycle is on_scan else "random surfaces of its roughness" if k == 0 else None
    style = {"color": "C0", "lw": 2} if cycle is on_scan else {"color": "0.7", "lw": 1}
    right.plot(
        cycle.closing.separation_nm, 1e3 * cycle.closing.repulsive_nN / cycle.cell_area_nm2, label=label, **style
    )
deepest = np.min([cycle.closing.separation_nm.min() for cycle in [*on_random, on_scan]])
right.set(xlim=(deepest - 0.5, on_scan.first_contact_nm + 4), ylim=(0, None), title="closing")
right.set(xlabel="mean separation (nm)", ylabel="repulsive pressure (MPa)")
right.legend()
figure.savefig("own_scan.png", dpi=120)
folder.cleanup()
