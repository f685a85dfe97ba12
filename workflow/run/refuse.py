"""How a run is refused: one line a mistake, before any job starts."""

import sys
from typing import NoReturn

from asperity.guards.foreign_text import shown


def refuse(mistakes: object) -> NoReturn:
    """End with an ERROR line for each line of `mistakes`."""
    for line in str(mistakes).splitlines():
        print(f"ERROR {shown(line)}", file=sys.stderr)
    sys.exit(1)
