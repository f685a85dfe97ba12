"""The documentation site. `make docs` writes it to docs/_build/html, without network; every warning
is an error.
"""

import importlib.metadata
from pathlib import Path

import SurfaceTopography  # noqa: F401  (autodoc imports with TYPE_CHECKING set, which its pydantic models do not bear)

from evidence.pages import quoted, with_numbers, with_sources, write_pages

ROOT = Path(__file__).parents[1]
write_pages(ROOT / "docs" / "evidence")

project = "Asperity"
author = copyright = "The Asperity developers"
release = importlib.metadata.version("asperity-contact")

extensions = [
    "myst_nb",
    "sphinx.ext.apidoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx-mathjax-offline",  # equations without network
]
exclude_patterns = ["_build", "*.py", "api/*/modules.rst"]
html_theme = "furo"
html_title = "Asperity"
html_search_scorer = str(Path(__file__).with_name("search_order.js"))
default_role = "code"
myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]
NUMBERS = quoted()

# examples are Python scripts with cells, run while the site is built
nb_custom_formats = {".py": ["jupytext.reads", {"fmt": "py:percent"}]}
nb_execution_mode = "force"
nb_execution_raise_on_error = True
# seconds a cell: beside lint and tests, two cores are shared by seven processes
nb_execution_timeout = 600

# the API reference: a page per room and module. Settings have their own page, written from the same
# classes
apidoc_modules = [
    {
        "path": ROOT / package,
        "destination": f"api/{package}",
        "exclude_patterns": [str(ROOT / package / "settings")],
        "automodule_options": {"members"},
        "separate_modules": True,
        "module_first": True,
    }
    for package in ("mesoscale", "atomistic")
]
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
napoleon_use_ivar = True

suppress_warnings = [
    "ref.python",  # a short name such as `width` stands for the field at hand, not for a link
]


def collapse_navigation(app, pagename, templatename, context, doctree):
    """List beside a page its own branch, not all 200 pages of the API: most of the build's time
    went there.
    """
    if whole := context.get("toctree"):
        level = 'role="heading"', 'role="heading" aria-level="2"'  # which screen readers need
        context["toctree"] = lambda **options: (
            whole(**{**options, "collapse": True}) or ""
        ).replace(*level)


def tell_sources(app, docname, source):
    """Tell of each number where it is from; refuse a page whose numbers are of former studies."""
    if with_numbers(source[0], NUMBERS) != source[0]:
        raise ValueError(f"{docname}: numbers of former studies; python -m evidence numbers")
    source[0] = with_sources(source[0], NUMBERS)


def setup(app):
    app.connect("source-read", tell_sources)
    # before the theme's, which is 500
    app.connect("html-page-context", collapse_navigation, priority=400)
