from mesoscale.contact import Branch, ContactInputs, Cycle, run_cycle
from mesoscale.contact.energy import dissipated_energy, work
from mesoscale.contact.surface import random_surface
from mesoscale.device.switch import SwitchStates, drive_switch, switch_from_settings
from mesoscale.errors import InputError
from mesoscale.extras import MissingExtra
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import input_table
from mesoscale.law.branches import laws_of
from mesoscale.law.compact import Law, force, pressure
from mesoscale.scan_checks.pressing import contacting_heights
from mesoscale.settings import ContactSettings, DeviceSettings, InputRow, LawSettings, TopographySettings
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.measurements.loading import load_scan
from mesoscale.topography.summary import measure_roughness
from mesoscale.uncertainty.runs import MonteCarlo, monte_carlo

__all__ = [
    "Branch",
    "ContactInputs",
    "ContactSettings",
    "Cycle",
    "DeviceSettings",
    "InputError",
    "InputRow",
    "InputTable",
    "Law",
    "LawSettings",
    "MissingExtra",
    "MonteCarlo",
    "Scan",
    "SwitchStates",
    "TopographySettings",
    "clean",
    "contacting_heights",
    "dissipated_energy",
    "drive_switch",
    "force",
    "input_table",
    "laws_of",
    "load_scan",
    "measure_roughness",
    "monte_carlo",
    "pressure",
    "random_surface",
    "run_cycle",
    "switch_from_settings",
    "work",
]
