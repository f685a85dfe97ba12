"""Settings of the failure rate."""

from asperity.guards.settings import Settings, key


class FailureSettings(Settings):
    """Rate at which switches fail (docs/failure.md); off by default."""

    probability: float | None = key(
        None, "share of switches that may fail, such as 1e-6; null: not run", "(0, 1)"
    )
    release_V: float = key(
        0.0, "a switch still closed at this voltage has failed; 0: one that sticks", "[0, 1e5] V"
    )
