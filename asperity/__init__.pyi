from asperity.film import Film as Film
from asperity.film import FilmContact as FilmContact
from asperity.film import Switch as Switch
from asperity.own_map import Roughness as Roughness
from asperity.own_map import cycle as cycle
from asperity.own_map import roughness as roughness
from asperity.pressed_map import PressedMap as PressedMap
from asperity.pressed_map import press as press
from mesoscale import theory as theory
from mesoscale.contact import Branch as Branch
from mesoscale.contact import ContactInputs as ContactInputs
from mesoscale.contact import Cycle as Cycle
from mesoscale.contact import run_cycle as run_cycle
from mesoscale.contact.energy import dissipated_energy as dissipated_energy
from mesoscale.contact.energy import work as work
from mesoscale.contact.surface import random_surface as random_surface
from mesoscale.errors import InputError as InputError
from mesoscale.extras import MissingExtra as MissingExtra
from mesoscale.inputs.distributions import InputTable as InputTable
from mesoscale.inputs.table import input_table as input_table
from mesoscale.law.branches import laws_of as laws_of
from mesoscale.law.compact import Law as Law
from mesoscale.law.compact import force as force
from mesoscale.law.compact import pressure as pressure
from mesoscale.scan_checks.surface import contacting_heights as contacting_heights
from mesoscale.settings import (
    ContactSettings as ContactSettings,
)
from mesoscale.settings import (
    DeviceSettings as DeviceSettings,
)
from mesoscale.settings import (
    InputRow as InputRow,
)
from mesoscale.settings import (
    PadSettings as PadSettings,
)
from mesoscale.settings import (
    TopographySettings as TopographySettings,
)
from mesoscale.topography.measurements.cleaning import Scan as Scan
from mesoscale.topography.measurements.cleaning import clean as clean
from mesoscale.uncertainty.runs import MonteCarlo as MonteCarlo
from mesoscale.uncertainty.runs import monte_carlo as monte_carlo
