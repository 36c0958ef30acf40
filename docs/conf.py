"""How Sphinx builds this site; `make docs` runs it. Nothing here needs a network."""

import re
import sys
from pathlib import Path

from sphinx.application import Sphinx

import gearmesh

sys.path.insert(0, str(Path(__file__).parent / "_extensions"))

project = "gearmesh"
author = "the gearmesh authors"
project_copyright = author
version = release = gearmesh.__version__

extensions = [
    "mathml",
    "subscripts",
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
]
exclude_patterns = ["_build"]
templates_path = ["_templates"]

# Pages: Markdown with equations. The code of a page runs when the page is built, in an empty
# folder, and a cell that fails ends the build.
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
nb_execution_mode = "force"
nb_execution_show_tb = True
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 180
nb_merge_streams = True
nb_render_markdown_format = "myst"

# Reference: made from the docstrings.
default_role = "code"  # `name` in a docstring is code
autodoc_default_options = {
    "members": True,
    "show-inheritance": True,
    "exclude-members": "model_config, model_post_init",  # of pydantic
}
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
autosummary_generate = True
suppress_warnings = ["ref.python"]  # a name in an annotation may belong to two modules
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False

# Appearance
html_theme = "furo"
html_title = f"gearmesh {version}"
html_math_renderer = "mathml"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False


def keep_bars(app: Sphinx, kind: str, name: str, obj: object, options: object, lines: list[str]):
    """Take |v| in a docstring as an absolute value, where reStructuredText sees a reference."""
    lines[:] = [re.sub(r"\|([^|`]+)\|", r"\\|\1\\|", line) for line in lines]


def setup(app: Sphinx) -> None:
    """Register what Sphinx calls for each docstring."""
    app.connect("autodoc-process-docstring", keep_bars)
