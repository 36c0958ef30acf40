"""Symbols of the prose as they are set in print: y_st becomes y with the subscript st.

In the sources and on a terminal the underscore stays. Code is left alone.
"""

import re

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.transforms import SphinxTransform

SYMBOL = re.compile(r"(?<![\w.])([A-Za-zΑ-Ωα-ωℓ])_([A-Za-z]{1,4}\d?m?|\dm?)(?![\w(])")
CODE = (addnodes.desc_signature, nodes.FixedTextElement, nodes.literal, nodes.math, nodes.raw)


class Subscripts(SphinxTransform):
    """Set the subscripts of symbols in running text."""

    default_priority = 700

    def apply(self, **kwargs: object) -> None:
        """Split each text that holds a symbol."""
        for text in list(self.document.findall(nodes.Text)):
            if SYMBOL.search(text) and not _within_code(text):
                text.parent.replace(text, _split(str(text)))


def _within_code(node: nodes.Node) -> bool:
    while node := node.parent:
        if isinstance(node, CODE):
            return True
    return False


def _split(text: str) -> list[nodes.Node]:
    parts: list[nodes.Node] = []
    end = 0
    for match in SYMBOL.finditer(text):
        parts.append(nodes.Text(text[end : match.start()] + match[1]))
        parts.append(nodes.subscript("", match[2]))
        end = match.end()
    return [*parts, nodes.Text(text[end:])]


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the transform."""
    app.add_transform(Subscripts)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
