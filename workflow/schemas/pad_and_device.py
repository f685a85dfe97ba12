"""Tables of pads and of the switch."""

from mesoscale.settings.definitions import RMS_SCATTER
from mesoscale.settings.device import SPREAD, unit_of
from workflow.schemas.inputs_and_law import BRANCH, INPUT_VALUES
from workflow.schemas.table import Table, boolean, number, text

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
    Table(
        ("device/budget.csv",),
        "One effect on the release of the switch at central inputs.",
        (
            text("effect", "its name"),
            number("volts", "V", "by how much it moves the release; empty: not known", empty=True),
            text("about", "what the volts stand for"),
            text("how", "computed here, by literature, a condition of the answer, or unknown"),
            boolean("held", "whether the interval of the release holds it"),
            text("settle", "what would settle it"),
            text("source", "where the volts come from"),
        ),
    ),
    Table(
        ("device/failure.csv",),
        "One hold voltage with one law of attraction.",
        (
            number("hold_V", "V", "hold voltage"),
            number("attraction", "1", "factor on the attraction"),
            number("failing", "1", "probability of a failure by the response"),
            number(
                "failing_q95", "1", "share that fails of one batch, at most, with 95 % confidence"
            ),
            number("failing_sure", "1", "the same with 90 % confidence"),
        ),
    ),
    Table(
        ("device/circuit.csv",),
        "One switch for circuit simulators: a corner, or a draw of the joint distribution.",
        (
            text("switch", "name of its model in device/circuit"),
            number(
                "deviations",
                "1",
                "standard deviations from the central inputs to a corner; 0 for a draw",
            ),
            *INPUT_VALUES,
            number(
                RMS_SCATTER.name,
                RMS_SCATTER.unit,
                f"{RMS_SCATTER.label} of the film",
                optional=True,
            ),
            number("gap_cutoff_nm", "nm", "D0 of its pad"),
            *(
                number(name, unit_of(name), f"device.{name} of its electrode")
                for name in SPREAD
                if name != "tilt_nm"
            ),
            number("pull_in_V", "V", "pull-in voltage"),
            number("release_V", "V", "release voltage (0: stuck)"),
        ),
    ),
    Table(
        ("device/humidity.csv",),
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
    Table(
        ("device/loop.csv",),
        "One voltage of the slow loop: capacitance while it rises and while it falls.",
        (
            number("voltage_V", "V", "voltage"),
            *(
                number(f"{way}_{name}_fF", "fF", f"capacitance on the way {way}, {of}")
                for way in ("up", "down")
                for name, of in (
                    ("central", "central switch"),
                    ("q05", "5 % of the draws"),
                    ("q95", "95 % of the draws"),
                )
            ),
        ),
    ),
)
