"""An executed notebook as a page of the report that needs neither scripts nor a network."""

from pathlib import Path

import nbformat
from nbconvert import HTMLExporter
from pygments.formatters import HtmlFormatter

from gearmesh.data.paths import WHY
from gearmesh.report.presentation import environment


def notebook_page(path: Path) -> str:
    """Return an executed notebook as HTML.

    Parameters
    ----------
    path : Path
        The executed notebook.
    """
    exporter = HTMLExporter(
        template_name="basic",
        exclude_input_prompt=True,
        exclude_output_prompt=True,
        exclude_anchor_links=True,
    )
    body, _ = exporter.from_notebook_node(nbformat.read(path, as_version=4))
    template = environment().get_template("notebook.html.j2")
    light, dark = (
        HtmlFormatter(style=style).get_style_defs(".highlight") for style in ("default", "monokai")
    )
    return template.render(
        name=path.stem,
        title=_title(path.stem),
        body=_scrollable(body),
        highlighting=light,
        dark_highlighting=dark,
    )


def _title(name: str) -> str:
    """Return the title of what a notebook draws."""
    return "Why it jumps" if name == WHY else f"Fig. {name.removeprefix('fig')}"


def _scrollable(body: str) -> str:
    """Let code and tables that are wider than the page be scrolled, by keyboard too."""
    box = '<div class="scroll" tabindex="0" role="region" aria-label="Table">'
    body = body.replace("<table", f"{box}<table").replace("</table>", "</table></div>")
    return body.replace('<div class="highlight', '<div tabindex="0" class="highlight')
