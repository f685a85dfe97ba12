# %% [markdown]
# # A contact in humid air
#
# Water condenses in narrow gaps and pulls the walls together. How much work does it take to open a
# rough contact, at each humidity?

# %%
import matplotlib.pyplot as plt

import asperity as asp

inputs = asp.ContactInputs(0.2, e_star=91.0, h_macro=6.0, h_prime=0.0, q0=0.03, hurst=0.8, rms=2.0)
humidities = (0.0, 0.3, 0.5, 0.7, 0.8, 0.9)
curves = {}
works = []
for humidity in humidities:
    settings = asp.ContactSettings(
        pixels=128, q1_per_nm=0.2, max_force_nN=2000.0, air={"humidity": humidity}
    )
    cycle = asp.run_cycle(inputs, settings, seed=1)
    opening, _ = asp.work(cycle.opening, net=True)
    curves[humidity] = cycle.opening
    works.append(-opening / cycle.cell_area_nm2 * 1000)  # nN/nm = 1000 mJ/m2

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
for humidity, opening in curves.items():
    left.plot(opening.separation_nm, opening.net_nN / 1000, label=f"{humidity:.0%}")
left.set(xlabel="mean separation (nm)", ylabel="net force of opening (µN)")
left.legend(title="humidity")
right.plot([100 * humidity for humidity in humidities], works, "o-")
right.set(xlabel="relative humidity (%)", ylabel="net work of opening (mJ/m²)")
figure.savefig("humid_contact.png", dpi=120)
