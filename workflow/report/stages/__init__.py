"""What the page says about each stage: its text, figures, tables and files.

Every module offers `describe(results) -> Section | None`; None where the scene has no results of
the stage.
"""

from workflow.report.stages import (
    answer,
    budget,
    calibration,
    circuit,
    contact,
    elastic,
    failure,
    hardness,
    history,
    humidity,
    inputs,
    law,
    lifetime,
    pad,
    sensitivity,
    topography,
    uncertainty,
)

PARTS = (
    ("budget", "What it costs in volts", (budget,)),
    ("switch", "The switch", (answer, pad, humidity, circuit, failure, lifetime, history)),
    ("contact", "The contact", (contact, law, uncertainty, sensitivity)),
    ("from", "What goes in", (inputs, calibration, hardness, elastic, topography)),
)
