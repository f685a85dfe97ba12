"""Which files and closing runs the hardness stage of a scene has, and whether they fit together."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from asperity.guards.errors import InputError
from atomistic.hardness.runs import ClosingRun, planned_runs
from atomistic.materials import Material, oxide_glasses
from atomistic.settings import HardnessSettings


@dataclass(frozen=True)
class HardnessFiles:
    """Files that a scene's hardness section names, and its runs.

    Attributes
    ----------
    material, base : of the asperity, and of the body below films; None: there is none.
    closings : closing runs by name.
    """

    potential: str
    material: str
    base: str | None
    closings: dict[str, ClosingRun]


def hardness_files(
    settings: HardnessSettings,
    materials: Mapping[str, Material],
    config: Path,
    locate: Callable[[str], str],
) -> HardnessFiles:
    """Files and runs of a scene.

    Parameters
    ----------
    config : folder of the shipped data.
    locate : finds a file that the scene names by its path.

    Raises
    ------
    InputError : a name that is not known.
    """
    oxides = oxide_glasses(materials.values())
    bases = [name for name, material in materials.items() if material.film_base is not None]
    potential = settings.potential
    if potential.endswith((".yaml", ".yml")):
        potential = locate(potential)
    else:
        _known(
            "potential",
            potential,
            [path.stem for path in (config / "potentials").glob("*.yaml")],
            ", or a path",
        )
        potential = str(config / "potentials" / f"{potential}.yaml")
    _known("material", settings.material, oxides)
    if settings.base is not None:
        _known("base", settings.base, bases)
    folder = config / "materials"
    return HardnessFiles(
        potential,
        str(folder / f"{oxides[settings.material].name}.yaml"),
        None if settings.base is None else str(folder / f"{settings.base}.yaml"),
        {run.name: run for run in planned_runs(settings)},
    )


def check_bodies(
    settings: HardnessSettings, files: HardnessFiles, materials: Mapping[str, Material]
) -> dict[str, float]:
    """Refuse before the first job what it would refuse.

    That is a bad potential, one without a calibration of the contact area or without the material,
    and a film that does not fit its asperity or base.

    Returns
    -------
    Seconds of one core of each closing run, by its name.

    Raises
    ------
    InputError : of the first of them.
    """
    from atomistic.hardness.contact_area import calibrated  # jobs do without
    from atomistic.hardness.cost import closing_seconds
    from atomistic.hardness.stack import base_of, check_ions
    from atomistic.potentials import load_potential

    potential = load_potential(files.potential)
    calibrated(potential)
    base = None if settings.base is None else base_of(materials[settings.base])
    if base is not None:
        check_ions(base.material, potential.materials.get(settings.material, {}))
    return closing_seconds(settings, oxide_glasses(materials.values())[settings.material], base)


def _known(key: str, name: str, known: Iterable[str], more: str = "") -> None:
    if name not in (names := sorted(known)):
        raise InputError(
            f"hardness.{key} = {name!r:.60}: not known; known are {', '.join(names)}{more}"
        )
