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
            text(
                "quantity", "rms, first_contact, separation at 1 and 7 uN on a cell, area at 7 uN"
            ),
            text("unit", "nm or nm^2"),
            number(
                "in_contact",
                "1",
                "share of the scan in contact at that load; 0 for rms and first_contact",
            ),
            number("pressed", "nm or nm²", "of the scan itself"),
            number("median", "nm or nm²", "of the described surfaces"),
            number("low", "nm or nm²", "lower end of the 90 % interval for one more surface"),
            number("high", "nm or nm²", "upper end of it"),
            boolean("inside", "whether the scan is inside"),
        ),
    ),
)
