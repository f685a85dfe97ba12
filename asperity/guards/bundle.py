"""Where the workflow, its scenes and its data lie: inside an installed package, or in the
checkout.
"""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]
ROOT = _PACKAGE / "_bundle" if (_PACKAGE / "_bundle").is_dir() else _PACKAGE.parent
"""Folder that holds `Snakefile`, `workflow/` and `config/`."""
