"""What the model leaves out."""

import numpy as np

from workflow.report.available import Results
from workflow.report.numbers import column, show

_ASPERITY = (
    "True contact area: asperities are found by cutting the surface with a plane (bearing area), which "
    "overestimates the true area of contact.",
    "Elastic coupling: each asperity is pressed on its own; its neighbours do not give way with it. On opening it is "
    "too compliant. Target model_form tells what coupling changes.",
)
_COUPLED = (
    "Attraction does not deform the contact. On opening it acts on flattened, conformal tops and reaches a large part "
    "of their hardness: take pull-off for an upper bound.",
)
_DROPPED = ("Flowed volume is not kept: the rim that it would make carries no load.",)


def limits(results: Results) -> list[str]:
    """What a reader must know before using the numbers, with the figures of this scene where they exist."""
    paper = results.beside_paper
    reading, coupled = results.contact, results.coupled
    shortest = "that the grid resolves" if reading.get("q1_per_nm") is None else "that the cut-off q₁ leaves"
    return [
        f"Adhesion: {_adhesion(results)}measured dry adhesion of such surfaces is 5 to 30 µJ/m². The law's attraction "
        "acts down to gaps of 0.165 nm beside every contact. Stiction and release voltage inherit this; "
        "device.adhesion_scale: 0.1 shows the other end.",
        *(_COUPLED if coupled else _ASPERITY),
        *(_DROPPED if coupled else ()),
        f"Surface slope: the RMS slope is set by the shortest waves {shortest}."
        + " It is 0.91 at the paper's mean inputs, and would be 4.4, unphysical, with the profile convention (the "
        "paper's 2H+1 on a two-dimensional spectrum)." * paper,
        "Few asperities: "
        + ("at the paper's mean inputs four to forty of them" if paper else "only few of them")
        + " carry a square micrometre, and C_r and ρ_r differ much from one surface to the next. First contact is an "
        "extreme value: a pad of many square micrometres begins to touch at a larger separation than one of them.",
        "Time: no creep, unless the scene asks for it (history). The results hold for contacts shorter than the time "
        "over which asperities creep.",
        "No liquid films, no charging of the dielectric, no sliding.",
        "The switch on one cell's law is a lumped plate on a spring that lands flat; the strip that comes off last "
        "stands for how a beam peels. The switch on the pad bends, place by place.",
    ]


def _adhesion(results: Results) -> str:
    """Energy of the law's short-ranged attraction at first contact, C_a ρ_a²/2."""
    if not results.has("uq/samples.csv", "uq/surrogate.json"):
        return ""
    rho_a = results.json("uq/surrogate.json")["law"]["rho_a_nm"]
    energy = column(results.csv("uq/samples.csv"), "closing_C_a_GPa_nm") * rho_a**2 / 2 * 1e6  # GPa nm = J/m²
    if not np.isfinite(energy).any():
        return ""
    return (
        f"C_a ρ_a²/2 of the law is {show(np.nanmean(energy), 2)} µJ/m² on average over this scene's inputs (median "
        f"{show(np.nanmedian(energy), 2)}); "
    )
