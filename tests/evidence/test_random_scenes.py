"""A small campaign of `evidence.attacks.scenes`, its seed stated before the first run: 741129."""

import json
import os
import subprocess
import sys

from asperity.guards.bundle import ROOT

SEED, COUNT = 741129, 40
# in a process of its own: Snakemake keeps what it has read
CAMPAIGN = f"""
import json
from pathlib import Path
from evidence.attacks.scenes import scenes
print(json.dumps([(a.outcome, a.words) for a in scenes(Path.cwd(), {SEED}, {COUNT})]))
"""


def test_random_scenes_are_planned_or_refused_in_lines_that_name_the_file(tmp_path):
    places = {"PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", CAMPAIGN],
        cwd=tmp_path,
        env=os.environ | places,
        capture_output=True,
        text=True,
        check=True,
    )
    attacks = json.loads(done.stdout.splitlines()[-1])
    assert len(attacks) == COUNT
    assert not [words for outcome, words in attacks if outcome == "fault"]
    assert sum(outcome == "used" for outcome, _ in attacks) >= COUNT / 8  # else it shows little
