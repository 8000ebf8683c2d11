"""Where the parts of an assembly share space, so that matter counts twice.

Solids and closed meshes are compared. The volume that two spheres share has a closed form; else manifold3d
(extra ``union``) computes it from the triangles of both. Round solids are taken with two numbers of facets,
and the volume is extrapolated to smooth ones: their facets differ by the square of their size.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from polhode.assembly.result import Overlap
from polhode.draw.triangles import solid_surface
from polhode.errors import MeshError
from polhode.io.components import Part, overlaps
from polhode.io.union import has_union, is_closed, shared_volume

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Any

    from numpy.typing import NDArray

    from polhode._core import RigidBody
    from polhode.assembly.tables import Place

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]
    Surface = tuple[Floats, Integers]

__all__ = ["Form", "Instance", "find_overlaps", "overlap_notes"]

_FINE, _COARSE = 64, 32
"""Facets around a round solid."""
_LITTLE: Final = 1e-3
"""A shared volume below this fraction of the smaller part is contact."""
_MOST_PARTS: Final = 3000
_MOST_PAIRS: Final = 20_000
_MOST_SURFACES: Final = 300
"""Largest number of surfaces of solids, which are made only for near parts."""
_MOST_SIDES: Final = 1000
_MOST_TRIANGLES: Final = 400_000
"""Largest number of triangles of the compared parts, counted once for each pair."""
_MOST_TOLD: Final = 8
_FLAT: Final = ("box", "cube", "prism", "pyramid", "tetrahedron", "wedge")


class Form:
    """The shape of a part in its own axes, in metres.

    Parameters
    ----------
    solid : str
        Name of a shape; "" for a mesh.
    arguments : mapping
        Of that shape.
    mesh : (vertices, faces), optional
    """

    def __init__(self, solid: str, arguments: Mapping[str, Any], mesh: Surface | None = None) -> None:
        self.solid = solid
        self._mesh = mesh if mesh is None or _volume_of(mesh) > 0.0 else (mesh[0], mesh[1][:, ::-1])
        self._numbers = np.concatenate([np.ravel(value) for value in arguments.values()] or [np.empty(0)])
        self._known: dict[int, Surface | None] = {}

    @property
    def is_round(self) -> bool:
        """Whether the surface is curved, so that the facets only approximate it."""
        return self._mesh is None and self.solid not in _FLAT

    @property
    def radius(self) -> float | None:
        """Radius, if the form is a sphere."""
        return float(self._numbers[0]) if self.solid == "sphere" else None

    def surface(self, segments: int = _FINE) -> Surface | None:
        """Return its triangles, outward; None where it has no volume that triangles bound."""
        if self._mesh is not None:
            return self._mesh
        if self.solid == "prism" and self._numbers[0] > _MOST_SIDES:
            return None
        if segments not in self._known:
            name = "cuboid" if self.solid == "box" else self.solid
            found = solid_surface(name, self._numbers, segments)
            if self.solid == "hollow_sphere" and found is not None:  # the picture shows no cavity
                inner, outer = self._numbers
                points, corners = found
                cavity = corners[:, ::-1] + len(points)
                found = np.concatenate([points, points * (inner / outer)]), np.concatenate([corners, cavity])
            self._known[segments] = found
        return self._known[segments]

    @cached_property
    def volume(self) -> float:
        """Volume in m^3; NaN if the form has no volume."""
        surface = self.surface()
        if surface is None:
            return math.nan
        if self.radius is not None:
            return 4.0 / 3.0 * math.pi * self.radius**3
        if not self.is_round:
            return _volume_of(surface)
        return _smooth(_volume_of(surface), _volume_of(self.surface(_COARSE) or surface))[0]

    @property
    def key(self) -> tuple[object, ...]:
        """A key that is equal only for equal forms."""
        return self.solid, self._numbers.tobytes(), 0 if self._mesh is None else len(self._mesh[1])

    @cached_property
    def reach(self) -> tuple[Floats, Floats]:
        """Opposite corners of a wide bounding box, which is cheap to compute."""
        if self._mesh is None:  # a solid with its centre of mass at the origin is within the sum of its sizes
            size = float(np.abs(self._numbers[1 if self.solid == "prism" else 0 :]).sum())
            return np.full(3, -size), np.full(3, size)
        vertices, faces = self._mesh
        corners = vertices[faces.reshape(-1)] if len(faces) else np.zeros((1, 3))
        return corners.min(axis=0), corners.max(axis=0)

    @property
    def is_made(self) -> bool:
        """Whether the triangles have been computed."""
        return self._mesh is not None or _FINE in self._known

    @cached_property
    def box(self) -> tuple[Floats, Floats] | None:
        """Opposite corners of the box around it; None where it cannot be compared."""
        surface = self.surface()
        if surface is None or not len(surface[1]) or not self.volume > 0.0 or not is_closed(surface[1]):
            return None
        corners = surface[0][surface[1]]
        low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
        # Facets lie within what is round, by less than a hundredth of it.
        more = 0.01 * (high - low) if self.is_round else 0.0
        return (low - more, high + more) if np.isfinite(low).all() and np.isfinite(high).all() else None


class Instance(NamedTuple):
    """A part at its place."""

    name: str
    body: RigidBody
    place: Place
    form: Form | None


def find_overlaps(parts: Sequence[Instance]) -> tuple[list[Overlap], list[str]]:
    """Find the parts that share space; return notes on the parts that were not compared.

    Parameters
    ----------
    parts : sequence of Instance

    Returns
    -------
    overlaps : list of Overlap
        The largest first, those of which the volume is not known at the end.
    notes : list of str
    """
    found, twins = _at_one_place(parts)
    shown = [
        part
        for k, part in enumerate(parts)
        if k not in twins and part.form and np.isfinite(part.form.reach).all()
    ]
    notes = []
    if len(shown) > _MOST_PARTS:
        notes.append(f"{len(shown)} parts with volumes are more than {_MOST_PARTS}: they were not compared")
        shown = []
    left, unmade = _MOST_TRIANGLES, _MOST_SURFACES
    pairs, unseen = _meeting(shown)
    for i, k in pairs:
        pair = shown[i], shown[k]
        if (volume := _of_spheres(*pair)) is not None:
            found += _describe_overlap(*pair, volume, 0.0)
            continue
        making = sum(not part.form.is_made for part in pair if part.form)
        if making > unmade:
            unseen += 1
            continue
        unmade -= making
        if not _near(*pair):
            continue
        count = sum(map(_triangles, pair))
        if count > left:
            unseen += 1
            continue
        left -= count
        found += _shared(*pair)
    if unseen:
        notes.append(
            f"{unseen} pairs of parts that may be near each other were not compared: there are more than "
            f"{_MOST_PAIRS} pairs, {_MOST_SURFACES} solids or {_MOST_TRIANGLES} triangles"
        )
    found.sort(key=lambda each: -each.volume if math.isfinite(each.volume) else math.inf)
    return found, notes


def _at_one_place(parts: Sequence[Instance]) -> tuple[list[Overlap], set[int]]:
    """Find parts that are the same as an earlier one, bit for bit, at the same place."""
    first: dict[tuple[object, ...], int] = {}
    found, twins = [], set()
    for k, part in enumerate(parts):
        body = part.body
        form_key = part.form.key if part.form is not None else ()
        key = (float(body.mass), body.center_of_mass.tobytes(), body.inertia.tobytes(), *form_key)
        if key in first:
            twins.add(k)
            form = parts[first[key]].form
            volume = form.volume if form is not None else math.nan
            found.append(Overlap("same", parts[first[key]].name, part.name, volume))
        else:
            first[key] = k
    return found, twins


def _meeting(parts: Sequence[Instance]) -> tuple[list[tuple[int, int]], int]:
    """Find pairs that may be near each other, by wide boxes along the axes of the whole; count the rest."""
    if not parts:
        return [], 0
    boxes = np.array([part.form.reach for part in parts if part.form])  # of shape (n, 2, 3)
    middles, reach = _boxes(parts, boxes)
    pairs: list[tuple[int, int]] = []
    more = 0
    for i in range(len(parts) - 1):
        meet = np.flatnonzero((np.abs(middles[i + 1 :] - middles[i]) < reach[i + 1 :] + reach[i]).all(axis=1))
        taken = meet[: _MOST_PAIRS - len(pairs)]
        pairs += [(i, i + 1 + k) for k in taken.tolist()]
        more += len(meet) - len(taken)
    return pairs, more


def _near(one: Instance, other: Instance) -> bool:
    """Return whether the boxes around the triangles of two parts meet."""
    known = [part.form.box for part in (one, other) if part.form]
    if None in known:
        return False
    middles, reach = _boxes((one, other), np.array(known))
    return bool((np.abs(middles[1] - middles[0]) < reach[0] + reach[1]).all())


def _boxes(parts: Sequence[Instance], boxes: Floats) -> tuple[Floats, Floats]:
    """Return the middle and half sides of the bounding box of each part, along the axes of the whole."""
    turns = np.array([part.place.rotation for part in parts])
    shifts = np.array([part.place.displacement for part in parts])
    middles = np.einsum("nij,nj->ni", turns, boxes.mean(axis=1)) + shifts
    return middles, np.einsum("nij,nj->ni", np.abs(turns), np.ptp(boxes, axis=1) / 2.0)


def _triangles(part: Instance) -> int:
    surface = part.form.surface() if part.form else None
    return len(surface[1]) if surface else 0


def _of_spheres(one: Instance, other: Instance) -> float | None:
    """Compute the volume that two spheres share, in closed form; None for other solids."""
    if one.form is None or other.form is None or one.form.radius is None or other.form.radius is None:
        return None
    a, b = one.form.radius, other.form.radius
    d = float(np.linalg.norm(one.place.displacement - other.place.displacement))
    if d >= a + b:
        return 0.0
    if d <= abs(a - b):
        return 4.0 / 3.0 * math.pi * min(a, b) ** 3
    # Two caps of heights h on both sides of the plane in which the spheres cut each other.
    volume = 0.0
    for r, s in ((a, b), (b, a)):
        h = r - (d * d + r * r - s * s) / (2.0 * d)
        volume += math.pi * h * h * (3.0 * r - h) / 3.0
    return volume


def _shared(one: Instance, other: Instance) -> list[Overlap]:
    """Compare two parts by their triangles."""
    assert one.form is not None  # parts without a form are not compared
    assert other.form is not None
    if not has_union():
        pair = [
            Part(part.name, *_place_surface(part, _FINE), part.form.volume, 0)
            for part in (one, other)
            if part.form is not None
        ]
        return [
            Overlap("inside" if each.is_inside else "across", each.one, each.other, each.volume)
            for each in overlaps(sorted(pair, key=lambda part: -part.volume), [(0, 1)])
        ]
    fine = _volume(one, other, _FINE)
    if not (one.form.is_round or other.form.is_round):
        return _describe_overlap(one, other, fine, 0.0)
    return _describe_overlap(one, other, *_smooth(fine, _volume(one, other, _COARSE)))


def _describe_overlap(one: Instance, other: Instance, volume: float, doubt: float) -> list[Overlap]:
    """Return the overlap of two parts that share this volume; nothing if they only touch."""
    large, small = sorted((one, other), key=lambda part: -(part.form.volume if part.form else 0.0))
    whole = small.form.volume if small.form else math.nan
    if volume <= max(_LITTLE * whole, doubt):
        return []
    is_inside = volume >= (1.0 - _LITTLE) * whole
    return [Overlap("inside" if is_inside else "across", large.name, small.name, volume)]


def _volume(one: Instance, other: Instance, segments: int) -> float:
    try:
        return shared_volume(_place_surface(one, segments), _place_surface(other, segments))
    except MeshError:
        return math.nan


def _smooth(fine: float, coarse: float) -> tuple[float, float]:
    """Extrapolate a volume to more and more facets; with it how much it has changed by as many again."""
    return fine + (fine - coarse) / 3.0, abs(fine - coarse)


def _volume_of(surface: Surface) -> float:
    a, b, c = np.moveaxis(surface[0][surface[1]], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


def _place_surface(part: Instance, segments: int) -> Surface:
    surface = part.form.surface(segments) if part.form else None
    assert surface is not None
    vertices, faces = surface
    if np.linalg.det(part.place.rotation) < 0.0:  # a mirror image: turned outward again
        faces = faces[:, ::-1]
    return vertices @ part.place.rotation.T + part.place.displacement, faces


def overlap_notes(found: Sequence[Overlap]) -> list[str]:
    """Say which parts overlap, the first of them one by one."""
    same: dict[str, list[str]] = {}
    for each in found:
        if each.kind == "same":
            same.setdefault(each.one, []).append(each.other)
    lines = []
    for one, others in [*same.items()][:_MOST_TOLD]:
        names = ", ".join(others[:_MOST_TOLD]) + (" and more" if len(others) > _MOST_TOLD else "")
        are = f"part {names} is" if len(others) == 1 else f"parts {names} are"
        lines.append(
            f"{are} the same as {one}, at the same place: the mass counts {len(others) + 1} times; position, "
            "step or turn moves a part"
        )
    crossing = [each for each in found if each.kind != "same"]
    for kind, one, other, volume in crossing[:_MOST_TOLD]:
        much = f"{volume:.4g} m^3" if math.isfinite(volume) else "what they share"
        how = f"part {other} lies within {one}" if kind == "inside" else f"parts {one} and {other} overlap"
        lines.append(f"{how}: {much} counts twice")
    left = max(len(crossing) - _MOST_TOLD, 0) + max(len(same) - _MOST_TOLD, 0)
    if left:
        lines.append(f"{left} more parts overlap others")
    if any(not math.isfinite(each.volume) for each in crossing) and not has_union():
        lines.append('pip install "polhode[union]" tells how much they share')
    return lines
