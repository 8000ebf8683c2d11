"""One robot in three formats, with places for the numbers of its inertia."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

# An L of a box and a ball that stands askew, 3 kg; the numbers of its inertial block are filled in.
URDF = """<?xml version="1.0"?>
<!-- kept -->
<robot name="l">
  <link name="arm">
    <inertial>
      <origin xyz="{center}" rpy="0.1 -0.2 0.3"/>
      <mass value='3'/>  <!-- from a scale -->
      <inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}"
               ixy="{ixy}" ixz="{ixz}" iyz="{iyz}"/>
    </inertial>
    <collision>
      <origin xyz="0.1 0 0" rpy="0.4 0.5 -0.6"/><geometry><box size="0.2 0.3 0.4"/></geometry>
    </collision>
    <collision><origin xyz="0 0.3 0"/><geometry><sphere radius="0.1"/></geometry></collision>
  </link>
</robot>
"""

SDF = """<sdf version="1.9"><model name="l"><link name="arm">
  <inertial><pose degrees="true">{center} {degrees}</pose><mass>3</mass>
    <inertia><ixx>{ixx}</ixx><iyy>{iyy}</iyy><izz>{izz}</izz>
      <ixy>{ixy}</ixy><ixz>{ixz}</ixz><iyz>{iyz}</iyz></inertia>
  </inertial>
  <collision name="a"><pose>0.1 0 0 0.4 0.5 -0.6</pose>
    <geometry><box><size>0.2 0.3 0.4</size></box></geometry></collision>
  <collision name="b"><pose>0 0.3 0 0 0 0</pose>
    <geometry><sphere><radius>0.1</radius></sphere></geometry></collision>
</link></model></sdf>
"""

MJCF = """<mujoco model="l"><compiler angle="radian" eulerseq="XYZ"/>
  <default><geom type="box"/><default class="ball"><geom type="sphere" size="0.1"/></default></default>
  <worldbody><body name="arm">
    <inertial mass="3" pos="{center}" euler="0.1 -0.2 0.3" fullinertia="{ixx} {iyy} {izz} {ixy} {ixz} {iyz}"/>
    <geom pos="0.1 0 0" euler="0.4 0.5 -0.6" size="0.1 0.15 0.2"/>
    <geom class="ball" pos="0 0.3 0"/>
  </body></worldbody></mujoco>
"""

PLAIN = dict.fromkeys(("ixx", "iyy", "izz"), "0.1") | dict.fromkeys(("ixy", "ixz", "iyz"), "0")

PLAIN |= {"center": "0 0 0.1", "degrees": "0 0 30"}

FORMATS = {"URDF": URDF, "SDF": SDF, "MJCF": MJCF}

T = TypeVar("T")


def there(value: T | None) -> T:
    """What is there."""
    assert value is not None
    return value


def fixed_axes(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """Turns about x, then y, then z of the fixed frame, written out."""
    (cr, cp, cy), (sr, sp, sy) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return np.asarray(about_z @ about_y @ about_x)
