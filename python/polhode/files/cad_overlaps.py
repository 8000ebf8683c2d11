"""Solids of a CAD file that share matter: found by OCCT's boolean operations, and told.

What two solids share is a solid itself, whose faces are integrated as those of the file are. An operation
may fail, last long or end its process (:mod:`polhode.files.cad_apart` starts one for that): what was found
before stays, and the rest is told as not known.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode.files.cad_kernel import occt
from polhode.files.components import Overlap, told

if TYPE_CHECKING:
    from collections.abc import Sequence

    from polhode.files.cad_file import CadFile, CadPart

__all__ = ["Pair", "near_pairs", "overlaps_told", "volume_shared"]

_MOST_PAIRS: Final = 2000
_CONTACT: Final = 1e-9
"""What is shared by less than this, of the smaller one, is contact."""
_TWICE: Final = "what they share counts twice"


class Pair(NamedTuple):
    """Two solids by their numbers, the larger one first, and what they share in mm^3; None: not known."""

    large: int
    small: int
    volume: float | None


def overlaps_told(cad: CadFile, pairs: Sequence[Pair], fault: str = "") -> tuple[str, ...]:
    """Say which solids of a file overlap and by how much of their volume, and what of that is not known.

    Parameters
    ----------
    cad : CadFile
    pairs : sequence of Pair
        That were looked at.
    fault : str
        Why not all of :func:`near_pairs` were.
    """
    near = _meeting(cad.parts)
    if len(near) > _MOST_PAIRS:
        return (f"{len(near)} pairs of solids are near enough to overlap, too many to look at: {_TWICE}",)
    found = [
        Overlap(
            cad.parts[pair.large].name,
            cad.parts[pair.small].name,
            pair.volume * 1e-9,
            pair.volume >= (1.0 - _CONTACT) * cad.parts[pair.small].moments.volume,
        )
        for pair in pairs
        if pair.volume is not None and pair.volume > _CONTACT * cad.parts[pair.small].moments.volume
    ]
    total = sum(part.moments.volume for part in cad.parts) * 1e-9
    lines = [line.replace("component", "solid", 1) for line in told(found, total, " m^3")]
    unknown = [f"{cad.parts[i].name} and {cad.parts[k].name}" for i, k, volume in pairs if volume is None]
    if unknown:
        more = f" and of {len(unknown) - 3} more pairs" if len(unknown) > 3 else ""
        lines.append(
            f"whether solids overlap is not known of {', '.join(unknown[:3])}{more}: OCCT does not tell; "
            f"where they do, {_TWICE}"
        )
    if len(pairs) < len(near):
        lines.append(
            f"{fault}: {len(near) - len(pairs)} pairs of solids that are near enough to overlap were not "
            f"looked at; where they do, {_TWICE}"
        )
    return tuple(lines)


def near_pairs(parts: Sequence[CadPart]) -> list[tuple[int, int]]:
    """Give the pairs of solids that may share matter; none where they are too many to be looked at."""
    near = _meeting(parts)
    return near if len(near) <= _MOST_PAIRS else []


def _meeting(parts: Sequence[CadPart]) -> list[tuple[int, int]]:
    """Give the pairs whose spheres around their boxes meet, the larger one first."""
    middles = np.array([part.rotation @ part.moments.about + part.position for part in parts])
    reaches = np.array([part.moments.reach for part in parts])
    volumes = np.array([part.moments.volume for part in parts])
    order = np.argsort(-volumes, kind="stable")
    pairs = []
    for place, i in enumerate(order.tolist()):
        later = order[place + 1 :]
        near = np.linalg.norm(middles[later] - middles[i], axis=1) < reaches[later] + reaches[i]
        pairs += [(i, k) for k in later[near].tolist()]
    return pairs


def volume_shared(one: Any, other: Any, least: float) -> float | None:
    """Give the volume that two placed solids share, in mm^3; None where OCCT does not tell.

    Parameters
    ----------
    one, other : TopoDS_Solid
    least : float
        The smaller one's volume.
    """
    from polhode.files.cad_file import box_of, faces_of
    from polhode.files.cad_moments import moments_of_faces

    if _apart(one, other):
        return 0.0
    common = occt("BRepAlgoAPI").BRepAlgoAPI_Common(one, other)
    if not common.IsDone():
        return None
    shape = common.Shape()
    faces = [] if shape is None or shape.IsNull() else faces_of(shape)
    if not faces:
        return None if _holds_corner(one, other) or _holds_corner(other, one) else 0.0
    try:
        moments = moments_of_faces(faces, *box_of(shape))
    except ValueError:
        return None
    is_solid = moments.openness <= 1e-6 * moments.area and moments.error <= 1e-3 * least
    if not is_solid or not -_CONTACT * least <= moments.volume <= (1.0 + 1e-6) * least:
        return None
    return max(moments.volume, 0.0)


def _apart(one: Any, other: Any) -> bool:
    """Tell whether the boxes around two solids do not meet."""
    boxes = [occt("Bnd").Bnd_Box(), occt("Bnd").Bnd_Box()]
    for shape, box in zip((one, other), boxes, strict=True):
        occt("BRepBndLib").BRepBndLib.Add_s(shape, box)
    return bool(boxes[0].IsOut(boxes[1]))


def _holds_corner(outer: Any, inner: Any) -> bool:
    """Tell whether a corner of one solid lies well within the other, so that they share something."""
    from polhode.files.cad_file import within

    kinds = occt("TopAbs")
    classifier = occt("BRepClass3d").BRepClass3d_SolidClassifier(outer)
    for vertex in within(inner, kinds.TopAbs_ShapeEnum.TopAbs_VERTEX):
        classifier.Perform(occt("BRep").BRep_Tool.Pnt_s(occt("TopoDS").TopoDS.Vertex(vertex)), 1e-6)
        if classifier.State() == kinds.TopAbs_State.TopAbs_IN:
            return True
    return False
