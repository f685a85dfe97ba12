"""Numerical choices of a pad, fixed by their measured errors (target `accuracy`, docs/pad.md); no
scene sets them.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class PadNumerics:
    """How a pad is computed.

    Attributes
    ----------
    first_seed : of the surface of a pad's first cell.
    load_power : the load of a place grows about as this power of its RMS height: so places are
        drawn.
    step_rms, longest_step_nm : step of separation in and near contact, in units of the RMS height,
        and the longest.
    place_step_rms, longest_place_step_nm : step of a cell in units of the RMS height of its own
        place, times that over
        the median place's, where this is longer than the pad's; and the longest, since wells are a
        nanometre wide. With 0.04 at all places wells are passed over, and `reduced` lets go 0.1 V
        too high.
    depths : depths of closing from which a pad is opened, at loads in even ratios up to the
        largest. With 4 the
        releases of `paper` are 0.5 V too low, since wells of single cells move with the depth; more
        than 8 move them by 0.1 V.
    grown : steps where only rough places touch, in units of their RMS height: release is that of
        half of it to 1e-6 V.
    far_nm, far_points : beyond, the attraction of the pad is that of two flats to 1 %: 1 + 6 (rms /
        separation)^2; and
        separations up to there.
    bridged : separations at which liquid bridges sites that do not touch.
    light : part of the largest load from which the pad is opened at least; a flat electrode presses
        with 0.3 to 0.4 of
        it.
    merged : share of what is wanted from which on repulsion must not fall by this share: by chance
        it falls by 15 % at
        most, where asperities of smooth films merge by 30 to 50 %.
    most_pilot_steps : of the cells that find the range of separations.
    margin : over what the switch presses with: the mean of the few pilot cells is off by 15 %.
    pilot_step : pilot cells are closed in coarser steps than the pad: where the grid ends need not
        be known to better
        than that.
    fewest_pilot_steps : where fewer reach the pressure, all steps are finer: a film of long waves
        is closed by little
        of its RMS height.
    kernel : of first contacts, times their deviation and the number of cells to the power -1/5
        (Silverman, Density
        Estimation, 1986, eq. 3.28). Without it releases of `paper` are 0.3 V too low, with 0.8 of
        the deviation a pad of wide scatter sticks that does not.
    shifts : of a cell, equally likely.
    deepened : separations below the deepest closing of a pad that is continued.
    memory_depths, memory_rises : of the table of a pad for beams: deepest closings between those
        that were computed,
        8 nm in steps of 0.1 nm, and separations above them.
    highest_rise_nm : beyond, closing and opening are the same attraction, but for coarse films.
    coarse_nm : shallowest depth of a coarse film. Those of scene `paper` are 90 nm at most: its
        tables stay so.
    same : difference of closing and opening, over the largest repulsion, below which they are the
        same: 1 Pa of 10 MPa,
        the accuracy of a beam's balance.
    """

    first_seed: int = 1000
    load_power: float = 3.0
    step_rms: float = 0.04
    longest_step_nm: float = 0.2
    place_step_rms: float = 0.01
    longest_place_step_nm: float = 0.8
    depths: int = 8
    grown: float = 2.0
    far_nm: float = 200.0
    far_points: int = 24
    bridged: int = 20
    light: float = 0.02
    merged: float = 0.25
    most_pilot_steps: int = 4000
    margin: float = 1.25
    pilot_step: float = 5.0
    fewest_pilot_steps: int = 3
    kernel: float = 1.06
    shifts: int = 9
    deepened: int = 20
    memory_depths: int = 96
    memory_rises: int = 1200
    highest_rise_nm: float = 60.0
    coarse_nm: float = 120.0
    same: float = 1e-7

    def step_nm(self, rms_nm: float) -> float:
        """Step of separation in and near contact on surfaces of this RMS height."""
        return min(self.step_rms * rms_nm, self.longest_step_nm)


PAD = PadNumerics()
"""What every scene uses."""
