"""Table of the switch against humidity."""

from workflow.schemas.table import Table, number, text

TABLES = (
    Table(
        ("humidity/humidity.csv",),
        "One humidity and limit of opening: the switch at central inputs, and the points nearest to"
        " this humidity.",
        (
            number("humidity", "1", "relative humidity"),
            text(
                "opening", "balance: menisci in balance with the vapour; volume: their volume stays"
            ),
            number(
                "reach_nm",
                "nm",
                "gap below which there is liquid; 0: none, it would be thinner than a molecule",
            ),
            number("release_V", "V", "release voltage at central inputs (0: stuck)", empty=True),
            number("error_V", "V", "its error by the number of cells", empty=True),
            number(
                "energy_mJ_m2",
                "mJ/m^2",
                "work per area that opens the pad from its deepest closing",
                empty=True,
            ),
            number("pull_off_kPa", "kPa", "largest net attraction on the way", empty=True),
            number(
                "stuck",
                "1",
                "share of the points that stick; by the opening of the scene",
                empty=True,
            ),
            number("stuck_low", "1", "lower end of its 95 % interval", empty=True),
            number("stuck_high", "1", "upper end", empty=True),
            number("points", "1", "points nearest to this humidity", empty=True),
        ),
    ),
)
