# Names that pyright takes as known everywhere: Snakemake puts `snakemake` into each script.
from typing import Any

snakemake: Any
