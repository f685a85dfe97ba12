"""Plan every target of every shipped scene in one process; prints rows of scene, target and the
refusal, if any.
"""

import contextlib
import io
import json
from collections.abc import Callable

from asperity.__main__ import targets
from asperity.guards.bundle import ROOT
from tests.workflow.planning import plan, read, silent_api


def refusal(plan: Callable[[], object]) -> str:
    """The last line that a plan wrote before it ended itself; empty where it stands."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            plan()
        except SystemExit:
            return said.getvalue().strip().splitlines()[-1]
    return ""


rows = []
with silent_api() as api:
    for scene in sorted(path.stem for path in (ROOT / "config" / "scenes").glob("*.yaml")):
        workflow = read(api, scene)
        rows += [
            (scene, target, refusal(lambda name=target, of=workflow: plan(of, {name})))
            for target in targets()
        ]
print(json.dumps(rows))
