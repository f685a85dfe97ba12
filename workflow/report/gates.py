"""Which numbers can be trusted, and what the model leaves out."""

from workflow.report.available import Results, Row, number, show
from workflow.report.page import Gate

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


def gates(results: Results) -> list[Gate]:
    """Gates of all stages with their reasons."""
    found = []
    for stage, name in (
        ("hardness", "hardness/fit.json"),
        ("elastic", "elastic/e_star.json"),
        ("topography", "topography/parameters.json"),
    ):
        if results.has(name):
            gate = results.json(name).get("gate", {})
            found.append(Gate(stage, bool(gate.get("passed")), tuple(gate.get("reasons", ()))))
    if results.has("curves/nominal.h5"):
        facts = results.h5("curves/nominal.h5")[2]
        bad = [name for name, each in facts.items() if "/" not in name and not bool(each.get("converged", True))]
        found.append(Gate("curves", not bad, tuple(f"{name}: some load steps did not converge" for name in bad)))
    if results.has("law/parameters.csv"):
        found.append(_law_gate(results.csv("law/parameters.csv")))
    if results.has("device/switch.json"):
        switch = results.json("device/switch.json")
        errors = switch["checks"].items()
        off = [f"{name.replace('_', ' ')} {show(value)}" for name, value in errors if not number(value) < 1e-6]
        found.append(Gate("device", not off, (*off, *switch["warnings"])))
    return found


def _law_gate(rows: list[Row]) -> Gate:
    counts: dict[str, int] = {}
    for row in rows:
        status = row.get("status", "ok").partition(":")[0]
        counts[status] = counts.get(status, 0) + 1
    bad = {status: count for status, count in counts.items() if status != "ok"}
    reasons = [f"{count} of {len(rows)} fits: {status.replace('_', ' ')}" for status, count in sorted(bad.items())]
    missing = sum(count for status, count in bad.items() if status != "poor_fit")
    return Gate("law", missing <= 0.05 * len(rows), reasons)
