"""What the model leaves out."""

from workflow.report.available import Results

_ASPERITY = (
    "Contact area is where a plane cuts the surface, which overestimates it.",
    "Each asperity is pressed on its own. On opening this is too compliant (docs/contact.md).",
)
_COUPLED = ("Flowed volume is not kept: the rim that it would make carries no load.",)
_UNDEFORMED = (  # python -m evidence contact.adhesion, pad.answers
    "Attraction does not deform the contact. Over Table 1 this overestimates its pull-off by 15%"
    " [10%, 18%]; on a small pad of scene reduced the release moves by less than 0.1 V."
)
_CLAMPED = "With the clamped law the pull-off of flattened tops is an upper bound."


def limits(results: Results) -> list[str]:
    """What a reader must know before using the numbers."""
    shortest = (
        "that the grid resolves"
        if results.contact.get("q1_per_nm") is None
        else "that the cut-off q₁ leaves"
    )
    undeformed = results.contact.get("mechanics") == "coupled"
    return [
        (
            "The law of attraction is a choice, not a measurement: the first screen shows the"
            " release by both laws."
        ),
        *(_COUPLED if results.coupled else _ASPERITY),
        *([_UNDEFORMED] if undeformed else []),
        *([_CLAMPED] if undeformed and results.contact.get("attraction") == "clamped" else []),
        f"The RMS slope is set by the shortest waves {shortest}.",
        (
            "Only few asperities carry a square micrometre, so the law of one cell differs much"
            " between surfaces."
        ),
        (
            "No creep unless the scene asks for it (history); no liquid films, no charging, no"
            " sliding."
        ),
    ]
