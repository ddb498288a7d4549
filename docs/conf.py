"""Settings of the documentation site; built by bin/docs."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

PROJECT = Path(__file__).parents[1]
sys.path.insert(0, str(PROJECT))

from castx.version import __version__  # noqa: E402
from docs.generator import api, verification  # noqa: E402

project = "castx"
highlight_language = "text"  # indented blocks of docstrings are formulas
copyright = "the castx authors, LGPL-3.0-or-later"
release = __version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx.ext.mathjax",
    "docs.generator.sphinx_extension",
]
exclude_patterns = ["_build"]
api.write_pages()
verification.write_list()

myst_enable_extensions = ["dollarmath", "amsmath", "deflist", "attrs_inline"]
myst_heading_anchors = 4
autodoc_member_order = "bysource"
suppress_warnings = ["ref.python"]  # the same short name in two rooms, in a type
autodoc_typehints_format = "short"
autodoc_type_aliases = {
    name: name for name in ("FloatArray", "BoolArray", "IntArray", "LongArray")
}
python_use_unqualified_type_names = True
maximum_signature_line_length = 88
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False
napoleon_attr_annotations = False  # those of case-file descriptions hold their checks
toc_object_entries = False

html_theme = "furo"
html_title = f"castx {release}"
html_static_path = ["static"]
html_css_files = ["castx.css"]
html_show_sphinx = False
html_copy_source = False

# One file with all glyphs: nothing is loaded from a network when the site is looked at.
_mathjax = importlib.util.find_spec("sphinx-mathjax-offline")
html_static_path.append(str(Path(_mathjax.origin).parent / "static/mathjax/tex-svg-full.js"))
mathjax_path = "tex-svg-full.js"
mathjax3_config = {"options": {"enableMenu": False}}
