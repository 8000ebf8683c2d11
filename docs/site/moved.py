"""Anchors of a page that was split: who follows an old link is led to the page where the anchor is now."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from docutils import nodes

if TYPE_CHECKING:
    from sphinx.application import Sphinx

MOVED = {
    "theory/motion": (
        "kinematics", "euler_angles", "kinetic_energy", "euler_equations", "stability", "free",
        "free_invariants", "free_periods", "free_sensitivity", "free_precession", "heavy_top", "gyrostat",
        "rolling", "loads", "simulate", "integrate", "variation", "identification",
    ),
}  # fmt: skip
"""A page, and those beside it that hold its sections now."""


def setup(app: Sphinx) -> dict[str, bool]:
    """Add to a page the anchors that it had; ``static/page.js`` goes on from there."""
    app.connect("env-updated", lambda *_: list(MOVED))  # written anew when a page beside it has changed
    app.connect("html-page-context", add)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def add(app: Sphinx, name: str, _template: str, context: dict[str, Any], doctree: nodes.document) -> None:
    """Put the anchors behind the text of the page."""
    kept = set(anchors(doctree)) if name in MOVED else set()
    for page in MOVED.get(name, ()):
        for anchor in anchors(app.env.get_doctree(f"{name.rpartition('/')[0]}/{page}")):
            if anchor not in kept:
                kept.add(anchor)
                context["body"] += f'<span id="{anchor}" data-moved="{page}.html#{anchor}"></span>\n'


def anchors(tree: nodes.document) -> list[str]:
    """Return the anchors of the sections of a page, in order."""
    return [each for section in tree.findall(nodes.section) for each in section["ids"]]
