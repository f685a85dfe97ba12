# Snakemake puts this name into every script; pyright reads it here.
from typing import Any

snakemake: Any
