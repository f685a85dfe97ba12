"""The Tersoff potential as an ASE calculator: slow, but in-process."""

from ase.calculators.tersoff import Tersoff, TersoffParameters

from atomistic.covalent import tersoff_table


def tersoff_calculator(parameters):
    """A calculator with the parameters of a material's `network_glass`."""
    table = {}
    for line in tersoff_table(parameters).splitlines()[1:]:
        i, j, k, *numbers = line.split()
        table[(i, j, k)] = TersoffParameters(*map(float, numbers))
    return Tersoff(table)
