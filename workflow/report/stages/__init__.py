"""What the page says about each stage: its text, figures, tables, gates and files.

Every module offers `describe(results) -> Section | None`; None where the scene has no results of the stage.
`law` has no section: its curve opens the page, its fits and its gate belong to `contact`.
"""

from workflow.report.stages import (
    adhesion,
    calibration,
    contact,
    device,
    elastic,
    hardness,
    history,
    inputs,
    model_form,
    pad,
    sensitivity,
    topography,
    uncertainty,
)

# in the order of the data's flow
STAGES = (
    inputs,
    calibration,
    hardness,
    elastic,
    topography,
    contact,
    uncertainty,
    sensitivity,
    model_form,
    pad,
    adhesion,
    device,
    history,
)
