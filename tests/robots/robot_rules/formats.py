"""Robots of SDF and MJCF: what these formats set where a file is silent."""

from __future__ import annotations

from typing import Final

from robot_texts import (
    BALL,
    HEAVY,
    HINGE,
    ROUND,
    SHARP,
    Row,
    link,
    mjcf,
    sdf,
    sjoint,
    slink,
    urdf,
    weighed,
)

__all__ = ["FORMATS"]

FITTED: Final = '<asset><mesh name="m" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/></asset>'

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
    "SDF, zeros with mass, tied, which libsdformat refuses": Row(
        sdf(slink("b", weighed(5, 0.02), ROUND), slink("a", weighed(1, 0)), sjoint("b", "a", "fixed")),
        {"b": "good", "a": "placeholder"},
    ),
    "SDF, a pose with commas": Row(
        sdf(slink("a", weighed(5, 0.02).replace("<mass>", "<pose>0, 0,\t0.2, 0 0, 0,</pose><mass>"), ROUND)),
        {"a": "impossible"},
        "z = 0.2 m, lies outside the shape",
    ),
    "SDF, a pose with commas alone, of which libsdformat reads one number": Row(
        sdf(slink("a", weighed(5, 0.02).replace("<mass>", "<pose>0,0,0,0,0,0</pose><mass>"), ROUND)),
        {"a": "unreadable"},
        "pose is '0,0,0,0,0,0' where 6 finite numbers have to stand",
    ),
    "SDF, a world of Gazebo": Row(
        '<sdf version="1.6"><world name="w"><include><uri>model://sun</uri></include>'
        "<include><uri>model://ground_plane</uri></include>"
        f'<model name="m">{slink("a", weighed(5, 0.02), ROUND)}</model></world></sdf>',
        {"a": "good"},
    ),
    "SDF, a model that is not there": Row(
        '<sdf version="1.6"><world name="w"><include><uri>model://sunny</uri></include></world></sdf>',
        {"(include of line 1)": "unreadable"},
        "model://sunny was not found",
    ),
    "SDF, a static model that is not there": Row(
        '<sdf version="1.6"><world name="w"><include><uri>model://wall</uri><static>true</static></include>'
        "</world></sdf>",
        {"(include of line 1)": "none"},
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
        mjcf(f'<body name="a">{HINGE}<inertial pos="0 0 0" mass="5" diaginertia="0 0 0"/></body>'),
        {"a": "placeholder"},
        refused=True,
    ),
    "URDF, a visual shape that is no number": Row(
        urdf(link("a", 5.0, 0.02, BALL, seen='<box size="1 1 x"/>')), {"a": "good"}
    ),
    "URDF, a collision shape that is no number": Row(
        urdf(link("a", 5.0, 0.02, '<box size="1 1 x"/>')), {"a": "unreadable"}
    ),
}
