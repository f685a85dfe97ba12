# %% [markdown]
# # From the law to a switch
#
# A plate above a rough dielectric is pulled down by a voltage and snaps in; when the voltage falls it lets go. The
# law of closing decides how it lands, the law of opening when it is released.

# %%
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

inputs = asp.ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5)
cycle = asp.run_cycle(inputs, asp.ContactSettings(pixels=256, max_force_nN=7000.0), seed=1)
closing, opening = asp.laws_of(cycle)

# %% [markdown]
# The default beam is that of a published capacitive switch. It lands flat; the strip of mid-span that comes off last
# follows from its gap. `adhesion_scale: 0` switches the attraction off.

# %%
with_adhesion = asp.DeviceSettings()
without = with_adhesion.model_copy(update={"adhesion_scale": 0.0})
cases = {"with adhesion": with_adhesion, "without adhesion": without}
states = {name: asp.drive_switch(settings, closing, opening) for name, settings in cases.items()}
for name, state in states.items():
    release = "never (stuck)" if state.stuck[0] else f"{state.release_V[0]:.1f} V"
    print(f"{name}: pull-in {state.pull_in_V[0]:.1f} V, release {release}")
print(f"sticks where more than {states['with adhesion'].critical_fraction[0]:.1%} of the electrode is in contact last")

# %% [markdown]
# Every separation is in balance at one voltage. The plate leaves this path at its folds: at pull-in on the way down,
# at release on the way up.

# %%
switch = asp.switch_from_settings(with_adhesion, opening.rho_a_nm)
laws = {"with adhesion": opening, "without adhesion": replace(opening, hamaker=0.0, C_a_GPa_nm=0.0)}
h = np.geomspace(opening.d_c_nm - 3, switch.gap_nm, 4000)
figure, (whole, near) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
for (name, law), colour in zip(laws.items(), ("C0", "C1"), strict=True):
    squared = switch.voltage_squared(h, law, switch.last_share)
    voltage = np.sqrt(np.where(squared >= 0, squared, np.nan))
    state = states[name]
    for axes in (whole, near):
        axes.plot(h, voltage, color=colour, label=name)
    near.plot(state.release_nm, state.release_V, "v", color=colour, label=f"release at {state.release_V[0]:.2f} V")
state = states["with adhesion"]
whole.plot(state.pull_in_nm, state.pull_in_V, "k^", label=f"pull-in at {state.pull_in_V[0]:.1f} V")
whole.set(xscale="log", ylim=(0, 1.1 * state.pull_in_V[0]), title="from contact to rest")
near.set(xlim=(h[0], 40), ylim=(0, 6), title="near contact")
for axes in (whole, near):
    axes.set(xlabel="mean separation (nm)", ylabel="voltage (V)")
    axes.legend()
figure.savefig("switch.png", dpi=120)
