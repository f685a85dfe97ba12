"""Memory that a contact needs, and that this machine has.  Imports little: every job reads it."""

import psutil

from mesoscale.settings import ContactSettings

PROCESS_MB = 600.0  # a job is two processes with their packages
SITE_MB = {"asperity": 62e-6, "coupled": 140e-6}  # 4096^2 sites take 1.1 GB, 1024^2 coupled ones 323 MB


def contact_MB(contact: ContactSettings) -> int:
    """Memory of a process that closes and opens a contact, in MB."""
    return round(PROCESS_MB + SITE_MB[contact.mechanics] * contact.pixels**2)


def machine_MB() -> int:
    """Memory of this machine, in MB."""
    return psutil.virtual_memory().total // 10**6
