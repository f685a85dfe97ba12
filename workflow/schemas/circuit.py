"""Tables of the switch for circuit simulators."""

from mesoscale.settings.definitions import RMS_SCATTER
from mesoscale.settings.device import EVEN_CHARGE, SPREAD, unit_of
from workflow.schemas.columns import INPUT_VALUES
from workflow.schemas.table import Table, number, text

TABLES = (
    Table(
        ("circuit/circuit.csv",),
        "One switch for circuit simulators: a corner, or a draw of the joint distribution.",
        (
            text("switch", "name of its model in circuit/models"),
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
                number(
                    name,
                    unit_of(name),
                    f"device.{name} of its electrode",
                    optional=name in EVEN_CHARGE,
                )
                for name in SPREAD
                if name != "tilt_nm"
            ),
            number("pull_in_V", "V", "pull-in voltage"),
            number("release_V", "V", "release voltage (0: stuck)"),
        ),
    ),
    Table(
        ("circuit/loop.csv",),
        (
            "One voltage of the slow loop: capacitance while it rises and while it falls. With even"
            " charge, voltages of both polarities, each from 0 outwards and back."
        ),
        (
            number("voltage_V", "V", "voltage"),
            *(
                number(
                    f"{direction}_{name}_fF", "fF", f"capacitance on the way {direction}, {meaning}"
                )
                for direction in ("up", "down")
                for name, meaning in (
                    ("central", "central switch"),
                    ("q05", "5 % of the draws"),
                    ("q95", "95 % of the draws"),
                )
            ),
        ),
    ),
)
