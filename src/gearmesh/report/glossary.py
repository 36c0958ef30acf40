"""The glossary of the documentation as a section of the report, which needs no network."""

import re
from collections.abc import Iterator

from markupsafe import Markup, escape

from gearmesh.report.presentation import typeset

_PART = re.compile(r"^## (.+?)\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)
_LIST = re.compile(r"^:::\{glossary\}\n(.*?)^:::$", re.MULTILINE | re.DOTALL)


def parts(text: str) -> Iterator[tuple[str, list[tuple[Markup, Markup]]]]:
    """Yield each part of a glossary: its title, and its terms with their explanations.

    Parameters
    ----------
    text : str
        Markdown with lists of terms, as Sphinx reads it: an explanation is indented.
    """
    for title, body in _PART.findall(text):
        terms: list[tuple[str, list[str]]] = []
        for line in "".join(_LIST.findall(body)).splitlines():
            if line.startswith(" "):
                terms[-1][1].append(line.strip())
            elif line:
                terms.append((line, []))
        yield title, [(_html(term), _html(" ".join(lines))) for term, lines in terms]


def _html(text: str) -> Markup:
    """Return a line of Markdown as HTML: code stays as it is, symbols are set as in print."""
    pieces = text.split("`")
    shown = [typeset(piece) for piece in pieces[::2]]
    shown = [Markup(re.sub(r"\*(\w+)\*", r"<em>\1</em>", str(piece))) for piece in shown]
    code = [Markup(f"<code>{escape(piece)}</code>") for piece in pieces[1::2]]
    return Markup("").join(
        piece for pair in zip(shown, [*code, Markup("")], strict=True) for piece in pair
    )
