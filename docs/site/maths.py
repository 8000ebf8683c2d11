"""Formulas as MathML, which browsers draw themselves: by math-core, without a script.

The font is beside the style sheet.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from docutils import nodes
from math_core import LatexError, LatexToMathML
from sphinx.errors import ExtensionError
from sphinx.util.math import get_node_equation_number

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.writers.html5 import HTML5Translator

CONVERTER = LatexToMathML()


def setup(app: Sphinx) -> dict[str, bool]:
    """Take the place of ``sphinx.ext.mathjax``."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def mathml(source: str, as_block: bool) -> str:
    """Return the element ``<math>`` of a formula."""
    try:
        return CONVERTER.convert_with_local_state(source.strip(), displaystyle=as_block)
    except LatexError as error:
        raise ExtensionError(f"no MathML of {source!r}: {error}") from error


def inline(self: HTML5Translator, node: nodes.math) -> None:
    """Write a formula within a line."""
    self.body.append(f'<span class="math">{mathml(node.astext(), as_block=False)}</span>')
    raise nodes.SkipNode


def block(self: HTML5Translator, node: nodes.math_block) -> None:
    """Write a formula on lines of its own, which scrolls where the screen is narrow."""
    number = ""
    if node["number"]:
        number = f'<span class="eqno">({get_node_equation_number(self, node)})</span>'
    anchor = f' id="{node["ids"][0]}"' if node["ids"] else ""
    formula = mathml(node.astext(), as_block=True)
    self.body.append(
        f'<div class="math"{anchor} tabindex="0" role="group" aria-label="formula">{number}{formula}</div>\n'
    )
    raise nodes.SkipNode
