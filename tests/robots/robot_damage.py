"""A machine that damages robots of several files: each case is told by its number alone."""

from __future__ import annotations

import random
import re
from typing import TYPE_CHECKING, Final

from mesh_files import obj
from oracles.meshes import cube
from polhode.io.xml_source import Element, parse_xml

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["HOSTILE", "KINDS", "SAMPLES", "damaged", "write"]

INERTIA: Final = '<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0.01" ixz="0" iyz="0"/>'
INERTIAL: Final = (
    f'<inertial><origin xyz="0 0 0.1" rpy="0.1 -0.2 0.3"/><mass value="3"/>\n  {INERTIA}</inertial>'
)
CUBE: Final = obj(*cube(0.2)).decode()

# By the names of their files; the first is the robot's own.
SAMPLES: Final[dict[str, dict[str, str]]] = {
    "urdf": {
        "urdf/r.urdf": f"""<?xml version="1.0"?>
<!-- kept -->
<robot name="r">
  <link name="box">{INERTIAL}
    <collision><origin xyz="0.1 0 0" rpy="0.4 0.5 -0.6"/><geometry><box size="0.2 0.3 0.4"/></geometry>
    </collision>
    <visual><geometry><cylinder radius="0.1" length="0.4"/></geometry></visual></link>
  <link name="mesh">{INERTIAL}
    <collision><geometry><mesh filename="../meshes/cube.obj" scale="1 1 2"/></geometry></collision></link>
  <link name="unit"><inertial><mass value='5'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>
    </inertial><visual><geometry><sphere radius="0.1"/></geometry></visual></link>
  <link name="frame"/>
</robot>
""",
        "meshes/cube.obj": CUBE,
    },
    "sdf": {
        "world.sdf": """<?xml version="1.0"?><sdf version="1.9"><world name="w"><model name="m">
  <link name="a"><inertial><pose degrees="true">0 0 0.1 0 0 30</pose><mass>3</mass>
    <inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia>
    </inertial>
  <collision name="a"><pose>0.1 0 0 0.4 0.5 -0.6</pose><geometry><box><size>2 3 4</size></box></geometry>
  </collision></link>
  <link name="b"><inertial auto="true"/><collision name="c"><geometry><mesh><uri>model://part/cube.obj</uri>
    <scale>1 1 1</scale></mesh></geometry></collision></link>
  <link name="q"><inertial><pose rotation_format="quat_xyzw">0 0 0 0 0 0 1</pose><mass>1</mass></inertial>
    <collision name="c"><geometry><ellipsoid><radii>1 2 3</radii></ellipsoid></geometry></collision></link>
  </model>
  <include><uri>model://part</uri><name>left</name></include>
  <include merge="true"><uri>arm.urdf</uri></include>
</world></sdf>
""",
        "part/model.config": '<model><name>part</name><sdf version="1.9">part.sdf</sdf></model>',
        "part/part.sdf": """<sdf version="1.9"><model name="p"><link name="p"><inertial><mass>2</mass>
  <inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial><visual name="v"><geometry><mesh>
  <uri>cube.obj</uri></mesh></geometry></visual></link></model></sdf>""",
        "part/cube.obj": CUBE,
        "arm.urdf": f'<robot name="arm"><link name="arm">{INERTIAL}</link></robot>',
    },
    "mjcf": {
        "scene.xml": """<mujoco model="s"><compiler angle="degree" eulerseq="xyz" meshdir="parts"/>
  <default><geom type="box" size="0.1 0.2 0.3"/>
    <default class="ball"><geom type="sphere" size="0.1"/></default></default>
  <asset><mesh name="cube" file="cube.obj" scale="1 1 2"/><model name="leg" file="parts/leg.xml"/></asset>
  <worldbody>
    <body name="a"><inertial mass="3" pos="0 0 0.1" euler="5 6 7" fullinertia="0.1 0.1 0.1 0.01 0 0"/>
      <geom pos="0.1 0 0" euler="10 20 30"/><geom class="ball" pos="0 0.3 0"/>
      <geom type="capsule" size="0.05" fromto="0 0 0 0 0 1" mass="0.5"/>
      <frame pos="0 0 1" axisangle="0 0 1 30"><geom type="mesh" mesh="cube" density="500"/></frame>
      <replicate count="3" offset="0 0 0.2" euler="0 0 30"><geom class="ball"/></replicate>
      <include file="parts/hand.xml"/>
      <attach model="leg" body="upper" prefix="left_"/></body>
    <body name="c" childclass="ball"><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/><geom zaxis="1 2 3"/>
      <body name="d"><geom xyaxes="0 1 0 1 1 0" type="ellipsoid" size="1 2 3" quat="2 1 0 0"/></body></body>
  </worldbody></mujoco>
""",
        "parts/hand.xml": """<mujocoinclude><body name="hand"><inertial mass="1" pos="0 0 0" quat="1 0 0 0"
  diaginertia="0.1 0.1 0.3"/><geom type="cylinder" size="0.1 0.2"/></body></mujocoinclude>""",
        "parts/leg.xml": """<mujoco model="leg"><worldbody><body name="base"><body name="upper"><geom
  type="sphere" size="0.2"/><inertial mass="1" pos="0 0 0" diaginertia="0.016 0.016 0.016"/></body></body>
  </worldbody></mujoco>""",
        "parts/cube.obj": CUBE,
    },
}
HOSTILE: Final = (
    *("nan", "inf", "-inf", "1e999", "-1e999", "1e308", "1e50", "-1e50", "1e-320", "1e-60", "", " ", "-0"),
    *("0x10", "1_0", "0", "-1", "9999", "1e9", "1,5", "1 2", "1 2 3 4 5 6 7", "٣", "None", "true", "zzz"),
    *("1" * 1_000_000, "0 " * 500_000, "0." + "0" * 999_998, "a/" * 500_000, "n" * 300, "../" * 400),
    *("/etc/hostname", "file:///etc/hostname", "package://../..", "package://part/../../x"),
    *("model://", "model:///", "..\\..\\x.stl", "\\\\host\\share\\x.stl", "C:\\x.stl"),
    *("..", ".", "../..", "pipe", "loop", "folder", "away"),
    *("http://127.0.0.1:9/x", "cube.obj\u202e", "world.sdf", "scene.xml", "urdf/r.urdf", "%s%n", "quat_xyzw"),
)
VALUE: Final = re.compile(rb"=\s*(\"[^\"]*\"|'[^']*')|>([^<>]*[^<>\s][^<>]*)<")
NUMBER: Final = re.compile(rb"-?\d+(\.\d+)?")


def write(sample: str, folder: Path, **changed: bytes) -> Path:
    """Write a sample, some files otherwise, among things that are no files; gives its robot."""
    for name, text in SAMPLES[sample].items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(changed.get(name, text.encode()))
    return folder / next(iter(SAMPLES[sample]))


def _cut(source: bytes, draw: random.Random) -> bytes:
    return source[: draw.randrange(len(source))]


def _flip(source: bytes, draw: random.Random) -> bytes:
    data = bytearray(source)
    for _ in range(draw.choice((1, 1, 1, 3))):
        data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
    return bytes(data)


def _swap(source: bytes, draw: random.Random) -> bytes:
    """Put a hostile value in the place of an attribute, a text or a number of them."""
    places = [match.span(1 if match[1] else 2) for match in VALUE.finditer(source)]
    places += [match.span() for match in NUMBER.finditer(source)]
    start, end = draw.choice(places)
    value = draw.choice(HOSTILE).encode()
    quoted = source[start : start + 1] if source[start : start + 1] in (b'"', b"'") else b""
    return source[:start] + quoted + value + quoted + source[end:]


def _elements(source: bytes) -> list[Element]:
    waiting, found = [parse_xml(source, "sample")], []
    while waiting:
        element = waiting.pop()
        found.append(element)
        waiting += element.children
    return found[1:] or found


def _twice(source: bytes, draw: random.Random) -> bytes:
    """Repeat an element where it stands, or put a copy of it into another one."""
    elements = _elements(source)
    one, other = draw.choice(elements), draw.choice(elements)
    copy = source[one.start : one.end] * draw.choice((1, 2, 40))
    at = draw.choice((one.end, other.start, other.outside))
    return source[:at] + copy + source[at:]


def _remove(source: bytes, draw: random.Random) -> bytes:
    element = draw.choice(_elements(source))
    return source[: element.start] + source[element.end :]


def _rename(source: bytes, draw: random.Random) -> bytes:
    """Take an attribute or a tag for another one of the same file."""
    words = list(re.finditer(rb"(?<=[<\s])[a-z_]+(?=[\s=/>])", source))
    one, other = draw.choice(words), draw.choice(words)
    return source[: one.start()] + other[0] + source[one.end() :]


def _nest(source: bytes, draw: random.Random) -> bytes:
    """Wrap an element in many of one kind."""
    element = draw.choice(_elements(source))
    tag = draw.choice(("body", "frame", "model", "link", "replicate", "default", "world")).encode()
    times = draw.choice((3, 100, 190, 300))
    own = b' count="2"' if tag == b"replicate" else b""
    inner = source[element.start : element.end]
    wrapped = (b"<" + tag + own + b">") * times + inner + (b"</" + tag + b">") * times
    return source[: element.start] + wrapped + source[element.end :]


KINDS: Final = (_cut, _flip, _swap, _swap, _swap, _twice, _remove, _rename, _nest)


def damaged(number: int) -> tuple[str, str, bytes]:
    """Give a sample, the name of one of its files, and that file damaged."""
    draw = random.Random(number)
    sample = draw.choice(sorted(SAMPLES))
    name = draw.choice(list(SAMPLES[sample]))
    source = SAMPLES[sample][name].encode()
    kind = draw.choice(KINDS if not name.endswith(".obj") else (_cut, _flip))
    return sample, name, kind(source, draw)
