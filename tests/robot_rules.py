"""One robot for each rule of the verdicts, on both sides of its threshold, with the words that are due.

A row is a robot and, by the names of its links, the word of each verdict; `says` stands in the reason of
one of them. The numbers of the thresholds are worked out beside the rows. `singular` tells whether the mass
matrix of a URDF is singular and `refused` whether MuJoCo refuses an MJCF model for the mass of a moving body:
long tests ask Pinocchio and MuJoCo.
"""

from __future__ import annotations

import math
from typing import Final

from robot_rules_compiled import COMPILED, MARKS
from robot_texts import (
    BALL,
    CUBE,
    HEAVY,
    HINGE,
    ROUND,
    SHARP,
    UNREAD,
    Row,
    bare,
    joint,
    link,
    mjcf,
    sdf,
    sjoint,
    slink,
    urdf,
    weighed,
)

__all__ = ["ROWS", "Row"]


FITTED: Final = '<asset><mesh name="m" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/></asset>'
ARM: Final = link("arm", 5.0, (0.02, 0.02, 0.021), BALL)
# 2/5 m r² of the ball is 0.02. A ball of osmium of 1 kg: r³ = 3/(4π 22590), 2/5 r².
OSMIUM: Final = 0.4 * (3.0 / (4.0 * math.pi * 22_590.0)) ** (2.0 / 3.0)
# The cube of 6 kg filled has m a²/6 = 1; with its walls out by 2 % of √3, matter on them m (a²/4 + …) 2.
GROWN: Final = 6.0 * 2.0 * (0.5 + 0.02 * math.sqrt(3.0)) ** 2

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
        {"base": "none", "arm": "good", "a": "placeholder"},
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

FORMATS: Final = {
    "SDF, nothing declared": Row(
        sdf(slink("a", "", ROUND)), {"a": "placeholder"}, "the format sets 1 kg and the unit"
    ),
    "SDF, nothing declared, static": Row(
        sdf(slink("a", "", ROUND), model="<static>true</static>"), {"a": "none"}, "its model is static"
    ),
    "SDF, a placeholder, static": Row(
        sdf(slink("a", weighed(5, 1)), model="<static>1</static>"), {"a": "none"}
    ),
    "SDF, a placeholder, not static": Row(
        sdf(slink("a", weighed(5, 1)), model="<static>false</static>"), {"a": "placeholder"}
    ),
    "SDF, a shape that is no number, static": Row(
        sdf(slink("a", "", ROUND.replace("0.1", "x")), model="<static>true</static>"), {"a": "none"}
    ),
    "SDF, a shape that is no number, not static": Row(
        sdf(slink("a", "", ROUND.replace("0.1", "x"))), {"a": "unreadable"}
    ),
    "SDF, a static model in one that moves": Row(
        sdf(
            slink("a", weighed(5, 0.02), ROUND),
            f'<model name="n"><static>1</static>{slink("b", weighed(5, 1))}</model>',
        ),
        {"a": "good", "b": "none"},
    ),
    "SDF, nothing declared, tied to the world": Row(
        sdf(slink("a", "", ROUND), sjoint("world", "a", "fixed")), {"a": "none"}, "it is tied to the world"
    ),
    "SDF, nothing declared, moved": Row(
        sdf(slink("a", "", ROUND), sjoint("world", "a")), {"a": "placeholder"}
    ),
    "SDF, no tensor": Row(
        sdf(slink("a", "<inertial><mass>5</mass></inertial>", ROUND)),
        {"a": "placeholder"},
        "without <inertia> the",
    ),
    # 2/5 r² of 1 kg.
    "SDF, no mass": Row(
        sdf(slink("a", weighed(5, 0.004).replace("<mass>5</mass>", ""), ROUND)),
        {"a": "good"},
        "without <mass> the",
    ),
    "SDF, inferred": Row(sdf(slink("a", '<inertial auto="true"/>', ROUND)), {"a": "inferred"}),
    "SDF, zeros that float": Row(sdf(slink("a", weighed(0, 0), ROUND)), {"a": "missing"}, "nothing holds it"),
    "SDF, zeros tied to a link of a model within": Row(
        sdf(
            f'<model name="n">{slink("b", weighed(5, 0.02), ROUND)}</model>',
            slink("a", weighed(0, 0)),
            sjoint("n::b", "a", "fixed"),
        ),
        {"b": "good", "a": "none"},
        "tied to b, which has mass",
    ),
    "SDF, zeros moved on a link of a model within": Row(
        sdf(
            f'<model name="n">{slink("b", weighed(5, 0.02), ROUND)}</model>',
            slink("a", weighed(0, 0)),
            sjoint("n::b", "a"),
        ),
        {"b": "good", "a": "missing"},
    ),
    "SDF, zeros tied to a frame": Row(
        sdf(
            slink("b", weighed(5, 0.02), ROUND),
            '<frame name="f" attached_to="b"/>',
            slink("a", weighed(0, 0)),
            sjoint("f", "a", "fixed"),
        ),
        {"b": "good", "a": "none"},
    ),
    # MuJoCo fits a ball to the mesh; what it comes to is not computed, and the tensor alone is judged.
    "MJCF, a geom fitted to a mesh": Row(
        mjcf(f'<body name="a">{HINGE}{HEAVY}<geom type="sphere" mesh="m"/></body>', before=FITTED),
        {"a": "good"},
    ),
    "MJCF, a geom fitted to a mesh, impossible": Row(
        mjcf(f'<body name="a">{HINGE}{SHARP}<geom type="sphere" mesh="m"/></body>', before=FITTED),
        {"a": "impossible"},
    ),
    "MJCF, a body of a geom fitted to a mesh": Row(
        mjcf(f'<body name="a">{HINGE}<geom type="capsule" mesh="m"/></body>', before=FITTED),
        {"a": "inferred"},
    ),
    "MJCF, inferred always, but no geom weighs": Row(
        mjcf(
            f'<body name="a">{HINGE}{HEAVY}</body>'
            f'<body name="b">{HINGE}{HEAVY}<geom size="0.1" mass="0"/></body>'
            f'<body name="c">{HINGE}{SHARP}<geom size="0.1"/></body>',
            before='<compiler inertiafromgeom="true"/>',
        ),
        {"a": "good", "b": "good", "c": "inferred"},
        refused=False,
    ),
    "MJCF, hollow geoms and meshes without a file": Row(
        mjcf(
            f'<body name="a">{HINGE}<geom size="0.1" mass="1" shellinertia="true"/></body>'
            f'<body name="b">{HINGE}{HEAVY}<geom size="0.1" mass="1" shellinertia="true"/></body>'
            f'<body name="c">{HINGE}<geom type="mesh" mesh="m"/></body>',
            before=FITTED,
        ),
        {"a": "inferred", "b": "good", "c": "inferred"},
    ),
    "MJCF, inferred always, what no body has": Row(
        mjcf(f'<body name="a">{HINGE}{SHARP}</body>', before='<compiler inertiafromgeom="true"/>'),
        {"a": "impossible"},
    ),
    "MJCF, nothing, no joint": Row(mjcf('<body name="a"/>'), {"a": "none"}, refused=False),
    "MJCF, nothing, moved": Row(mjcf(f'<body name="a">{HINGE}</body>'), {"a": "missing"}, refused=True),
    "MJCF, nothing, free": Row(mjcf('<body name="a"><freejoint/></body>'), {"a": "missing"}, refused=True),
    "MJCF, a geom, moved": Row(
        mjcf(f'<body name="a">{HINGE}<geom size="0.1"/></body>'),
        {"a": "inferred"},
        "from its shapes",
        refused=False,
    ),
    "MJCF, a geom of no mass, moved": Row(
        mjcf(f'<body name="a">{HINGE}<geom size="0.1" mass="0"/></body>'), {"a": "missing"}, refused=True
    ),
    "MJCF, a geom out of the groups that count": Row(
        mjcf(
            f'<body name="a">{HINGE}<geom size="0.1" group="2"/></body>',
            before='<compiler inertiagrouprange="3 5"/>',
        ),
        {"a": "missing"},
        refused=True,
    ),
    "MJCF, a geom in the groups that count": Row(
        mjcf(
            f'<body name="a">{HINGE}<geom size="0.1" group="3"/></body>',
            before='<compiler inertiagrouprange="3 5"/>',
        ),
        {"a": "inferred"},
        refused=False,
    ),
    "MJCF, moved, carries mass": Row(
        mjcf(f'<body name="a">{HINGE}<body name="b">{HINGE}{HEAVY}</body></body>'),
        {"a": "missing", "b": "good"},
        "MuJoCo refuses it",
        refused=True,
    ),
    "MJCF, moved, mass tied to it": Row(
        mjcf(f'<body name="a">{HINGE}<body name="b">{HEAVY}</body></body>'),
        {"a": "none", "b": "good"},
        refused=False,
    ),
    "MJCF, moved, in a frame": Row(
        mjcf(f'<frame pos="0 0 1"><body name="a"><frame>{HINGE}</frame></body></frame>'),
        {"a": "missing"},
        refused=True,
    ),
    "MJCF, zeros with mass": Row(
        mjcf('<body name="a"><inertial pos="0 0 0" mass="5" diaginertia="0 0 0"/></body>'),
        {"a": "placeholder"},
    ),
    "URDF, a visual shape that is no number": Row(
        urdf(link("a", 5.0, 0.02, BALL, seen='<box size="1 1 x"/>')), {"a": "good"}
    ),
    "URDF, a collision shape that is no number": Row(
        urdf(link("a", 5.0, 0.02, '<box size="1 1 x"/>')), {"a": "unreadable"}
    ),
}

ROWS: Final = {
    f"{title}: {name}": row
    for title, table in (
        ("massless", MASSLESS),
        ("tensor", TENSORS),
        ("room", ROOM),
        ("format", FORMATS),
        ("compiled", COMPILED),
        ("marks", MARKS),
    )
    for name, row in table.items()
}
