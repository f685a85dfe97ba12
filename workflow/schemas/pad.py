"""Table of the pad."""

from workflow.schemas.columns import BRANCH
from workflow.schemas.table import Table, number

TABLES = (
    Table(
        ("pad/curves.csv",),
        "One separation of one branch: the mean pressure of the cells.",
        (
            BRANCH,
            number(
                "depth_nm",
                "nm",
                "separation from which the pad is opened; empty on closing",
                empty=True,
            ),
            number("separation_nm", "nm", "separation"),
            number("repulsive_MPa", "MPa", "repulsive pressure"),
            number("attractive_MPa", "MPa", "attractive pressure (negative)"),
            number("net_kPa", "kPa", "sum of both"),
            number(
                "standard_error_kPa",
                "kPa",
                "standard error of net_kPa from the scatter of the cells",
            ),
        ),
    ),
)
