"""What the model leaves out."""

LIMITS = (
    "Adhesion: the law's attraction is several times the measured dry adhesion of such surfaces (C_a ρ_a²/2 is "
    "about 80 µJ/m² at the middle of the paper's Table 1 and 250 on average over it; measured are 5 to 30 µJ/m²), "
    "because it acts down to gaps of 0.165 nm beside every contact. Stiction and release voltage inherit this; "
    "device.adhesion_scale: 0.1 shows the other end.",
    "True contact area: asperities are found by cutting the surface with a plane (bearing area), which "
    "overestimates the true area of contact.",
    "Elastic coupling: each asperity is pressed on its own; its neighbours do not give way with it. Scene "
    "elastic_coupling measures what that costs.",
    "Surface slope: the RMS slope is set by the shortest waves that the grid resolves. It is 0.91 at the paper's "
    "mean inputs, and would be 4.4, unphysical, with the profile convention (the paper's 2H+1 on a "
    "two-dimensional spectrum).",
    "Few asperities: at the paper's mean inputs four to forty of them carry a square micrometre, and C_r and ρ_r "
    "differ much from one surface to the next. First contact is an extreme value: a pad of many square micrometres "
    "begins to touch at a larger separation than one of them (target extremes).",
    "Time: no creep, unless the scene asks for it (history). The results hold for contacts shorter than the time "
    "over which asperities creep.",
    "No liquid films, no charging of the dielectric, no sliding.",
    "The switch is a lumped plate on a spring; the landed fraction stands for all that a bowed or tilted beam does.",
)
