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
    contact = results.contact
    shortest = "that the cut-off q₁ leaves"
    if contact.get("q1_per_nm") is None:
        shortest = "that the grid resolves"
    of_model = [*_ASPERITY]
    if results.coupled:
        of_model = [*_COUPLED]
    if contact.get("mechanics") == "coupled":
        of_model.append(_UNDEFORMED)
    if contact.get("mechanics") == "coupled" and contact.get("attraction") == "clamped":
        of_model.append(_CLAMPED)
    is_humid = contact.get("air") or results.span_of("humidity")
    no_water = "" if is_humid else ", no water between the walls"
    return [
        (
            "The law of attraction is a choice, not a measurement: the first screen shows the"
            " release by both laws."
        ),
        *of_model,
        f"The RMS slope is set by the shortest waves {shortest}.",
        (
            "Only few asperities carry a square micrometre, so the law of one cell differs much"
            " between surfaces."
        ),
        f"No creep unless the scene asks for it (history); no charging, no sliding{no_water}.",
    ]
