"""The curves of figures 4 and 11: models compared, and one surface closed to rising loads."""

from collections.abc import Callable, Iterator

from mesoscale.contact.cycle import Cycle, run_cycle
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import NOMINAL_FORCE_NN, NOMINAL_LOADS_NN, NOMINAL_SEED

MODELS = ("elastic", "nonlinear", "plastic")


def nominal_cycles(
    inputs: ContactInputs,
    settings: ContactSettings,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[tuple[str, ContactSettings, float, Cycle]]:
    """Yield name, settings, largest force (nN) and cycle of each nominal curve.

    Named by model for figure 4 (`NOMINAL_FORCE_NN`), and ``load_<F>`` for figure 11
    (`NOMINAL_LOADS_NN`, with the model of the settings). One surface for all.
    """
    plan = [
        (model, settings.model_copy(update={"model": model}), NOMINAL_FORCE_NN) for model in MODELS
    ]
    plan += [(f"load_{force:.12g}", settings, force) for force in NOMINAL_LOADS_NN]
    for done, (name, chosen, force) in enumerate(plan):
        yield name, chosen, force, run_cycle(inputs, chosen, NOMINAL_SEED, force)
        if progress is not None:
            progress((done + 1) / len(plan), name)
