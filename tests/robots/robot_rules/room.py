"""Robots with tensors that their shapes have room for, or not."""

from __future__ import annotations

import math
from typing import Final

from robot_texts import BALL, CUBE, UNREAD, Row, joint, link, urdf

__all__ = ["ROOM"]

# The cube of 6 kg filled has m a²/6 = 1; with its walls out by 2 % of √3, matter on them m (a²/4 + …) 2.
GROWN: Final = 6.0 * 2.0 * (0.5 + 0.02 * math.sqrt(3.0)) ** 2


def dense(times: float) -> str:
    """A ball in which 5 kg have so many times 25,000 kg/m^3."""
    return f'<sphere radius="{(5.0 / (25_000.0 * times) * 0.75 / math.pi) ** (1.0 / 3.0)!r}"/>'


ROOM: Final = {
    "on the walls": Row(urdf(link("a", 6.0, 2.999, CUBE)), {"a": "good"}),
    "beyond the walls by what a box may be off": Row(
        urdf(link("a", 6.0, 0.999 * GROWN, CUBE)), {"a": "suspect"}, "its shapes may be off by 34.6 mm"
    ),
    "beyond what a box may be off": Row(
        urdf(link("a", 6.0, 1.001 * GROWN, CUBE)), {"a": "suspect"}, "where its shape has room for 0.5 m"
    ),
    # The cube filled has moments of 1: 3 times that is on its walls, 1000 times beyond any reason.
    "the room of a cube, 999 times": Row(
        urdf(link("a", 6.0, 999.0, CUBE)), {"a": "suspect"}, "its shape would need 5.99e+03 kg/m^3"
    ),
    "the room of a cube, 1001 times": Row(
        urdf(link("a", 6.0, 1001.0, CUBE)), {"a": "impossible"}, "where its shape has room for 0.5 m"
    ),
    # The tensor of the cube filled twice, which has no room 0.1 m from a wall.
    "no room beside a wall": Row(
        urdf(link("a", 6.0, 2.0, CUBE, at="0.4 0 0")),
        {"a": "impossible"},
        "as the centre of mass is 0.1 m from",
    ),
    "no room beside a wall, but in the middle": Row(
        urdf(link("a", 6.0, 2.0, CUBE, at="0.4 0 0")),
        {"a": "impossible"},
        "about its middle the shape has room: look at the centre of mass",
    ),
    "beyond three times the cube filled, off the middle": Row(
        urdf(link("a", 6.0, (2.0, 5.5, 5.5), CUBE, at="0.1 0 0")), {"a": "suspect"}, "4.33 times the box"
    ),
    "far beyond the room, about the middle": Row(
        urdf(link("a", 6.0, 999.0, CUBE)), {"a": "suspect"}, "identified tensors are so at times"
    ),
    # 2 % of the diagonal of the ball's box is δ = 6.93 mm. Spread s² = I/2m about a centre d beyond the ball
    # needs (δ − d)(0.2 + δ + d) ≥ s².
    "centre outside by what a ball may be off": Row(
        urdf(link("a", 0.1, 4.1e-5, BALL, at="0 0 0.1059")), {"a": "coarse"}, "z = 0.1059 m, lies outside"
    ),
    "centre farther outside": Row(
        urdf(link("a", 0.1, 4.1e-5, BALL, at="0 0 0.1061")), {"a": "impossible"}, "z = 0.1061 m, lies outside"
    ),
    "a point outside by what a ball may be off": Row(
        urdf(link("a", 0.1, 1e-7, BALL, at="0 0 0.1068")),
        {"a": "suspect"},
        "its shapes may be off by 6.93 mm",
    ),
    "a point farther outside": Row(urdf(link("a", 0.1, 1e-7, BALL, at="0 0 0.107")), {"a": "impossible"}),
    "a ball without size beside a cube": Row(
        urdf(link("a", 6.0, 1.0, '<sphere radius="0"/>', CUBE)), {"a": "good"}, "as its collision shape"
    ),
    # 5 kg on both sides of 25,000 kg/m^3; the tensor is that of a ball of 0.1 m.
    "a ball as dense as any matter": Row(
        urdf(link("a", 5.0, 0.02, dense(0.9999))), {"a": "suspect"}, "times its collision shape's"
    ),
    "a ball denser than any matter": Row(
        urdf(link("a", 5.0, 0.02, dense(1.0001))), {"a": "suspect"}, "2.5e+04 kg/m^3 in its shapes"
    ),
    "a ball denser than any matter, of its own tensor": Row(
        urdf(link("a", 5.0, 2e-6, '<sphere radius="0.001"/>')), {"a": "suspect"}, "1.19e+09 kg/m^3"
    ),
    "dots of contact on a body": Row(
        urdf(link("a", 5.0, 0.02, '<sphere radius="0.001"/>', seen=BALL)),
        {"a": "good"},
        "as its visual shape",
    ),
    "a body seen as a dot": Row(
        urdf(link("a", 5.0, 0.02, BALL, seen='<sphere radius="0.001"/>')),
        {"a": "good"},
        "as its collision shape",
    ),
    "dots, and a mesh that is not there": Row(
        urdf(link("a", 5.0, 0.02, '<sphere radius="0.001"/>', seen=UNREAD)), {"a": "suspect"}
    ),
    "a placeholder with a marker": Row(
        urdf(link("a", 5.0, 1.0, '<sphere radius="0.001"/>')), {"a": "placeholder"}
    ),
    "what no body has, with a marker": Row(
        urdf(link("a", 5.0, (1.0, 1.0, 3.0), '<sphere radius="0.001"/>')), {"a": "impossible"}
    ),
    "a ball without size alone": Row(urdf(link("a", 6.0, 2.0, '<sphere radius="0"/>')), {"a": "good"}),
    "a tenth": Row(urdf(link("a", 5.0, 0.00201, BALL)), {"a": "good"}),
    "less than a tenth": Row(urdf(link("a", 5.0, 0.00199, BALL)), {"a": "suspect"}),
    "three times, with room": Row(urdf(link("a", 5.0, 0.0599, BALL, seen=CUBE)), {"a": "good"}),
    "more than three times, with room": Row(
        urdf(link("a", 5.0, 0.0601, BALL, seen=CUBE)), {"a": "suspect"}, "would need 3.59e+03 kg/m^3"
    ),
    # The box around the ball, filled, spreads 3 a²/12 = 0.01 m²; 3/2 I/m is 1000 times that at I = 100/3.
    "with unread meshes, three times": Row(urdf(link("a", 5.0, 0.0599, BALL, seen=UNREAD)), {"a": "good"}),
    "with unread meshes, more": Row(urdf(link("a", 5.0, 0.0601, BALL, seen=UNREAD)), {"a": "suspect"}),
    "with unread meshes, 999 times": Row(
        urdf(link("a", 5.0, 33.3, BALL, seen=UNREAD)), {"a": "suspect"}, "1665 times its collision shape's"
    ),
    "with unread meshes, 1001 times": Row(
        urdf(link("a", 5.0, 33.4, BALL, seen=UNREAD)),
        {"a": "impossible"},
        "1 of its shapes could not be read",
    ),
    "with unread meshes alone, the same twice": Row(urdf(link("a", 5.0, 33.4, UNREAD)), {"a": "good"}),
} | {
    # A ball of diameter 1 m, filled, spreads 0.15 m²; 3/2 I/m is 3 times that at 0.3, 1000 times at 100.
    f"{what}, moments {moment}": Row(
        urdf(
            link("base", 5.0, 0.3, *shapes),
            link("a", 1.0, (moment, moment, moment * 1.0001), *shapes),
            joint("base", "a", at="0.6 0.8 0"),
        ),
        {"base": "good", "a": word},
        says,
    )
    for what, shapes, moment, word, says in (
        ("nothing but a joint of 1 m", (), 0.299, "good", ""),
        ("nothing but a joint of 1 m", (), 0.301, "suspect", "a ball as large as the whole robot, 1 m"),
        ("nothing but a joint of 1 m", (), 99.9, "suspect", ""),
        ("nothing but a joint of 1 m", (), 100.1, "impossible", "nothing explains more than 1000 times"),
        ("a joint of 1 m and unread meshes", (UNREAD,), 99.9, "good", ""),
        (
            "a joint of 1 m and unread meshes",
            (UNREAD,),
            100.1,
            "impossible",
            "1 of its shapes could not be read",
        ),
    )
}
