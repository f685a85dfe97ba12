"""Numerical choices that files of the circuit models share, fixed by their measured errors
(docs/circuit.md); no scene sets them.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class CircuitNumerics:
    """How the switch is written for simulators."""

    start_nm: float = 200.0
    """Separation from which closing counts in Verilog-A: a pad is not in contact so far out."""

    follow_s: float = 1e-9
    """Time constant with which the state of a pad follows its deepest closing: much shorter than
    any motion."""

    settles_s: float = 5e-3
    """Time in which the beam of a slow switch at rest forgets a push: short beside a sweep of
    seconds, long beside what a pad takes to tear off."""

    leak: float = 1e-15
    """Conductance of the state over that of following: it falls by this share of itself per time
    constant."""

    of_well: float = 0.003
    """Error that tables may have beside the curves near the well, of the well."""

    of_net: float = 0.0005
    """The same elsewhere, of the net pressure."""

    near_wells: float = 10.0
    """Net pressures up to so many wells are near the well."""

    fade_nm: float = 5.0
    """So much above the shallowest depth a pad opens as it closed: it has not been in contact."""

    viscosity_Pa_s: float = 1.83e-5
    """Of air at 23 C."""

    free_path_nm_Pa: float = 67.3 * 101325.0
    """Mean free path in air at 23 C times the pressure (Jennings, J. Aerosol Sci. 19 (1988)
    159)."""

    least_film_nm: float = 1.0
    """Least thickness of the gas."""

    least_density: float = 1e-6
    """Least density of the gas over that around it: a step into nothing would not come back."""

    quality: float = 1e3
    """Of the first mode by losses in the electrode, an assumption. They grow with frequency: what
    rings fast dies."""

    release_error: float = 0.01
    """Allowed error of lumps beside the finite elements, of release and pull-in."""

    reference_elements: int = 1024
    """Finite elements that judge lumps. On a pad of few cells, which tears off in jerks, 512
    release up to 0.8 % off."""

    lump_counts: tuple[int, ...] = (8, 12, 16, 20, 24, 28, 32, 40, 48)
    """Numbers of pairs of lumps that are tried."""

    draws: int = 16
    """Points whose switches are written."""

    loop_top: float = 1.1
    """Largest voltage of the slow loop over the largest pull-in."""


CIRCUIT = CircuitNumerics()
"""What every scene uses."""
