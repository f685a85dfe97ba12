"""Which closing runs a scene asks for (imports nothing heavy: the workflow reads it)."""

from dataclasses import dataclass

from atomistic.settings import AsperitySettings, HardnessSettings

SCALE_NAMES = {1.0: "full", 0.5: "halved"}


@dataclass(frozen=True)
class ClosingRun:
    """What distinguishes one closing run."""

    name: str
    asperity: AsperitySettings
    seed: int
    energy_scale: float

    @property
    def glass(self) -> int:
        """Seed of the glass it is cut from."""
        return self.seed


def planned_runs(settings: HardnessSettings) -> list[ClosingRun]:
    """Every asperity x seed x energy scale of the settings."""
    return [
        ClosingRun(f"{asperity.name}_seed{seed}_{SCALE_NAMES.get(scale, f'x{scale:g}')}", asperity, seed, scale)
        for asperity in settings.asperities
        for seed in settings.seeds
        for scale in settings.energy_scales
    ]


def run_named(name: str, settings: HardnessSettings) -> ClosingRun:
    """The run of a name that `planned_runs` gave (its seed and energy scale need not be in `settings`)."""
    asperity_name, seed, scale_name = name.split("_")
    asperity = next(asperity for asperity in settings.asperities if asperity.name == asperity_name)
    scales = {label: scale for scale, label in SCALE_NAMES.items()}
    scale = scales[scale_name] if scale_name in scales else float(scale_name.removeprefix("x"))
    return ClosingRun(name, asperity, int(seed.removeprefix("seed")), scale)
