"""Tables of repeated closing."""

from mesoscale.law.parameters import LAW
from workflow.schemas.columns import SEED
from workflow.schemas.table import Table, boolean, integer, number, text

TABLES = (
    Table(
        ("history/cycles.csv",),
        "One cycle of one surface.",
        (
            SEED,
            integer("cycle", "number of the cycle, from 1"),
            number("held_s", "s", "time under load so far"),
            number("first_contact_nm", "nm", "separation of first contact"),
            number("closed_nm", "nm", "separation at the end of the hold"),
            number("last_contact_nm", "nm", "separation of last contact"),
            number("contact_area_nm2", "nm²", "contact area at the end of closing"),
            number("dissipated_nN_nm", "nN nm", "energy dissipated, creep included"),
            number("pull_off_nN", "nN", "largest net attraction on opening"),
            *(
                number(f"opening_{row.name}", row.unit, f"{row.meaning}, on opening", empty=True)
                for row in LAW
            ),
            text("opening_status", "ok, or why the fit of the opening is poor or missing"),
            boolean("converged", "whether the cycle and its hold converged"),
        ),
    ),
    Table(
        ("history/dwell.csv",),
        "One time of one hold.",
        (
            SEED,
            integer("cycle", "number of the cycle, from 1"),
            number("held_s", "s", "time under load so far"),
            number("hardness_factor", "1", "hardness relative to that without time under load"),
            number("separation_nm", "nm", "mean separation"),
            number("contact_area_nm2", "nm²", "contact area"),
            integer("asperities", "asperities in contact"),
        ),
    ),
)
