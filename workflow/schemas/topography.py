"""Tables of the topography stage."""

from workflow.schemas.table import Table, boolean, number, text

TABLES = (
    Table(
        ("topography/judged.csv",),
        "A measured scan pressed, beside surfaces made from a description of the surface.",
        (
            text("scan", "name of the scan"),
            text("description", "power_law, measured_spectrum or measured_heights"),
            boolean("left_out", "whether the description was made without this scan"),
            text("quantity", "rms, first_contact, separation at 1 and 7 uN on a cell, area at 7 uN"),
            text("unit", "nm or nm^2"),
            number("in_contact", "1", "share of the scan in contact at that load; 0 for rms and first_contact"),
            number("pressed", "nm or nm²", "of the scan itself"),
            number("median", "nm or nm²", "of the described surfaces"),
            number("low", "nm or nm²", "lower end of the 90 % interval for one more surface"),
            number("high", "nm or nm²", "upper end of it"),
            boolean("inside", "whether the scan is inside"),
        ),
    ),
    Table(
        ("topography/unseen.csv",),
        "What the waves beyond those that instruments show do to random surfaces of the contact.",
        (
            text("quantity", "first_contact, area at the largest force, C_r of closing, pull_off"),
            text("unit", "nm, nm^2, GPa or nN"),
            number("seen_q", "1/nm", "where the trusted spectra surely end"),
            number("end_q", "1/nm", "where the surfaces end: at q1, at what the grid holds"),
            number("seen", "its unit", "mean of surfaces that end at seen_q", empty=True),
            number("all", "its unit", "mean of surfaces that end at end_q, of the same noise", empty=True),
            number("shift", "1", "relative change by the unseen waves", empty=True),
            number("share", "1", "share of the variance, beside that between surfaces", empty=True),
        ),
    ),
)
