"""Robots of what MuJoCo's compiler does after it has read masses, and of XML that simulators take."""

from __future__ import annotations

from typing import Final

from robot_texts import BALL, HEAVY, HINGE, ROUND, SHARP, Row, link, mjcf, sdf, slink, urdf, weighed

from robot_rules.formats import FITTED

__all__ = ["COMPILED", "MARKS"]

BOTH: Final = '<compiler boundmass="0.3" boundinertia="0.01"/>'
GEOM: Final = '<geom size="0.1" mass="5"/>'

COMPILED: Final = {
    "nothing, moved, but bounds": Row(
        mjcf(f'<body name="a">{HINGE}</body>', before=BOTH),
        {"a": "inferred"},
        "by boundmass and boundinertia of the compiler",
        refused=False,
    ),
    "nothing, moved, a bound of mass alone": Row(
        mjcf(f'<body name="a">{HINGE}</body>', before='<compiler boundmass="0.3"/>'),
        {"a": "missing"},
        refused=True,
    ),
    "nothing, moved, a bound of moments alone": Row(
        mjcf(f'<body name="a">{HINGE}</body>', before='<compiler boundinertia="0.01"/>'),
        {"a": "missing"},
        refused=True,
    ),
    # Of the ball 2/5 m r² = 0.02: above one bound, below the other.
    "a geom above the bounds": Row(
        mjcf(f'<body name="a">{HINGE}{GEOM}</body>', before=BOTH),
        {"a": "inferred"},
        "from its shapes",
        refused=False,
    ),
    "a geom below a bound": Row(
        mjcf(f'<body name="a">{HINGE}{GEOM}</body>', before='<compiler boundinertia="0.021"/>'),
        {"a": "inferred"},
        "from its shapes, by boundmass and boundinertia",
        refused=False,
    ),
    "bounds beside what is declared": Row(
        mjcf(f'<body name="a">{HINGE}{HEAVY}</body><body name="b">{HINGE}</body>', before=BOTH),
        {"a": "good", "b": "inferred"},
        refused=False,
    ),
    # MuJoCo puts the mean in its place; the file still declares what no body has.
    "balanced by the compiler": Row(
        mjcf(f'<body name="a">{HINGE}{SHARP}</body>', before='<compiler balanceinertia="true"/>'),
        {"a": "impossible"},
        refused=False,
    ),
    # A rod along x: bounded from below its moments are (1, 0.02, 0.02)·k, which no body has.
    "bounded, then balanced": Row(
        mjcf(
            f'<body name="a">{HINGE}<geom type="box" size="0.1 0.1 0.1" mass="1"/>'
            f'<geom type="box" size="0.1 0.1 0.1" mass="1" pos="1 0 0"/></body>',
            before='<compiler boundinertia="0.6" balanceinertia="true"/>',
        ),
        {"a": "inferred"},
        refused=False,
    ),
    "declared without pos": Row(
        mjcf('<body name="a"><inertial mass="5" diaginertia="0.02 0.02 0.021"/></body>'),
        {"a": "unreadable"},
        "pos is missing, where 3 finite numbers have to stand",
    ),
    "declared without a tensor, fixed": Row(
        mjcf('<body name="a"><inertial mass="5" pos="0 0 0"/></body>'),
        {"a": "good"},
        "a point mass, tied to the world",
        refused=False,
    ),
    "declared without a tensor, tied to a body": Row(
        mjcf(f'<body name="a">{HINGE}{HEAVY}<body name="b"><inertial mass="5" pos="0 0 0"/></body></body>'),
        {"a": "good", "b": "good"},
        "a point mass, tied to a",
        refused=False,
    ),
    "declared without a tensor, moved": Row(
        mjcf(f'<body name="a">{HINGE}<inertial mass="5" pos="0 0 0"/></body>'),
        {"a": "placeholder"},
        "where mass has no spread",
        refused=True,
    ),
    "declared without a tensor, moved, a body tied to it": Row(
        mjcf(f'<body name="a">{HINGE}<inertial mass="5" pos="0 0 0"/><body name="b">{HEAVY}</body></body>'),
        {"a": "good", "b": "good"},
        refused=False,
    ),
    "scaled to a total": Row(
        mjcf(
            f'<body name="a">{HINGE}{GEOM}</body><body name="b">{HINGE}{HEAVY}</body>',
            before='<compiler settotalmass="2"/>',
        ),
        {"a": "inferred", "b": "good"},
        "times 0.2 by settotalmass",
        refused=False,
    ),
    "scaled to a total, with bounds": Row(
        mjcf(
            f'<body name="a">{HINGE}{GEOM}</body><body name="b">{HINGE}</body><body name="c"/>',
            before='<compiler settotalmass="2" boundmass="0.3" boundinertia="0.01"/>',
        ),
        {"a": "inferred", "b": "inferred", "c": "none"},
        "times 0.3571 by settotalmass",  # 2/5.6
        refused=False,
    ),
    "scaled to a total that is not known": Row(
        mjcf(
            f'<body name="a">{HINGE}{GEOM}</body>'
            f'<body name="b">{HINGE}<geom type="capsule" mesh="m"/></body>',
            before=f'<compiler settotalmass="2"/>{FITTED}',
        ),
        {"a": "inferred", "b": "inferred"},
        "settotalmass would scale it: the mass of b is not known",
    ),
    "scaled to no total": Row(
        mjcf(f'<body name="a">{HINGE}{GEOM}</body>', before='<compiler settotalmass="-1"/>'),
        {"a": "inferred"},
        "from its shapes",
        refused=False,
    ),
}

ONE: Final = urdf(link("a", 5.0, (0.02, 0.02, 0.021), BALL))

ABOVE: Final = (
    f'<collision name="c"><pose relative_to="a">0 0 1 0 0 0</pose><geometry>{ROUND}</geometry></collision>'
)

MARKS: Final = {
    "two hyphens in a comment": Row(ONE.replace("<link", "<!-- a -- b <!-- c --><link", 1), {"a": "good"}),
    "a comment that ends in three": Row(ONE.replace("<link", "<!--- a ---><link", 1), {"a": "good"}),
    "SDF, poses relative to the link itself": Row(
        sdf(
            '<link name="a"><inertial><pose relative_to="a">0 0 1 0 0 0</pose><mass>5</mass>'
            "<inertia><ixx>0.02</ixx><iyy>0.02</iyy><izz>0.021</izz></inertia></inertial>"
            f"{ABOVE}</link>"
        ),
        {"a": "good"},
    ),
    "SDF, a shape elsewhere, relative to the link itself": Row(
        sdf(f'<link name="a">{weighed(5, 0.02)}{ABOVE}</link>'),
        {"a": "impossible"},
        "lies outside the shape",
    ),
    "SDF, a tensor relative to what is not followed": Row(
        sdf(
            slink("b", weighed(5, 0.02), ROUND),
            '<link name="a"><inertial><pose relative_to="b">0 0 1 0 0 0</pose></inertial></link>',
        ),
        {"b": "good", "a": "unreadable"},
        "a pose relative to 'b' is not followed; give it in the link",
    ),
    # Links that stand elsewhere, or that no physics moves.
    "SDF, what the state of a world, plugins and actors say of links": Row(
        '<sdf version="1.7"><world name="w"><model name="m">'
        + slink("a", weighed(5, 0.02), ROUND)
        + '<plugin name="p"><link name="b"/><sdf><model name="c"><link name="d"/></model></sdf></plugin>'
        + '</model><actor name="e"><link name="f"/><plugin><link name="g"/></plugin></actor>'
        + '<state world_name="w"><model name="m"><link name="a"><pose/></link></model></state>'
        + '<x:own xmlns:x="http://nowhere"><link name="h"/></x:own></world></sdf>',
        {"a": "good"},
    ),
    "SDF, a population of models": Row(
        '<sdf version="1.7"><world name="w"><population name="p"><model name="m">'
        + slink("a", weighed(5, 0.02), ROUND)
        + "</model></population></world></sdf>",
        {"a": "good"},
    ),
    "a declaration that is misspelt": Row(f'<?xml vertsion="1.0"?>\n{ONE}', {"a": "good"}),
}
