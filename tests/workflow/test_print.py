"""The page on paper: no heading without what follows it, no page that is half empty."""

import re
import shutil
import subprocess

import numpy as np
import pytest
from PIL import Image

from tests.workflow.browser import CHROMIUM

FULLNESS = 0.5  # of a sheet that has something on it, but for the last one
DOTS_PER_INCH = 24


@pytest.fixture(scope="module")
def printed(page_of, tmp_path_factory):
    """Headings and captions of the page, its text and its picture sheet by sheet."""
    if CHROMIUM is None:
        pytest.skip("no Chromium is installed (Debian package chromium)")
    if not (shutil.which("pdftoppm") and shutil.which("pdftotext")):
        pytest.skip("no pdftoppm and pdftotext are installed (Debian package poppler-utils)")
    folder = tmp_path_factory.mktemp("print")
    page = page_of("made_up")
    (folder / "report.html").write_text(page)
    pdf = folder / "report.pdf"
    options = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        f"--user-data-dir={folder / 'profile'}",
    ]
    options += ["--no-pdf-header-footer", f"--print-to-pdf={pdf}"]
    subprocess.run(
        [CHROMIUM, *options, (folder / "report.html").as_uri()],
        capture_output=True,
        timeout=120,
        check=True,
    )
    subprocess.run(
        ["pdftoppm", "-r", str(DOTS_PER_INCH), "-gray", pdf, folder / "sheet"], check=True
    )
    text = subprocess.run(
        ["pdftotext", "-layout", pdf, "-"], capture_output=True, text=True, check=True
    ).stdout
    headings = {
        re.sub(r"<[^>]*>", "", words)
        for words in re.findall(r"<h[23][^>]*>(.*?)</h[23]>", page, re.DOTALL)
    }
    sheets = [np.asarray(Image.open(path)) for path in sorted(folder.glob("sheet*.pgm"))]
    return headings, text.rstrip("\f").split("\f"), sheets


def test_no_heading_is_left_alone_at_the_end_of_a_sheet(printed):
    headings, texts, _ = printed
    assert len(texts) <= 5  # the budget alone takes more than one
    last = [text.rstrip().rpartition("\n")[2].strip() for text in texts[:-1]]
    plain = {re.sub(r"\W", "", words) for words in headings}
    assert [line for line in last if re.sub(r"\W", "", line) in plain] == []


def test_no_sheet_is_half_empty(printed):
    _, texts, sheets = printed
    assert len(sheets) == len(texts)
    ends = [
        np.flatnonzero((sheet < 250).any(axis=1)).max() / sheet.shape[0] for sheet in sheets[:-1]
    ]
    assert [
        (number, round(float(end), 2)) for number, end in enumerate(ends, start=1) if end < FULLNESS
    ] == []
