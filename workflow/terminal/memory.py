"""Memory that a contact needs, and that this machine has.  Imports little: every job reads it."""

import psutil

from mesoscale.settings import ContactSettings, HistorySettings

PROCESS_MB = 600.0  # a job is two processes with their packages
SITE_MB = {"asperity": 62e-6, "coupled": 140e-6}  # 4096^2 sites take 1.1 GB, 1024^2 coupled ones 323 MB
ROW_MB = 1.4e-3  # a row of a history's table, as it is made and written


def contact_MB(contact: ContactSettings) -> int:
    """Memory of a process that closes and opens a contact, in MB."""
    return round(PROCESS_MB + SITE_MB[contact.mechanics] * contact.pixels**2)


def history_MB(history: HistorySettings, contact: ContactSettings) -> int:
    """Memory of the process that closes and opens again and again, in MB."""
    held = history.dwell_steps + 1 if history.dwell_s > 0 else 0
    return round(contact_MB(contact) + ROW_MB * history.seeds * history.cycles * (3 + held))  # a cycle's row is long


def machine_MB() -> int:
    """Memory of this machine, in MB."""
    return psutil.virtual_memory().total // 10**6
