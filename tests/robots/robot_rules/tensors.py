"""Robots with tensors that no body has, or that nobody computed."""

from __future__ import annotations

import math
from typing import Final

from robot_texts import BALL, CUBE, Row, bare, joint, link, urdf

__all__ = ["TENSORS"]

ARM: Final = link("arm", 5.0, (0.02, 0.02, 0.021), BALL)
# 2/5 m r² of the ball is 0.02. A ball of osmium of 1 kg: r³ = 3/(4π 22590), 2/5 r².
OSMIUM: Final = 0.4 * (3.0 / (4.0 * math.pi * 22_590.0)) ** (2.0 / 3.0)

TENSORS: Final = {
    "beyond the sum of the others": Row(urdf(link("a", 1.0, (1.0, 1.1, 2.1001))), {"a": "impossible"}),
    "the sum of the others": Row(urdf(link("a", 1.0, (1.0, 1.1, 2.1))), {"a": "good"}),
    "negative": Row(urdf(link("a", 1.0, (-0.1, 1.0, 1.0))), {"a": "impossible"}),
    "negative mass": Row(urdf(link("a", -1.0, 0.5)), {"a": "impossible"}),
    "a tensor without mass": Row(urdf(link("a", 0.0, 0.5)), {"a": "impossible"}),
    "zero with mass": Row(urdf(link("a", 1.0, 0.0)), {"a": "placeholder"}, "where mass has no spread"),
    "zero with mass and shape": Row(urdf(link("a", 1.0, 0.0, BALL)), {"a": "placeholder"}),
    "zero with little mass and shape": Row(urdf(link("a", 1e-9, 0.0, BALL)), {"a": "placeholder"}),
    "zero with mass, tied": Row(
        urdf(bare("base"), ARM, link("a", 1.0, 0.0), joint("base", "arm"), joint("arm", "a", "fixed")),
        {"base": "none", "arm": "good", "a": "good"},
        "a point mass, tied to arm",
        singular=False,
    ),
    "zero with mass, tied, by which what is tied to it is moved": Row(
        urdf(bare("base"), link("a", 1.0, 0.0), ARM, joint("base", "a"), joint("a", "arm", "fixed")),
        {"base": "none", "a": "good", "arm": "good"},
        singular=False,
    ),
    "zero with mass, tied to the world": Row(
        urdf(bare("world"), link("a", 1.0, 0.0), joint("world", "a", "fixed")),
        {"world": "none", "a": "good"},
        "a point mass, tied to the world",
    ),
    # A point on the axis, and two points in a line with it: no moment about it.
    "zero with mass, tied to a frame": Row(
        urdf(bare("base"), bare("f"), link("a", 1.0, 0.0), joint("base", "f"), joint("f", "a", "fixed")),
        {"base": "none", "f": "none", "a": "placeholder"},
        singular=True,
    ),
    "zero with mass, tied to another": Row(
        urdf(
            bare("base"),
            link("a", 1.0, 0.0),
            link("b", 2.0, 0.0),
            joint("base", "a"),
            joint("a", "b", "fixed", at="0 0 1"),
        ),
        {"base": "none", "a": "placeholder", "b": "placeholder"},
        singular=True,
    ),
    "zero with mass, tied to a rod": Row(
        urdf(
            bare("base"),
            link("a", 1.0, 0.0),
            link("rod", 1.0, (1.0, 1.0, 0.0)),
            joint("base", "a"),
            joint("a", "rod", "fixed"),
        ),
        {"base": "none", "a": "placeholder", "rod": "good"},
        singular=True,
    ),
    "zero with mass, moved on a body": Row(
        urdf(ARM, link("a", 1.0, 0.0), joint("arm", "a")), {"arm": "good", "a": "placeholder"}, singular=True
    ),
    "less than osmium, tied": Row(
        urdf(
            ARM,
            link("a", 1.0, 0.99 * OSMIUM),
            link("b", 2.0, 0.99 * OSMIUM),
            joint("arm", "a", "fixed"),
            joint("arm", "b", "fixed"),
        ),
        {"arm": "good", "a": "good", "b": "good"},
    ),
    "more than osmium, one for unlike masses, tied": Row(
        urdf(
            ARM,
            link("a", 1.0, 4.0 * OSMIUM),
            link("b", 2.0, 4.0 * OSMIUM),
            joint("arm", "a", "fixed"),
            joint("arm", "b", "fixed"),
        ),
        {"arm": "good", "a": "placeholder", "b": "placeholder"},
    ),
    "beyond the sum of the others, tied": Row(
        urdf(ARM, link("a", 1e-3, (1e-6, 1e-6, 3e-6)), joint("arm", "a", "fixed")),
        {"arm": "good", "a": "impossible"},
    ),
    "the unit tensor": Row(urdf(link("a", 5.0, 1.0)), {"a": "placeholder"}, "1 1 1 is the unit tensor"),
    "the unit tensor of a cube": Row(
        urdf(link("a", 6.0, 1.0, CUBE)), {"a": "good"}, "as its collision shape"
    ),
    # Of a cube of 1 m with that mass the moments are 1.0083 and 1.0117: a hundredth is let through.
    "the unit tensor, nearly of a cube": Row(urdf(link("a", 6.05, 1.0, CUBE)), {"a": "good"}),
    "the unit tensor, not quite of a cube": Row(urdf(link("a", 6.07, 1.0, CUBE)), {"a": "placeholder"}),
    "one for unlike masses": Row(
        urdf(link("a", 1.0, 0.5), link("b", 2.0, 0.5)), {"a": "placeholder", "b": "placeholder"}, "in 2 links"
    ),
    "one for like masses": Row(urdf(link("a", 2.0, 0.5), link("b", 2.0, 0.5)), {"a": "good", "b": "good"}),
    "less than osmium": Row(urdf(link("a", 1.0, 0.99 * OSMIUM)), {"a": "suspect"}, "a ball of osmium"),
    "more than osmium": Row(urdf(link("a", 1.0, 1.01 * OSMIUM)), {"a": "good"}),
}
