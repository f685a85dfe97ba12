"""Do rows of the budget say what finite differences say of the same change?

Each effect of `config/effects.yaml` that changes the beam is solved by the product and by a beam of
finite differences, written apart, on one made-up pad.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from asperity.guards.foreign_yaml import load_mapping
from evidence.record import ROOT
from evidence.switch import finite_differences
from mesoscale.answer.budget import changed_devices, effects_of
from mesoscale.studies.answer_stability import made_up_pad, published_beam
from mesoscale.switch import switch_of

CHANGES = (
    "anchors that give way",
    "anchors that turn",
    "etch holes",
    "length and undercut of the beam",
    "mean stress of the film",
    "stress by the package",
)
NODES = 399
TOLERANCE = 2e-4
"""Of a release by finite differences."""


def arguments(parser: ArgumentParser) -> None:
    """None: the pad is made up."""


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each effect and each of its changes."""
    path = ROOT / "config" / "effects.yaml"
    effects = effects_of(load_mapping(path, "table of effects"))
    pad = made_up_pad(40.0)
    device = published_beam()
    own = _releases(device, pad)
    for name in CHANGES:
        for other in changed_devices(effects[name], device, switch_of(device).pull_in_V):
            product_V, twin_V = _releases(other, pad)
            yield {
                "effect": name,
                "changes": effects[name].changes,
                "value": getattr(other, effects[name].changes),
                "moved_V": product_V - own[0],
                "differences_V": twin_V - own[1],
            }


def _releases(device: Any, pad: Any) -> tuple[float, float]:
    """Release by the product, and by finite differences."""
    twin_V = finite_differences.release(device, pad, NODES, TOLERANCE)[1]
    return switch_of(device).states(pad).release_V, twin_V


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Largest difference, and by how many effects."""
    apart = [abs(float(row["moved_V"]) - float(row["differences_V"])) for row in table]
    return {
        "effects": str(len({row["effect"] for row in table})),
        "most_apart": f"{max(apart):.2f} V",
    }
