"""Numerical choices of the circuit models, fixed by their measured errors (docs/circuit.md); no
scene sets them.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class CircuitNumerics:
    """How the switch is written for simulators.

    Attributes
    ----------
    start_nm : separation from which closing counts in Verilog-A; a pad is not in contact so far
        out.
    begins : in SPICE it counts from so many times the separation at which a pad begins to repel.
    follow_s : time constant with which the state of a pad follows its deepest closing: much shorter
        than any motion.
    following_S : conductance of following in Verilog-A: large beside the 1e-12 S that simulators
        add to every node.
    memory_F : capacitance of the state in SPICE, whatever its time constant. With a slow memory a
        capacitance of its
        conductance drew kiloamperes at the landing, and ngspice shrank its steps to nothing.
    onset_nm : way over which following begins in SPICE. Where it began with a corner, ngspice ended
        as soon as a second
        lump came below `start_nm`: no step was small enough. A way of 0.1 nm forgets 0.05 nm of an
        impact.
    leak : its conductance over that of following: the state falls by this part of itself per time
        constant.
    of_well, of_net, of_pull : error that tables may have beside the curves: of the well and of the
        net pressure; far
        out, of the pull.
    near_wells : net pressures up to so many wells are near the well.
    reach_nm, most_folds : so far below its deepest closing the repulsion of a pad goes on to grow
        in SPICE, by so many
        e-folds at most.
    fade_nm : so much above the shallowest depth, a pad opens as it closed: it has not been in
        contact.
    faint : a push of this part of the shallowest well counts as none, so that its logarithm stays
        finite.
    viscosity_Pa_s, free_path_nm_Pa : of air at 23 C, the mean free path times the pressure
        (Jennings, J. Aerosol Sci.
        19 (1988) 159).
    least_film_nm, least_density : thickness of the gas, and its density over that around: no less,
        or a step into
        nothing would not come back.
    quality : of the first mode by losses in the electrode, an assumption. They grow with frequency:
        what rings fast
        dies.
    force_A : current of a pressure of 1 Pa on a lump: the `abstol` of a simulator is then small
        beside what moves it.
    slope_per_V : slope of the electrode of 1 V, so that a simulator's `vntol` is small beside
        slopes, too.
    release_error, capacitance_error : allowed errors of lumps beside the finite elements: of
        release and pull-in, and
        of the held capacitance.
    reference_elements : finite elements that judge lumps. On a pad of few cells, which tears off in
        jerks, 512 release
        up to 0.8 % off.
    lump_counts : numbers of lumps that are tried.
    draws : points whose switches are written.
    corner_cells : cells of the pad of a corner, which stands alone.
    corner_deviations : deviations of the corners, the first that can be solved.
    loop_voltages, loop_top : voltages of the slow loop, the largest over that of the largest
        pull-in.
    loop_elements : finite elements of the slow loop, the first with which all its balances are
        found.
    """

    start_nm: float = 200.0
    begins: float = 1.5
    follow_s: float = 1e-9
    following_S: float = 1e3
    memory_F: float = 1e-6
    onset_nm: float = 0.01
    leak: float = 1e-15
    of_well: float = 0.003
    of_net: float = 0.0005
    of_pull: float = 0.05
    near_wells: float = 10.0
    reach_nm: float = 20.0
    most_folds: float = 8.0
    fade_nm: float = 5.0
    faint: float = 1e-3
    viscosity_Pa_s: float = 1.83e-5
    free_path_nm_Pa: float = 67.3 * 101325.0
    least_film_nm: float = 1.0
    least_density: float = 1e-6
    quality: float = 1e3
    force_A: float = 1e-5
    slope_per_V: float = 1e-2
    release_error: float = 0.01
    capacitance_error: float = 0.03
    reference_elements: int = 1024
    lump_counts: tuple[int, ...] = (8, 12, 16, 20, 24, 28, 32, 40, 48)
    draws: int = 16
    corner_cells: int = 64
    corner_deviations: tuple[float, ...] = (2.0, 1.5, 1.0, 0.5)
    loop_voltages: int = 61
    loop_top: float = 1.1
    loop_elements: tuple[int, ...] = (128, 96, 160)


CIRCUIT = CircuitNumerics()
"""What every scene uses."""
