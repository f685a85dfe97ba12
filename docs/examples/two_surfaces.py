# %% [markdown]
# # Two surfaces
#
# A second map is the counterface. Here a ball with waves meets a flat with waves, and the walls
# attract by a law of your own. The surfaces come together by stated distances, not by loads.

# %%
import numpy as np

import asperity as asp

pixels, side_nm, radius_nm = 128, 200.0, 1000.0
x = (np.arange(pixels) + 0.5) * side_nm / pixels - side_nm / 2
distance = np.hypot(x[:, None], x)
ball = -(distance**2) / (2 * radius_nm)
waves_along_x = 0.1 * np.cos(2 * np.pi * x / 10)[:, None] * np.ones(pixels)
waves_along_y = waves_along_x.T


def attraction(gap_nm):
    """Pressure (GPa) between walls at a gap."""
    return 0.2 / (6 * np.pi * (gap_nm + 0.3) ** 3)


pressed = asp.press(
    ball + waves_along_x,
    side_nm,
    loads_nN=None,
    e_star=100.0,
    approach_nm=[0.2, 0.4, 0.8],
    counterface=waves_along_y,
    attraction=attraction,
    periodic=False,
)
print("\n".join(pressed.lines()))
print("attraction:", ", ".join(f"{force:.0f} nN" for force in pressed.attraction_nN))
pressed.plot().savefig("two_surfaces.png", dpi=120)
# %% [markdown]
# The crests of both sides meet in a pattern of spots, not in one disc.
