"""One robot for each rule of the verdicts, on both sides of its threshold, with the words that are due.

A row is a robot and, by the names of its links, the word of each verdict; `says` stands in the reason of
one of them. The numbers of the thresholds are worked out beside the rows. `singular` tells whether the mass
matrix of a URDF is singular and `refused` whether MuJoCo refuses an MJCF model for the mass of a moving body:
long tests ask Pinocchio and MuJoCo.
"""

from __future__ import annotations

from typing import Final

from robot_texts import Row

from robot_rules.compiled import COMPILED, MARKS
from robot_rules.formats import FORMATS
from robot_rules.massless import MASSLESS
from robot_rules.room import ROOM
from robot_rules.tensors import TENSORS

__all__ = ["ROWS", "Row"]

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
