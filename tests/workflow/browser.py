"""A page in a real browser: a script is appended to it and says in `<pre id="probe">` what it
found.
"""

import html
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
WATCH = """<script>window.failures = [];
window.addEventListener("error", (event) => failures.push(event.message));
window.addEventListener("unhandledrejection",
  (event) => failures.push(String(event.reason)));</script>"""


def probed(
    page: str, folder: Path, width: int, probe: str, budget_ms: int = 3000, dark: bool = False
) -> tuple[dict[str, Any], str]:
    """What the script `probe` finds in the page at a window `width` pixels wide, and what the
    browser says.
    """
    if CHROMIUM is None:
        pytest.skip("no Chromium is installed (Debian package chromium)")
    path = folder / "report.html"
    # the page allows no script; its copy here allows that of the test
    allowed = page.replace(
        "default-src 'none';", "default-src 'none'; script-src 'unsafe-inline';", 1
    )
    watched = allowed.replace("<style>", WATCH + "<style>", 1).replace(
        "</body>", f"<script>{probe}</script></body>"
    )
    # in a frame, as the browser's own window cannot be as narrow as a phone
    frame = (
        f'<iframe width="{width}" height="900" style="border: 0"'
        f' srcdoc="{html.escape(watched)}"></iframe>'
    )
    path.write_text(f"<!doctype html><body>{frame}</body>")
    options = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        f"--user-data-dir={folder / 'profile'}",
    ]
    options += [
        "--enable-logging=stderr",
        f"--virtual-time-budget={budget_ms}",
        "--window-size=1400,900",
    ]
    options += ["--disable-background-networking"]
    options += ["--blink-settings=preferredColorScheme=0"] if dark else []
    done = subprocess.run(
        [CHROMIUM, *options, "--dump-dom", path.as_uri()],
        capture_output=True,
        text=True,
        timeout=120,
    )
    found = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, flags=re.DOTALL)
    assert found, done.stderr[-2000:]
    return json.loads(html.unescape(found[1])), done.stderr
