"""What is wrong with a scene beyond its single keys: contradictions, and what no machine can carry.

Everything here is known before the first job. Imports the table of the inputs (half a second): for
the main process.
"""

import math
from collections.abc import Iterator, Mapping

from mesoscale.checks import machine_MB
from mesoscale.contact.menisci import water_vapour_kPa
from mesoscale.errors import InputError
from mesoscale.inputs.table import check_literature
from mesoscale.settings import DeviceSettings
from mesoscale.settings.contact import AirSettings, advised_grid, base_modulus
from mesoscale.settings.definitions import BY_NAME
from workflow.scene.definition import Scene
from workflow.scene.memory import contact_MB


def mistakes(scene: Scene, samples: Mapping[str, str]) -> list[str]:
    """What contradicts physics, another key or the machine; a line each, which begins with the key.

    Parameters
    ----------
    samples : files of samples by the name of their input, as found.
    """
    return [*_inputs(scene, samples), *_stages(scene), *_machine(scene)]


def _inputs(scene: Scene, samples: Mapping[str, str]) -> Iterator[str]:
    rows = scene.inputs.rows(scene.contact.attraction)
    for name in rows:
        section, _, field = BY_NAME[name].setting.rpartition(".")
        stated = getattr(scene.contact, section) if section else scene.contact
        if stated and field in stated.model_fields_set:
            yield (
                f"contact.{BY_NAME[name].setting} and inputs.{name} give the same number; leave"
                " one out"
            )
    located = {
        name: rows[name].model_copy(update={"values": path}) for name, path in samples.items()
    }
    try:
        spans = check_literature(scene.inputs.model_copy(update=located))
    except InputError as error:
        yield str(error)
        return
    if "h_film" in spans and spans["h_film"][0] < (base := spans["h_macro"][1]):
        yield (
            f"inputs.h_film reaches down to {spans['h_film'][0]:g} GPa, inputs.h_macro of its base"
            f" up to {base:g}: films softer than their base are not modelled; correct one of them"
        )
    if spans.get("t_film", (1.0, 1.0))[1] == 0.0:
        yield (
            "inputs.t_film = 0: without a film take inputs.hardness: paper, and null for all"
            " numbers of the film"
        )
    bodies, (lowest, highest) = scene.contact.bodies, spans.get("e_star", (0.0, math.inf))
    if bodies and not lowest / 1.25 <= (bases := base_modulus(bodies)) <= 1.25 * highest:
        yield (
            f"contact.bodies: their bases have E* = {bases:.4g} GPa, inputs.e_star reaches from"
            f" {lowest:g} to {highest:g}; e_star is that of the bases: correct one of them"
        )
    side, nyquist = scene.contact.length_nm, scene.contact.nyquist_per_nm
    low, high = spans.get("q0", (math.inf, 0.0))
    if low < 2 * math.pi / side:
        yield (
            f"inputs.q0 reaches down to {low:g} 1/nm, a roll-off wavelength of"
            f" {2 * math.pi / low:.3g} nm in a cell of contact.length_nm = {side:g}: too small for"
            " its roll-off; take a longer side or a larger q0"
        )
    if high > nyquist:
        yield (
            f"inputs.q0 reaches {high:g} 1/nm, beyond what the grid resolves ({nyquist:.3g} 1/nm:"
            " pi contact.pixels / contact.length_nm); take more pixels, a smaller side or a"
            " smaller q0"
        )
    if scene.contact.mechanics == "adhesive" and math.isfinite(lowest):
        cutoff, _ = spans.get("gap_cutoff", (scene.contact.gap_cutoff_nm, math.inf))
        _, hamaker = spans.get("hamaker", (0.0, 0.0))
        # one site yields by 4 ln(1 + sqrt 2) / pi of its side over E*; the attraction changes by 3
        # s / D0 at most
        needed = (
            hamaker
            / (2 * math.pi * cutoff**4)
            * side
            * 4
            * math.log(1 + math.sqrt(2))
            / (math.pi * lowest)
        )
        if needed > scene.contact.pixels:
            yield (
                f"contact.mechanics = adhesive: D0 down to {cutoff:g} nm and A_H up to {hamaker:g}"
                " aJ fall off faster than the grid resolves; take"
                f" {advised_grid(math.ceil(needed))}a larger D0 or mechanics: coupled"
            )


def _stages(scene: Scene) -> Iterator[str]:
    uncertainty = scene.uncertainty
    needed = 2 * len(scene.inputs.rows())
    if uncertainty.direct_runs < needed:
        yield (
            f"uncertainty.direct_runs = {uncertainty.direct_runs}: a regression over {needed // 2}"
            f" inputs needs at least {needed}; give more"
        )
    if scene.history.cycles and scene.contact.model != "plastic":
        yield (
            f"contact.model = {scene.contact.model} with history.cycles = {scene.history.cycles}:"
            " only plastic contacts have a history; choose contact.model: plastic"
        )
    device = scene.device
    side_um = scene.contact.length_nm / 1000
    yield from _too_few_points(scene)
    if line := _no_such_air(scene):
        yield line
    if device.area_um2 < side_um**2 and not scene.cell_follows_film:
        yield (
            f"device: an electrode of {device.area_um2:g} um^2 (length_um times width_um) is"
            f" smaller than one cell of {side_um:g} um (contact.length_nm); take a larger electrode"
            " or a smaller cell"
        )
    if line := _no_switch(device):
        yield line
    synthetic = scene.topography.synthetic
    if "topography" in scene.stages() and not (
        scene.topography.scans or synthetic.small_scans or synthetic.large_scans
    ):
        yield (
            "topography.scans: empty, and synthetic.small_scans and large_scans are 0: nothing to"
            " analyse; give scans"
        )


def _too_few_points(scene: Scene) -> Iterator[str]:
    """A line on points too few to tell causes apart: for a curve of second degree each, a constant,
    and one over.
    """
    inputs = (
        sum(row.distribution != "fixed" for row in scene.inputs.rows().values())
        + scene.unequal_places
    )
    needed = 2 * (inputs + ("gap_cutoff" not in scene.inputs.rows()) + len(scene.device.varied)) + 2
    if 0 < scene.pad.points < needed:
        yield (
            f"pad.points = {scene.pad.points}: {needed // 2 - 1} inputs and properties of the"
            " device vary, whose parts in the spread so few points cannot tell apart; accepted are"
            f" 0 (no interval) or at least {needed}"
        )


def _no_such_air(scene: Scene) -> str:
    """One line on vapour of more pressure than the gas around the switch has; empty where it has
    less.
    """
    row = scene.inputs.rows().get("humidity")
    air = scene.contact.air or AirSettings()
    gas = scene.device.gas_kPa
    humidity = (row.reaches or 0.0) if row else air.humidity
    if (
        air.surface_tension_mN_m is not None
        or (vapour := humidity * water_vapour_kPa(air.temperature_C)) <= gas
    ):
        return ""
    return (
        f"device.gas_kPa = {gas:g}: air of {humidity:.0%} humidity has {vapour:.3g} kPa of vapour"
        f" alone at {air.temperature_C:g} C; a vacuum is dry: raise gas_kPa or lower the humidity"
    )


def _no_switch(device: DeviceSettings) -> str:
    """One line on a device that is no switch; empty where nothing is known against it."""
    shares = {"electrode", "contact"}
    unusual = shares | {
        "hold_voltage_V",
        "residual_stress_MPa",
        "temperature_C",
        "ends",
        "stopper_nm",
        "dimple_nm",
        "spread",
        "measured",
        "shift_V",
        "charge_e_cm2",
        "uneven",
    }
    if device.touching_at_rest or not unusual & device.model_fields_set:
        return device.touching_at_rest
    from mesoscale.answer.spread import check_spread
    from mesoscale.switch import switch_of  # takes a second

    try:
        check_spread(device)
        return switch_of(device).never_closes
    except InputError as error:
        return str(error)


def _machine(scene: Scene) -> Iterator[str]:
    pixels = scene.contact.pixels
    needed = contact_MB(scene.contact)
    present = machine_MB()
    if needed > present:
        yield (
            f"contact.pixels = {pixels}: a contact needs {needed / 1000:.1f} GB of memory, this"
            f" machine has {present / 1000:.1f}; take fewer pixels"
        )
