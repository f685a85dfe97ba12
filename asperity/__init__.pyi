from asperity.film import Contact, Film, Switch
from asperity.press import PressedMap, press
from mesoscale.contact import Branch, ContactInputs, Cycle, run_cycle
from mesoscale.contact.energy import dissipated_energy, work
from mesoscale.contact.surface import random_surface
from mesoscale.errors import InputError
from mesoscale.extras import MissingExtra
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import input_table
from mesoscale.law.branches import laws_of
from mesoscale.law.compact import Law, force, pressure
from mesoscale.scan_checks.surface import contacting_heights
from mesoscale.settings import ContactSettings, DeviceSettings, InputRow, PadSettings, TopographySettings
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.uncertainty.runs import MonteCarlo, monte_carlo

__all__ = [
    "Branch",
    "Contact",
    "ContactInputs",
    "ContactSettings",
    "Cycle",
    "DeviceSettings",
    "Film",
    "InputError",
    "InputRow",
    "InputTable",
    "Law",
    "MissingExtra",
    "MonteCarlo",
    "PadSettings",
    "PressedMap",
    "Scan",
    "Switch",
    "TopographySettings",
    "clean",
    "contacting_heights",
    "dissipated_energy",
    "force",
    "input_table",
    "laws_of",
    "monte_carlo",
    "press",
    "pressure",
    "random_surface",
    "run_cycle",
    "work",
]
