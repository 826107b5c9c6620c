"""Sphinx configuration of the manual. Build it with scripts/docs."""

from __future__ import annotations

import importlib.util
import shutil
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
sys.path.insert(0, str(DOCS))

import generate  # noqa: E402

project = "drillpetsc"
author = "the drillpetsc developers"
copyright = "the drillpetsc developers"
release = version = generate.version()

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx_design",
    "sphinxcontrib.bibtex",
]
exclude_patterns = [
    "_build",
    "Thumbs.db",
    ".DS_Store",
    "**/README.md",
    "_generated/outputs/*",  # tables that guide/outputs.md includes
]

# Markdown
myst_enable_extensions = [
    "amsmath",
    "attrs_inline",
    "colon_fence",
    "deflist",
    "dollarmath",
    "fieldlist",
    "substitution",
]
myst_heading_anchors = 3
myst_dmath_double_inline = True
numfig = True
math_number_all = False
math_eqref_format = "({number})"
bibtex_bibfiles = ["references.bib"]
bibtex_default_style = "plain"

# Python
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
default_role = "code"  # single backticks in docstrings

# HTML
html_theme = "furo"
html_title = f"drillpetsc {release}"
html_static_path = ["_static"]
html_css_files = ["manual.css"]
html_theme_options = {"navigation_with_keys": True}
html_copy_source = False
pygments_style = "friendly"
pygments_dark_style = "monokai"
suppress_warnings = ["myst.header"]


# Formulas without a network: the package sphinx-mathjax-offline brings MathJax 3; without it the pages load
# MathJax from the web.
def _mathjax_folder() -> Path | None:
    spec = importlib.util.find_spec("sphinx-mathjax-offline")
    folder = Path(spec.origin).parent / "static" / "mathjax" if spec and spec.origin else None
    return folder if folder is not None and (folder / "tex-chtml.js").is_file() else None


MATHJAX = _mathjax_folder()
if MATHJAX is not None:
    mathjax_path = "mathjax/tex-chtml.js"


def copy_mathjax(app, exception) -> None:
    """Copy the parts of MathJax that the pages load (2 MB of 24 MB)."""
    if exception is not None or MATHJAX is None or app.builder.format != "html":
        return
    target = Path(app.outdir) / "_static" / "mathjax"
    fonts = Path("output") / "chtml" / "fonts" / "woff-v2"
    extensions_of_tex = Path("input") / "tex" / "extensions"
    target.mkdir(parents=True, exist_ok=True)
    shutil.copy2(MATHJAX / "tex-chtml.js", target)
    for part in (fonts, extensions_of_tex):
        if (MATHJAX / part).is_dir():
            shutil.copytree(MATHJAX / part, target / part, dirs_exist_ok=True)


def setup(app) -> None:
    """Write the generated pages before the sources are read."""
    generate.write(DOCS / "_generated")
    app.connect("build-finished", copy_mathjax)
