"""Picture of a body that rolls: its surface, the plane below it, and the traces of the contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode.draw.shape import Shape, body_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import Trajectory

    Floats = NDArray[np.float64]

__all__ = ["Ground", "ground_of", "surface_shape"]

_RINGS, _SEGMENTS = 20, 40
_TINT: Final = np.array([158, 197, 224])
_SHADE: Final = 0.84
"""Factor of a colour for the dark quarters that show how a body turns."""


@dataclass(frozen=True)
class Ground:
    """The plane on which a body rolls, and where it touches.

    Attributes
    ----------
    normal : numpy.ndarray, shape (3,)
        Of the plane, toward the body, in space.
    middle : numpy.ndarray, shape (3,)
        A point of the plane; that about which it turns.
    turntable : float
        Rate of the plane about its normal.
    center : numpy.ndarray, shape (T, 3)
        The centre of mass in space, at every sample.
    contact : numpy.ndarray, shape (T, 3)
        The point of contact in space.
    in_body : numpy.ndarray, shape (T, 3)
        The same from the centre of mass, components in the body frame.
    outward : numpy.ndarray, shape (T, 3)
        The normal of the surface there, outward, components in the body frame.
    friction : numpy.ndarray, shape (T,)
        The friction needed.
    touches : numpy.ndarray of bool, shape (T,)
        Whether the body touches the plane; where it flies the contact is its lowest point.
    """

    normal: Floats
    middle: Floats
    turntable: float
    center: Floats
    contact: Floats
    in_body: Floats
    outward: Floats
    friction: Floats
    touches: NDArray[np.bool_]

    def axes(self, t: float) -> Floats:
        """Return two unit vectors along the plane, as rows; they turn with it."""
        first = _across(self.normal)
        second = np.cross(self.normal, first)
        cosine, sine = np.cos(self.turntable * t), np.sin(self.turntable * t)
        return np.array([cosine * first + sine * second, cosine * second - sine * first])


def ground_of(trajectory: Trajectory) -> Ground | None:
    """Return the plane on which the one body of a trajectory rolls; None where there is none."""
    contact, plane = trajectory.contact, trajectory._contact
    if contact is None or plane is None:
        return None
    return Ground(
        normal=plane.normal,
        middle=plane.point,
        turntable=plane.turntable,
        center=trajectory.position,
        contact=contact.point,
        in_body=contact.point_in_body - trajectory.body.center_of_mass,
        outward=-_core.rotate(trajectory.quaternion, plane.normal, inverse=True),
        friction=contact.friction_needed,
        touches=contact.phase != "flying",
    )


def surface_shape(surface: _core.Surface, about: Floats) -> Shape:
    """Return the surface itself as it is drawn, from a point of the body; its quarters have two shades."""
    parts: Any = surface.__reduce__()
    kind, arguments = parts[0].__name__, parts[1]
    if kind == "paraboloid":
        radii, apex, axes = arguments
        return _paraboloid(radii, apex, axes, about)
    solid: Any
    if kind == "sphere":
        radius, center = arguments
        solid = _core.sphere(radius, mass=1.0)
    elif kind == "ellipsoid":
        semi_axes, center, axes = arguments
        solid = _core.ellipsoid(semi_axes, mass=1.0)
        solid = solid if axes is None else solid.rotated(np.asarray(axes))
    else:
        *sizes, axis, center = arguments
        made: Any = _core.torus if kind == "torus" else _core.cylinder
        solid = made(sizes[0], sizes[1] if kind == "torus" else 0.0, mass=1.0)
        solid = solid.rotated(_from_z(np.asarray(axis, dtype=np.float64)))
    return body_shape(solid.translated(center), about)[0]


def _from_z(axis: Floats) -> Floats:
    """Return a rotation matrix that takes z to a direction."""
    z = axis / np.linalg.norm(axis)
    x = _across(z)
    return np.stack([x, np.cross(z, x), z], axis=-1)


def _across(direction: Floats) -> Floats:
    """Return a unit vector across a unit vector; along x for z."""
    k = int(np.abs(direction).argmin())
    found = np.eye(3)[k] - direction[k] * direction
    return np.asarray(found / np.linalg.norm(found))


def _paraboloid(radii: Any, apex: float, axes: Any, about: Floats) -> Shape:
    """Return a paraboloid up to its rim, closed by a lid."""
    part = np.linspace(0.0, 1.0, _RINGS + 1)[1:, np.newaxis]
    angle = np.linspace(0.0, 2.0 * np.pi, _SEGMENTS, endpoint=False)
    reach = np.sqrt(2.0 * apex * np.asarray(radii, dtype=np.float64))
    ring = np.stack(
        [
            part * reach[0] * np.cos(angle),
            part * reach[1] * np.sin(angle),
            np.broadcast_to(apex * (part**2 - 1.0), (_RINGS, _SEGMENTS)),
        ],
        axis=-1,
    )
    points = np.concatenate([[[0.0, 0.0, -apex]], ring.reshape(-1, 3), [[0.0, 0.0, 0.0]]])
    near = np.arange(_SEGMENTS)
    far = (near + 1) % _SEGMENTS
    faces = [np.stack([np.zeros_like(near), 1 + far, 1 + near], axis=-1)]
    for k in range(_RINGS - 1):
        low, high = 1 + k * _SEGMENTS, 1 + (k + 1) * _SEGMENTS
        faces.append(np.stack([low + near, low + far, high + far], axis=-1))
        faces.append(np.stack([low + near, high + far, high + near], axis=-1))
    rim = 1 + (_RINGS - 1) * _SEGMENTS
    faces.append(np.stack([np.full_like(near, len(points) - 1), rim + near, rim + far], axis=-1))
    triangles = np.concatenate(faces)
    middle = points[triangles].mean(axis=1)
    shade = np.where(middle[:, 0] * middle[:, 1] > 0.0, _SHADE, 1.0)
    if axes is not None:
        points = points @ np.asarray(axes).T
    return Shape(points - about, triangles, np.outer(shade, _TINT).round().astype(np.int64))
