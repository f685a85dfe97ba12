"""Which closing runs a scene asks for (imports nothing heavy: the workflow reads it)."""

from dataclasses import dataclass
from typing import Any

from atomistic.settings import AsperitySettings, ClosingSettings, HardnessSettings

SCALE_NAMES = {1.0: "full", 0.5: "halved"}


@dataclass(frozen=True)
class ClosingRun:
    """What distinguishes one closing run."""

    name: str
    asperity: AsperitySettings
    seed: int
    energy_scale: float


def planned_runs(settings: HardnessSettings) -> list[ClosingRun]:
    """Every asperity x seed x energy scale of the settings."""
    return [
        ClosingRun(f"{asperity.name}_seed{seed}_{SCALE_NAMES.get(scale, f'x{scale:g}')}", asperity, seed, scale)
        for asperity in settings.asperities
        for seed in settings.seeds
        for scale in settings.energy_scales
    ]


def settings_of_run(run: ClosingRun, settings: HardnessSettings) -> dict[str, Any]:
    """Settings that plan exactly this run, with only what it depends on, as plain values."""
    return {
        **settings.model_dump(mode="json", include={"material", "closing", "area", "plasticity"}),
        "asperities": [run.asperity.model_dump()],
        "seeds": [run.seed],
        "energy_scales": [run.energy_scale],
    }


def needs_counter_glass(settings: HardnessSettings) -> bool:
    """Is the counterface of another oxide than the asperity, or of another potential's glass?"""
    closing = settings.closing
    another = closing.counter_potential is not None or closing.counter_material != settings.material
    return closing.counterface in ("oxide", "asperity") and another


def geometry(closing: ClosingSettings, amplitude_nm: float, shape: str) -> str:
    """What is pressed against what, in words."""
    body = {"sinusoidal": "asperity", "pyramidal": "pyramid"}[shape] if amplitude_nm else "flat"
    words = f"{body}-{closing.counterface}"
    if closing.counterface in ("oxide", "asperity"):
        words += f" {closing.counter_material} {closing.interface}"
    return words if closing.control == "speed" else f"{words}, force"
