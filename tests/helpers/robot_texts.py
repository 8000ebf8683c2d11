"""Robots of a few links as texts: URDF, SDF and MJCF."""

from __future__ import annotations

from typing import Final, NamedTuple

__all__ = [
    "BALL",
    "CUBE",
    "HEAVY",
    "HINGE",
    "ONE_BALL",
    "ROUND",
    "SHARP",
    "UNREAD",
    "Row",
    "bare",
    "joint",
    "link",
    "mjcf",
    "sdf",
    "sjoint",
    "slink",
    "urdf",
    "weighed",
]

Tensor = float | tuple[float, float, float]
BALL: Final = '<sphere radius="0.1"/>'
CUBE: Final = '<box size="1 1 1"/>'
ROUND: Final = "<sphere><radius>0.1</radius></sphere>"
UNREAD: Final = '<mesh filename="nowhere.stl"/>'
HINGE: Final = '<joint type="hinge"/>'
HEAVY: Final = '<inertial pos="0 0 0" mass="5" diaginertia="0.02 0.02 0.021"/>'
SHARP: Final = '<inertial pos="0 0 0" mass="5" diaginertia="0.02 0.02 0.041"/>'

#: Two links, one with matter; its moments are filled in.
ONE_BALL: Final = """<robot name="r">
  <link name="frame"/>
  <link name="ball"><inertial><mass value="5"/>
    <inertia ixx="{0}" iyy="{0}" izz="{0}" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
</robot>
"""


class Row(NamedTuple):
    """A robot, the words due to its links, and what simulators say: see robot_rules."""

    text: str
    words: dict[str, str]
    says: str = ""
    singular: bool | None = None
    refused: bool | None = None


def three(tensor: Tensor) -> tuple[float, float, float]:
    return (tensor, tensor, tensor) if isinstance(tensor, (int, float)) else tensor


def link(
    name: str,
    mass: float | None = None,
    tensor: Tensor = (0.02, 0.02, 0.021),
    *shapes: str,
    seen: str = "",
    at: str = "0 0 0",
) -> str:
    """A link of URDF; without a mass it has no <inertial>."""
    xx, yy, zz = three(tensor)
    inertial = (
        f'<inertial><origin xyz="{at}"/><mass value="{mass!r}"/>'
        f'<inertia ixx="{xx!r}" iyy="{yy!r}" izz="{zz!r}" ixy="0" ixz="0" iyz="0"/></inertial>'
        if mass is not None
        else ""
    )
    solid = "".join(f"<collision><geometry>{shape}</geometry></collision>" for shape in shapes)
    visual = f"<visual><geometry>{seen}</geometry></visual>" if seen else ""
    return f'<link name="{name}">{inertial}{visual}{solid}</link>'


def bare(name: str, *shapes: str) -> str:
    return link(name, None, 0.0, *shapes)


def joint(parent: str, child: str, kind: str = "revolute", at: str = "0 0 0") -> str:
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    return (
        f'<joint name="to_{child}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{at}"/><axis xyz="0 0 1"/>{limit}</joint>'
    )


def urdf(*parts: str) -> str:
    return f'<robot name="r">{"".join(parts)}</robot>'


def sdf(*parts: str, model: str = "") -> str:
    return f'<sdf version="1.9"><model name="m">{model}{"".join(parts)}</model></sdf>'


def slink(name: str, inertial: str = "", shape: str = "") -> str:
    solid = f'<collision name="c"><geometry>{shape}</geometry></collision>' if shape else ""
    return f'<link name="{name}">{inertial}{solid}</link>'


def weighed(mass: float, moment: float) -> str:
    parts = f"<ixx>{moment}</ixx><iyy>{moment}</iyy><izz>{moment}</izz>"
    return f"<inertial><mass>{mass}</mass><inertia>{parts}</inertia></inertial>"


def sjoint(parent: str, child: str, kind: str = "revolute") -> str:
    ends = f"<parent>{parent}</parent><child>{child}</child>"
    return f'<joint name="to_{child}" type="{kind}">{ends}<axis><xyz>0 0 1</xyz></axis></joint>'


def mjcf(*parts: str, before: str = "") -> str:
    return f"<mujoco>{before}<worldbody>{''.join(parts)}</worldbody></mujoco>"
