"""The components of a mesh: their volumes, and where those wound alike overlap, so that matter counts twice.

A surface wound inward is a cavity of the component around it. Two that are wound outward are both full: what
they share is counted twice, unless they are joined, which :mod:`polhode.io.union` does.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeVar

import numpy as np

from polhode._format import Argument
from polhode.errors import PolhodeError
from polhode.io.mesh import weld
from polhode.io.union import has_union, is_closed, shared_volume

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

T = TypeVar("T")

__all__ = [
    "MOST_FACES",
    "MOST_PARTS",
    "OTHERS",
    "Overlap",
    "Part",
    "assign",
    "describe_overlaps",
    "groups_of",
    "labels",
    "meeting",
    "overlapping",
    "overlaps",
    "parts_of",
    "winding",
]

# Winding numbers are taken at so many corners at most: each looks at every face.
_SAMPLES: Final = 12
MOST_PARTS: Final = 200
# What is shared by less than this, of the smaller one, is contact.
_CONTACT: Final = 1e-9
_MOST_TOLD: Final = 8
# What components share is told beside other things from this part of their volume on.
_LITTLE: Final = 1e-3
# Beside other things, meshes of more triangles are not searched for components that overlap.
MOST_FACES: Final = 50_000
# Nor are components with more triangles than this, counted once for each pair whose boxes meet.
_MOST_PAIRED: Final = 50_000
# As a part of lengths (and of areas): nearer than this a ray does not tell on which side it passes.
OTHERS: Final = "*"
"""Stands for all components that nothing else names."""
_SHOWN: Final = 12
_NEAR: Final = 1e-9
_ASKEW: Final = np.array([[2.0, -3.0, 6.0], [6.0, -2.0, -3.0], [3.0, 6.0, 2.0]]) / 7.0
"""A rotation: edges of parts run along the axes, and rays should not meet them."""


class Part(NamedTuple):
    """A component with its cavities.

    Attributes
    ----------
    name : str
        Of its group in the file, else its number from 1.
    vertices : numpy.ndarray, shape (n, 3)
        Of the whole mesh.
    faces : numpy.ndarray, shape (m, 3)
        Its own and those of its cavities, outward.
    volume : float
        Without the cavities.
    cavities : int
    was_inward : bool
        Whether its surface faced inward in the mesh.
    group, material : str
        Names that the file gives to all of its faces, which other components may have too; "" for none.
    """

    name: str
    vertices: Floats
    faces: Integers
    volume: float
    cavities: int
    was_inward: bool = False
    group: str = ""
    material: str = ""


class Overlap(NamedTuple):
    """Two parts that share matter.

    Attributes
    ----------
    one, other : str
        Their names, the larger one first.
    volume : float
        What they share; not a number where that was not computed.
    is_inside : bool
        Whether the other lies within the one.
    """

    one: str
    other: str
    volume: float
    is_inside: bool


def labels(faces: Integers, count: int) -> NDArray[np.intp]:
    """Return the number of the component of each face: a component is the faces that share vertices."""
    label = np.arange(count)
    corners = np.ascontiguousarray(faces.T)
    while True:
        own = label[corners]
        least = own.min(axis=0)
        if (own == least).all():
            break
        # What a vertex is joined to by its label goes along with it, and then paths are cut short.
        for labels_of_corner in own:
            np.minimum.at(label, labels_of_corner, least)
        while not np.array_equal(shorter := label[label], label):
            label = shorter
    _, first, found = np.unique(label[corners[0]], return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.intp)
    rank[np.argsort(first)] = np.arange(len(first))
    numbered: NDArray[np.intp] = rank[found.reshape(-1)]
    return numbered


def parts_of(
    vertices: Floats,
    faces: Integers,
    groups: Sequence[str] | None = None,
    most: int = MOST_PARTS,
    materials: Sequence[str] | None = None,
) -> list[Part]:
    """Take a closed mesh apart.

    Parameters
    ----------
    vertices : numpy.ndarray, shape (n, 3)
    faces : numpy.ndarray, shape (m, 3)
    groups : sequence of str, optional
        The name of the group of each face.
    most : int
        How many components are told apart.
    materials : sequence of str, optional
        The name of the material of each face.

    Returns
    -------
    list of Part
        One for each component that is no cavity, in the order of the faces, turned where it faced inward; one
        for all where there are more than `most`.
    """
    if not is_closed(faces):  # by its vertices, of which several may stand at one place
        vertices, faces, _ = weld(vertices, faces, "")
    label = labels(faces, len(vertices))
    count = int(label.max(initial=-1)) + 1
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2.0 if len(vertices) else 0.0
    corners = vertices[faces] - middle
    six = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    volumes = np.bincount(label, weights=six, minlength=count) / 6.0
    is_turned = bool(volumes.sum() < 0.0)
    if is_turned:
        faces, volumes = faces[:, ::-1], -volumes
    if not 1 < count <= most:
        own = (_name_of_all(names, range(len(names or ()))) for names in (groups, materials))
        return [Part("1", vertices, faces, float(volumes.sum()), 0, is_turned, *own)]
    order, starts = np.argsort(label, kind="stable"), np.cumsum(np.bincount(label))[:-1]
    of = np.split(order, starts)
    outer = [k for k in range(count) if volumes[k] > 0.0]
    holes: dict[int, list[int]] = {k: [] for k in outer}
    if len(outer) < count:
        low, high = (ends[order] for ends in _boxes(corners))
        low, high = (np.minimum.reduceat(low, [0, *starts]), np.maximum.reduceat(high, [0, *starts]))
    seen: dict[int, tuple[Floats, Floats, Floats]] = {}
    for k in (k for k in range(count) if volumes[k] <= 0.0):
        around = [o for o in outer if (low[k] >= low[o]).all() and (high[k] <= high[o]).all()]
        for o in (o for o in around if o not in seen):
            turned_away = corners[of[o]] @ _ASKEW
            seen[o] = turned_away, *_boxes(turned_away)
        point = corners[of[k][0], 0] @ _ASKEW
        around = [o for o in around if _is_inside(point, *seen[o])]
        if around:
            holes[min(around, key=lambda o: volumes[o])].append(k)
    nested = {k for inside in holes.values() for k in inside}
    least = -1e-14 * np.abs(volumes).sum()  # a sheet of no thickness has the volume of its rounding errors
    turned = [k for k in range(count) if volumes[k] < least and k not in nested]
    if turned:
        faces = faces.copy()
        faces[np.isin(label, turned)] = faces[np.isin(label, turned), ::-1]
        volumes[turned] *= -1.0
        holes |= {k: [] for k in turned}
        outer = sorted(holes)
    names = _names([groups[of[k][0]] if groups else "" for k in outer])
    return [
        Part(
            name,
            vertices,
            faces[np.concatenate([of[k], *(of[hole] for hole in holes[k])])],
            float(volumes[k] + sum(volumes[hole] for hole in holes[k])),
            len(holes[k]),
            is_turned != (k in turned),
            _name_of_all(groups, of[k]),
            _name_of_all(materials, of[k]),
        )
        for k, name in zip(outer, names, strict=True)
    ]


def _name_of_all(names: Sequence[str] | None, faces: Iterable[int]) -> str:
    """Return the name that all these faces have; "" where they differ."""
    found = {names[face] for face in faces} if names else set()
    return found.pop() if len(found) == 1 else ""


def meeting(parts: Sequence[Part]) -> list[tuple[int, int]]:
    """Return the pairs of parts whose boxes meet, the larger one first."""
    used = [part.vertices[part.faces] for part in parts]
    low = np.array([corners.min(axis=(0, 1)) for corners in used])
    high = np.array([corners.max(axis=(0, 1)) for corners in used])
    volumes = np.array([part.volume for part in parts])
    pairs = []
    for i in np.argsort(-volumes, kind="stable").tolist():
        meet = (np.maximum(low, low[i]) < np.minimum(high, high[i])).all(axis=1)
        later = (volumes < volumes[i]) | ((volumes == volumes[i]) & (np.arange(len(parts)) > i))
        pairs += [(i, k) for k in np.flatnonzero(meet & later).tolist()]
    return pairs


def overlaps(parts: Sequence[Part], pairs: Sequence[tuple[int, int]] | None = None) -> list[Overlap]:
    """Find the parts that share matter, among those whose boxes meet.

    With manifold3d the shared volumes are computed. Without it parts are told that hold corners of one
    another, of which up to 12 are tried, and the volume only of one that lies within another.
    """
    found: list[Overlap] = []
    for i, k in meeting(parts) if pairs is None else pairs:
        one, other = parts[i], parts[k]
        shared = _shared(one, other, one.vertices[one.faces], other.vertices[other.faces])
        if shared is not None:
            found.append(shared)
    return found


def _shared(large: Part, small: Part, of_large: Floats, of_small: Floats) -> Overlap | None:
    if has_union():
        volume = shared_volume((large.vertices, large.faces), (small.vertices, small.faces))
        if volume <= _CONTACT * small.volume:
            return None
        if volume > 0.0:
            return Overlap(large.name, small.name, volume, volume >= (1.0 - _CONTACT) * small.volume)
        # What manifold3d takes for no solid is looked at as without it.
    inside = _share_inside(of_small, of_large)
    if 0.0 < inside < 1.0:
        return Overlap(large.name, small.name, float("nan"), False)
    around = _share_inside(of_large, of_small)
    if inside == 1.0 and around == 0.0:
        return Overlap(large.name, small.name, small.volume, True)
    return Overlap(large.name, small.name, float("nan"), False) if inside > 0.0 or around > 0.0 else None


def winding(points: Floats, triangles: Floats) -> Floats:
    """Compute how often a surface winds around points: 1 within, 0 without, by solid angles of faces."""
    totals = []
    for point in points:
        a, b, c = np.moveaxis(triangles - point, 1, 0)
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        top = np.einsum("ij,ij->i", a, np.cross(b, c))
        ab, bc, ca = (np.einsum("ij,ij->i", x, y) for x, y in ((a, b), (b, c), (c, a)))
        totals.append(np.arctan2(top, la * lb * lc + ab * lc + bc * la + ca * lb).sum() / (2.0 * np.pi))
    return np.array(totals)


def _share_inside(of: Floats, triangles: Floats) -> float:
    """Return the share of the corners of one, or of up to 12 of them, that lie within the other."""
    corners = np.unique(of.reshape(-1, 3), axis=0)
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    near = corners[((corners > low) & (corners < high)).all(axis=1)]
    if not len(near):
        return 0.0
    tried = near[np.linspace(0, len(near) - 1, min(len(near), _SAMPLES)).astype(int)]
    inside = (winding(tried, triangles) > 0.75).mean()  # on a face it is 0.5, on an edge less
    return float(inside) if len(near) == len(corners) else float(inside) * 0.5


def _boxes(triangles: Floats) -> tuple[Floats, Floats]:
    """Return the lower and the upper corners of the boxes around triangles."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def _is_inside(point: Floats, triangles: Floats, low: Floats, high: Floats) -> bool:
    """Return whether a closed surface is around a point, from the boxes of its triangles too.

    Triangles are counted that a ray upward from the point crosses, by the sign of their normals; where it
    passes near an edge, or the point near a face, the solid angles decide.
    """
    x, y, z = point
    above = (low[:, 0] <= x) & (high[:, 0] >= x) & (low[:, 1] <= y) & (high[:, 1] >= y) & (high[:, 2] >= z)
    few = triangles[above] - point
    a, b = few[..., :2], np.roll(few[..., :2], -1, axis=1)
    areas = (
        a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    )  # beside each edge, of the triangles seen from above
    total = areas.sum(axis=1)
    heights = (areas * np.roll(few[..., 2], -2, axis=1)).sum(axis=1)  # times `total`
    crossed = (areas > 0.0).all(axis=1) | (areas < 0.0).all(axis=1)
    reach = np.abs(few).max(initial=0.0)
    near_edge = (np.abs(areas) <= _NEAR * reach**2).any(axis=1)
    near_face = crossed & (np.abs(heights) <= _NEAR * reach * np.abs(total))
    if near_edge.any() or near_face.any():
        return bool(abs(winding(point[None], triangles)[0]) > 0.5)
    up = crossed & (heights * np.sign(total) > 0.0)
    return bool(abs(np.sign(total[up]).sum()) > 0.5)


def describe_overlaps(found: Sequence[Overlap], total: float, unit: str = "") -> list[str]:
    """Say which parts overlap and by how much of the total volume, the largest first."""
    lines = []
    for one, other, volume, is_inside in sorted(
        (each for each in found if np.isfinite(each.volume)), key=lambda each: -each.volume
    ):
        how = f"component {other} lies within {one}" if is_inside else f"components {one} and {other} overlap"
        lines.append(f"{how}: {volume:.4g}{unit} ({100.0 * volume / total:.3g} % of the volume) counts twice")
    left = len(lines) - _MOST_TOLD
    if left > 0:
        lines[_MOST_TOLD:] = [f"{left} more pairs of components overlap"]
    unknown = [f"{each.one} and {each.other}" for each in found if not np.isfinite(each.volume)]
    if unknown:
        more = f" and {len(unknown) - _MOST_TOLD} pairs more" if len(unknown) > _MOST_TOLD else ""
        pairs = ", ".join(unknown[:_MOST_TOLD]) + more
        way = "how much is not known" if has_union() else 'pip install "polhode[union]" tells how much'
        lines.append(f"components {pairs} overlap: what they share counts twice; {way}")
    return lines


def overlapping(vertices: Floats, faces: Integers, unit: str = " m^3") -> list[str]:
    """Say which components of a mesh overlap by more than a thousandth; nothing of a large mesh.

    Parameters
    ----------
    vertices : numpy.ndarray, shape (n, 3)
    faces : numpy.ndarray, shape (m, 3)
    unit : str
        Of volumes.
    """
    if len(faces) > MOST_FACES:
        return []
    parts = parts_of(vertices, faces)
    if len(parts) < 2:
        return []
    pairs = meeting(parts)
    if sum(len(parts[i].faces) + len(parts[k].faces) for i, k in pairs) > _MOST_PAIRED:
        return [f"its {len(parts)} components were not searched for overlaps; polhode report does it"]
    total = sum(part.volume for part in parts)
    found = [
        each for each in overlaps(parts, pairs) if not each.volume < _LITTLE * total
    ]  # or it is not known
    return describe_overlaps(found, total, unit)


def assign(given: Mapping[Any, T], names: Sequence[Sequence[str]], where: str = "") -> list[T | None]:
    """Assign each component what is given for it, by name or number.

    Parameters
    ----------
    given : mapping
        By a name, by the number of the component, counted from 1, or ``"*"`` for all others.
    names : sequence of sequence of str
        Of each component, the most specific one first; "" is no name.
    where : str
        Of the file, for errors.

    Returns
    -------
    list
        None for a component of which nothing is said. What names a component more specifically goes first.

    Raises
    ------
    PolhodeError
        When a name or number is that of no component; the names are listed.
    """
    found: list[T | None] = [given.get(OTHERS)] * len(names)
    rank = [1 << 30] * len(names)
    for key, value in given.items():
        if key == OTHERS:
            continue
        text = str(key).strip()
        of_key = [(k, of.index(text)) for k, of in enumerate(names) if text in of]
        if not of_key and text.isdecimal() and 1 <= int(text[:9]) <= len(names):
            of_key = [(int(text) - 1, -1)]
        if not of_key or not text:
            every = dict.fromkeys(name for of in names for name in of if name)
            known = ", ".join([*every][:_SHOWN]) + (" …" if len(every) > _SHOWN else "")
            at = f"{where} has" if where else "there is"
            raise PolhodeError(
                Argument("density"),
                f": {at} no component {key!r}; give one density for each of {known}, by name or by number "
                f'from 1 to {len(names)}, and "{OTHERS}" for all others',
            )
        for k, place in of_key:
            if place < rank[k]:
                found[k], rank[k] = value, place
    return found


def groups_of(path: Path) -> tuple[list[str], list[str]]:
    """Return the group (``o``, else ``g``) and the material of each triangle of an unpacked OBJ file."""
    found: list[str] = []
    materials: list[str] = []
    names = {"o": "", "g": "", "usemtl": ""}
    with path.open(encoding="utf-8", errors="replace") as lines:
        for line in lines:
            pieces = [line]
            # A backslash at the end joins a line with the next, but for comments.
            while not line.lstrip().startswith("#") and pieces[-1].rstrip().endswith("\\"):
                pieces[-1] = pieces[-1].rstrip()[:-1]
                pieces.append(next(lines, ""))
            words = " ".join(pieces).split()
            if words and words[0] in names:
                names[words[0]] = " ".join(words[1:])
            elif words and words[0] == "f":
                corners = next((i for i, word in enumerate(words) if word.startswith("#")), len(words)) - 1
                found += [names["o"] or names["g"]] * (corners - 2)
                materials += [names["usemtl"]] * (corners - 2)
    return found, materials


def _names(found: list[str]) -> list[str]:
    """Return for each part the name of its group, if no other part has it, else its number."""
    counts = Counter(found)
    own = [name if name and counts[name] == 1 else "" for name in found]
    named = [name or str(number) for number, name in enumerate(own, start=1)]
    if len(set(named)) < len(named):  # a name is the number of another part
        named = [
            str(number) if not name or name.isdecimal() else name for number, name in enumerate(own, start=1)
        ]
    return named
