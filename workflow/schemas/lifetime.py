"""Tables of the life of a switch."""

from workflow.schemas.table import Table, number, text

GUESS = text("guess", "least, central, most: charge by what is not known of the rates")
ENDS = {"q05": "5 %", "q50": "median", "q95": "95 %"}
TABLES = (
    Table(
        ("lifetime/lifetime.csv",),
        "One guess of the rates and one time of hold: the central switch, and all devices.",
        (
            GUESS,
            number("time_s", "s", "time of hold; 0: before any"),
            number("shift_V", "V", "even shift of the central switch, with the sign of the drive"),
            number("uneven_V", "V", "what it feels of uneven charge 4 nm above its hold, U"),
            number("pull_in_V", "V", "its pull-in voltage"),
            number("release_V", "V", "its release voltage (0: stuck)"),
            *(
                number(f"{name}_{end}_V", "V", f"{meaning}, {words} of the devices")
                for name, meaning in (
                    ("shift", "even shift"),
                    ("pull_in", "pull-in voltage"),
                    ("release", "release voltage"),
                )
                for end, words in ENDS.items()
            ),
            number("stuck", "1", "share of the devices that stick"),
            number("lost", "1", "share of the devices that open by themselves while held"),
        ),
    ),
    Table(
        ("lifetime/rates.csv",),
        "One draw of the rates after a measured drift; no row if the chain has not converged.",
        (
            number("injection_A_m2", "A/m^2", "current that stays where it touches, at 1 MV/cm"),
            number("barrier_eV", "eV", "barrier of emission"),
            number("traps_e_cm2", "1/cm^2", "most charge that the surface holds"),
            number("recovery_exponent", "1", "exponent by which charge leaks in a rest"),
            number("activation_eV", "eV", "energy by which injection grows with temperature"),
            number("log_likelihood", "1", "logarithm of the likelihood of the drift"),
        ),
    ),
    Table(
        ("lifetime/holds.csv",),
        "One guess of the rates and one hold voltage, at the end of the life.",
        (
            GUESS,
            number("hold_V", "V", "voltage that holds the central switch; others in proportion"),
            number("shift_V", "V", "its even shift at the end"),
            number("sticking", "1", "share that sticks, by a normal tail"),
            number("lost", "1", "share that opens by itself, by a normal tail"),
            number(
                "time_to_1V_s", "s", "time to a shift of 1 V; empty: beyond 10^12 s", empty=True
            ),
        ),
    ),
    Table(
        ("lifetime/ageing.csv",),
        "One effect of ageing, one guess and one time of hold; the central switch without charge.",
        (
            text("effect", "beam, tops, bonds: alone; all: together"),
            GUESS,
            number("time_s", "s", "time of hold; 0: before any"),
            number(
                "strength",
                "1",
                "relaxed share of the stress of the beam, lost share of the hardness of the tops,"
                " or work of bonds in mJ/m^2 of what touches; empty: all",
                empty=True,
            ),
            number("pull_in_V", "V", "pull-in voltage"),
            number("release_V", "V", "release voltage (0: stuck)"),
        ),
    ),
)
