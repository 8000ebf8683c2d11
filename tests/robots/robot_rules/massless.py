"""Robots with links that have no mass: what moves them, what is tied to them."""

from __future__ import annotations

from typing import Final

from robot_texts import BALL, Row, bare, joint, link, urdf

__all__ = ["MASSLESS"]

ARM: Final = link("arm", 5.0, (0.02, 0.02, 0.021), BALL)

MASSLESS: Final = {
    "moved, with shape": Row(
        urdf(bare("base"), bare("a", BALL), joint("base", "a")),
        {"base": "none", "a": "missing"},
        "joint to_a moves it, and it has shape but no mass: the mass matrix is singular there",
        singular=True,
    ),
    "moved, each of a chain": Row(
        urdf(bare("base", BALL), bare("a", BALL), bare("b", BALL), joint("base", "a"), joint("a", "b")),
        {"base": "none", "a": "missing", "b": "missing"},
        singular=True,
    ),
    "moved, without shape": Row(
        urdf(ARM, bare("tip"), joint("arm", "tip")),
        {"arm": "good", "tip": "missing"},
        "no mass is tied to it",
        singular=True,
    ),
    "tied to mass": Row(
        urdf(bare("base"), ARM, bare("tip"), joint("base", "arm"), joint("arm", "tip", "fixed")),
        {"base": "none", "arm": "good", "tip": "none"},
        "tied to arm, which has mass",
        singular=False,
    ),
    "moved, with mass tied to it": Row(
        urdf(bare("base"), bare("a"), ARM, joint("base", "a"), joint("a", "arm", "fixed")),
        {"base": "none", "a": "none", "arm": "good"},
        singular=False,
    ),
    "with shape, tied to mass": Row(
        urdf(bare("base"), ARM, bare("lid", BALL), joint("base", "arm"), joint("arm", "lid", "fixed")),
        {"base": "none", "arm": "good", "lid": "none"},
        singular=False,
    ),
    "tied to the root": Row(
        urdf(bare("base"), bare("a"), joint("base", "a", "fixed")),
        {"base": "none", "a": "none"},
        "no joint moves it",
    ),
    "of zeros, tied to mass": Row(
        urdf(bare("base"), ARM, link("eye", 0.0, 0.0), joint("base", "arm"), joint("arm", "eye", "fixed")),
        {"base": "none", "arm": "good", "eye": "none"},
        singular=False,
    ),
    "of zeros, tied to the root": Row(
        urdf(bare("base"), link("eye", 0.0, 0.0), joint("base", "eye", "fixed")),
        {"base": "none", "eye": "none"},
    ),
    "of zeros, moved": Row(
        urdf(ARM, link("eye", 0.0, 0.0), joint("arm", "eye")),
        {"arm": "good", "eye": "missing"},
        singular=True,
    ),
    "moved, carries mass": Row(
        urdf(bare("base"), bare("a"), ARM, joint("base", "a", "prismatic"), joint("a", "arm")),
        {"base": "none", "a": "none", "arm": "good"},
        "without mass; what it carries has mass",
        singular=False,
    ),
    "moved, with shape, carries mass": Row(
        urdf(bare("base"), bare("a", BALL), ARM, joint("base", "a", "prismatic"), joint("a", "arm")),
        {"base": "none", "a": "missing", "arm": "good"},
        "its own is left out",
        singular=False,
    ),
    "free, carries one mass: seven motions of one body": Row(
        urdf(bare("base"), bare("a"), ARM, joint("base", "a", "floating"), joint("a", "arm")),
        {"base": "none", "a": "missing", "arm": "good"},
        singular=True,
    ),
    "free, carries two masses": Row(
        urdf(
            bare("base"),
            bare("a"),
            ARM,
            ARM.replace('"arm"', '"leg"'),
            joint("base", "a", "floating"),
            joint("a", "arm", at="0 0 1"),
            joint("a", "leg", at="1 1 0"),
        ),
        {"base": "none", "a": "none", "arm": "good", "leg": "good"},
        singular=False,
    ),
    "moved twice, carries none": Row(
        urdf(ARM, bare("a"), bare("b"), joint("arm", "a"), joint("a", "b")),
        {"arm": "good", "a": "missing", "b": "missing"},
        singular=True,
    ),
    "tied to what is told": Row(
        urdf(bare("base"), bare("a", BALL), bare("b"), joint("base", "a"), joint("a", "b", "fixed")),
        {"base": "none", "a": "missing", "b": "none"},
        "which is told there",
        singular=True,
    ),
    "a frame moved with a shape tied to it": Row(
        urdf(bare("base"), bare("a"), bare("b", BALL), joint("base", "a"), joint("a", "b", "fixed")),
        {"base": "none", "a": "missing", "b": "missing"},  # where the joint ends, as Pinocchio names it, too
        singular=True,
    ),
    "a frame moved with a frame and a shape tied to it": Row(
        urdf(
            bare("base"),
            bare("a"),
            bare("tip"),
            bare("b", BALL),
            joint("base", "a"),
            joint("a", "tip", "fixed"),
            joint("tip", "b", "fixed"),
        ),
        {"base": "none", "a": "missing", "tip": "none", "b": "missing"},
        "which is told there",
        singular=True,
    ),
    "alone, with shape": Row(urdf(bare("a", BALL)), {"a": "none"}, "no joint moves it"),
    "the world": Row(
        urdf(bare("world"), bare("a", BALL), joint("world", "a", "fixed")), {"world": "none", "a": "none"}
    ),
    "below a link that is not there": Row(urdf(bare("a", BALL), joint("gone", "a")), {"a": "none"}),
    "in a circle": Row(
        urdf(bare("a", BALL), bare("b", BALL), joint("a", "b"), joint("b", "a")),
        {"a": "missing", "b": "missing"},
    ),
} | {
    f"moved by a {kind} joint": Row(
        urdf(bare("base"), bare("a", BALL), joint("base", "a", kind)),
        {"base": "none", "a": "missing"},
        singular=True,
    )
    for kind in ("continuous", "prismatic", "floating", "planar")
}
