"""What a run needs beside Snakemake; with Snakemake alone, rules can be read and linted."""

from importlib.util import find_spec

NEEDED = ("h5py", "numba", "numpy", "scipy")


def missing_packages() -> list[str]:
    """Names of packages without which no job runs."""
    return [name for name in NEEDED if find_spec(name) is None]
