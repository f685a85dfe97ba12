"""Files of a stranger that are none."""

import os


def is_of_the_system(path: str | os.PathLike[str]) -> bool:
    """Whether a file lies where Linux shows its own state: such seem ordinary, and some never end
    or wait for ever.
    """
    return os.path.realpath(path).startswith(("/proc/", "/sys/"))
