"""The page before a run ends: the switch at central inputs, with what it is made of. The report
takes its place.
"""

from pathlib import Path
from typing import Any

from mesoscale.answer.release import switch_on_pad
from mesoscale.answer.switches import PadModel
from workflow.report.available import Results
from workflow.report.render import render

STATUS = (
    "this page was made during the run, whose end renews it (start the run again if it was stopped)"
)
"""True also after a run that was stopped or killed, which writes no other page."""


def early_page(
    root: Path, paths: list[str], central: PadModel, cell_area_nm2: float, scene: dict[str, Any]
) -> str:
    """HTML of the page, from finished files in results/<scene>, the pad at central inputs, sections
    of the scene.
    """
    switch = switch_on_pad(central, cell_area_nm2) | {"answer_status": STATUS}
    at_hand = {"answer/pad_switch.json": switch, "scene.yaml": {"scene": scene}}
    return render(Results(root, paths, root.name, at_hand))
