"""The page before a run ends: the switch at central inputs, with what it is made of. The report takes its place."""

from pathlib import Path
from typing import Any

from mesoscale.device.points import PadModel
from mesoscale.device.release import switch_on_pad
from mesoscale.settings import ContactSettings, DeviceSettings
from workflow.report.available import Results
from workflow.report.render import render

STATUS = "the run goes on; its end renews this page"


class _AtHand(Results):
    """Finished files, and what no file has yet."""

    def __init__(self, root: Path, paths: list[str], central: PadModel, contact: ContactSettings) -> None:
        super().__init__(root, paths, root.name)
        switch = switch_on_pad(central, contact.length_nm**2) | {"answer_status": STATUS}
        self._switch, self._central, self._contact = {"device/pad_switch.json": switch}, central.central, contact

    def has(self, *names: str) -> bool:
        return super().has(*(name for name in names if name not in self._switch))

    def json(self, name: str) -> dict[str, Any]:
        return self._switch[name] if name in self._switch else super().json(name)

    @property
    def contact(self) -> dict[str, Any]:
        return self._contact.model_dump(mode="json", exclude={"surface"})

    @property
    def device(self) -> DeviceSettings:
        return self._central.point.device


def early_page(root: Path, paths: list[str], central: PadModel, contact: ContactSettings) -> str:
    """HTML of the page.

    Parameters
    ----------
    root : results/<scene>.
    paths : finished files below it.
    central : the pad at central inputs alone.
    contact : of its cells.
    """
    return render(_AtHand(root, paths, central, contact))
