"""Tables of the elastic stage."""

from workflow.schemas.table import Column, Table, boolean, integer, number, text

_SCAN: tuple[Column, ...] = (
    text("structure", "name of the structure"),
    text("xc", "exchange and correlation: GGA or LDA"),
    text("ions", "clamped: every bond scales with the cell"),
    integer("atoms", "atoms in the cell"),
)
_NETWORK: tuple[Column, ...] = (
    number("density_g_cm3", "g/cm³", "density"),
    number("coordination_*", "1", "mean coordination number of an element"),
    number("shortest_*_A", "Å", "shortest distance between two elements"),
    number("bond_spread_A", "Å", "standard deviation of the bond lengths"),
    integer("symmetry_operations", "that map the cell onto itself; one, the identity, in a glass"),
    integer("defects", "atoms without their valence"),
)

TABLES = (
    Table(
        ("elastic/points.csv", "elastic/scans/*.csv"),
        "One volume of an E(V) scan.",
        (
            *_SCAN,
            number("strain", "1", "isotropic strain of every edge"),
            number("volume_A3", "Å³", "volume of the cell"),
            number("energy_eV", "eV", "energy of the cell; nan where the calculation failed"),
            boolean("converged", "whether the calculation converged"),
            number("wall_s", "s", "run time"),
            text("detail", "why it failed", empty=True),
        ),
    ),
    Table(
        ("elastic/bulk_moduli.csv",),
        "The equation of state fitted to one scan.",
        (
            *_SCAN,
            number("B_GPa", "GPa", "bulk modulus (Birch–Murnaghan)", empty=True),
            number("B_prime", "1", "its derivative by pressure", empty=True),
            number("V0_A3", "Å³", "equilibrium volume of the cell", empty=True),
            number("B_vinet_GPa", "GPa", "bulk modulus by Vinet's form", empty=True),
            number(
                "B_error_GPa", "GPa", "standard error of B by the misfit of the fit", empty=True
            ),
            number(
                "residual_meV",
                "meV",
                "root mean square deviation of the energies from the fit",
                empty=True,
            ),
            integer("points", "volumes used"),
            text("flags", "why the fit is not trusted", empty=True),
            text("failed", "volumes that did not converge, and why", empty=True),
        ),
    ),
    Table(
        ("elastic/quenched/*.csv",),
        "One attempt to melt and quench a cell.",
        (
            text("structure", "name of the structure"),
            integer("attempt", "number of the attempt, from 0"),
            *_NETWORK,
            text("status", "accepted, or rejected: why"),
        ),
    ),
    Table(
        ("elastic/structures.csv",),
        "One relaxed amorphous structure.",
        (
            text("structure", "name of the structure"),
            integer("atoms", "atoms in the cell"),
            *_NETWORK,
            integer("steps", "ionic steps of the relaxation"),
            number("force_left_eV_A", "eV/Å", "largest force left", empty=True),
            boolean("converged", "whether the forces met their goal"),
            number("energy_gained_eV", "eV", "energy below the quenched cell", empty=True),
            number("gap_eV", "eV", "gap between occupied and empty levels", empty=True),
            text("failure", "why the calculation failed", empty=True),
            integer("quenches", "attempts to quench it"),
            text("status", "accepted, or rejected: why"),
        ),
    ),
)
