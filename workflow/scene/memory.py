"""Memory that a contact needs, and that this machine has.  Imports little: every job reads it."""

from mesoscale.memory import SITE_MB
from mesoscale.settings import HistorySettings, SceneContact, UncertaintySettings
from mesoscale.settings.history import DWELL_STEPS, SURFACES
from mesoscale.settings.uncertainty import RESAMPLES

PROCESS_MB = 600.0  # a job is two processes with their packages


def contact_MB(contact: SceneContact, surfaces: int = 1) -> int:
    """Memory of a process that closes and opens so many contacts side by side, in MB."""
    return round(PROCESS_MB + surfaces * SITE_MB[contact.mechanics] * contact.pixels**2)


def history_MB(history: HistorySettings, contact: SceneContact) -> int:
    """Memory of the process that closes and opens again and again, in MB."""
    held = DWELL_STEPS + 1 if history.dwell_s > 0 else 0
    row_MB = 1.4e-3  # as it is made and written; that of a cycle is as long as three
    return round(contact_MB(contact) + row_MB * SURFACES * history.cycles * (3 + held))


def propagation_MB(uncertainty: UncertaintySettings) -> int:
    """Memory of the process that fits the responses to all direct runs and resamples these, in
    MB.
    """
    # a direct run in regressions (4000 to 10,000 take 26 MB, a row 1.5 kB) and in each resampling
    # (of 10,000 runs)
    run_MB = 6e-3 + 32e-6 * RESAMPLES
    return round(PROCESS_MB + run_MB * uncertainty.direct_runs)
