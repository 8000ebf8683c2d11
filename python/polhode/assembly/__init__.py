"""Assemblies: bodies of many parts. A text file gives the shape, position and material of each part.

.. code-block:: toml

    name = "stool"
    length_unit = "mm"

    [[part]]
    name = "seat"
    solid = "cylinder"
    radius = 160
    height = 25
    density = "0.7 g/cm^3"
    position = [0, 0, 450]

    [[part]]
    name = "leg"
    solid = "rod"
    length = 440
    mass = "0.4 kg"
    position = [120, 0, 220]
    count = 3
    turn = { axis = [0, 0, 1], degrees = 120 }
"""

from polhode.assembly.reading import read
from polhode.assembly.result import Assembly, Member

__all__ = ["Assembly", "Member", "read"]
