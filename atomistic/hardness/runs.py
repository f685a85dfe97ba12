"""Which closing runs a scene asks for, and what all have in common (imports nothing heavy)."""

from asperity.guards.settings import Settings
from atomistic.settings import AsperitySettings, HardnessSettings


class ClosingRun(Settings):
    """What distinguishes one closing run."""

    name: str
    asperity: AsperitySettings
    seed: int
    energy_scale: float


class Protocol(Settings):
    """What all closings have in common, fixed before any hardness; evidence and tests vary it.

    Attributes
    ----------
    timestep_fs : over the square root of the energy scale: softer bonds vibrate more slowly.
    temperature_K : of the closing; the anneal of the cut surface is hotter (times the energy
        scale).
    base_over_contact : thickness of the base over the largest contact; thinner is felt (study
        `hardness.choices`).
    frozen_nm, thermostat_nm : thickness of the rigid bottom, and of the Langevin layer above it.
    wall_stiffness_eV_A3 : K of a flat, F = K depth^2, times the energy scale.
    depth_over_amplitude : largest travel below the highest atom, in amplitudes.
    approach_nm : clearance at the start; bonds exchanged on this way are the background.
    averaged_travel_A, samples : travel over which area and force are averaged, snapshots of an
        average.
    segment_nm : travel between restart files.
    segments_per_snapshot : segments between relaxed snapshots; the first two frame one segment
        before contact.
    """

    timestep_fs: float = 3.0
    temperature_K: float = 300.0
    anneal_temperature_K: float = 1000.0
    base_over_contact: float = 1.0
    frozen_nm: float = 0.5
    thermostat_nm: float = 0.7
    wall_stiffness_eV_A3: float = 10.0
    depth_over_amplitude: float = 2.2
    approach_nm: float = 0.1
    averaged_travel_A: float = 0.25
    samples: int = 5
    segment_nm: float = 0.1
    segments_per_snapshot: int = 1

    def snapshots(self, segments: int) -> list[int]:
        """After which segments the body is relaxed: before and after the first, then regularly."""
        return [0, *range(1, segments + 1, self.segments_per_snapshot)]


PROTOCOL = Protocol()


def slowed(protocol: Protocol, factor: float) -> Protocol:
    """The protocol with a shorter time step, for bodies whose bonds vibrate faster."""
    return protocol.model_copy(update={"timestep_fs": factor * protocol.timestep_fs})


def planned_runs(settings: HardnessSettings) -> list[ClosingRun]:
    """Every asperity x seed x energy scale; films and their base at full energies only.

    A base keeps its energies, and oxide with halved ones is no harder than titanium: no effect of a
    film would be left.
    """
    names = {1.0: "full", 0.5: "halved"}
    return [
        ClosingRun(
            name=f"{asperity.name}_seed{seed}_{names.get(scale, f'x{scale:g}')}",
            asperity=asperity,
            seed=seed,
            energy_scale=scale,
        )
        for asperity in settings.asperities
        for seed in settings.seeds
        for scale in settings.scales_of(asperity)
        if asperity.film_nm is None or scale == 1.0
    ]
