"""Tables of the topography stage's study."""

from workflow.schemas.table import Column, Table, boolean, integer, number, text


def _recovered(name: str, unit: str, error: str) -> tuple[Column, ...]:
    return (
        number(f"{name}_true", unit, f"{name} that the scans were made with"),
        number(name, unit, f"estimate of {name}", empty=True),
        number(f"{name}_low", unit, "lower end of its interval", empty=True),
        number(f"{name}_high", unit, "upper end of its interval", empty=True),
        number(f"{name}_error", unit if error == "absolute" else "1", f"{error} error of the estimate", empty=True),
        boolean(f"{name}_within", "whether the error is within its tolerance", empty=True),
        boolean(f"{name}_covered", "whether the interval holds the truth", empty=True),
    )


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
    Table(
        ("topography/recovery.csv", "topography/recovery/sets_*.csv"),
        "One set of synthetic scans, analysed by one method.",
        (
            integer("set", "number of the set"),
            text("method", "likelihood or lines"),
            number("tip_radius_nm", "nm", "radius of the tip that scanned"),
            number("told_tip_radius_nm", "nm", "radius that the analysis was told"),
            text("gate", "why the result fails its gate", empty=True),
            *_recovered("q0", "1/nm", "relative"),
            *_recovered("slope", "1", "absolute"),
            *_recovered("rms", "nm", "relative"),
        ),
    ),
)
