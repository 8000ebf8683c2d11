"""Surfaces of CAD files at many points at once: points and normals as functions of two parameters.

Planes, cylinders, cones, spheres and tori by their formulas, B-splines by their basis functions; any other
surface (swept, revolved, offset) is asked of OCCT, point by point.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode.files.cad_kernel import occt

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Surface = Callable[[Floats, Floats], tuple[Floats, Floats]]

__all__ = ["FaceSurface", "surface_of"]

_QUARTER: Final = np.pi / 2.0
_MOST_PIECES: Final = 10_000


@dataclass(frozen=True)
class FaceSurface:
    r"""The surface of a face, and where its formula changes.

    Attributes
    ----------
    at : callable
        Gives points :math:`S(u, v)` (n, 3) and :math:`S_u \times S_v` (n, 3).
    u_cuts, v_cuts : numpy.ndarray
        Parameters between which it is smooth and turns by a right angle at most, ascending; none where it is
        so everywhere.
    """

    at: Surface
    u_cuts: Floats
    v_cuts: Floats


def surface_of(face: Any) -> FaceSurface:
    """Give the surface of a face of OCCT, in the face's own place."""
    adaptor_module = occt("BRepAdaptor")
    kinds = occt("GeomAbs").GeomAbs_SurfaceType
    adaptor = adaptor_module.BRepAdaptor_Surface(face, False)
    kind = adaptor.GetType()
    none = np.empty(0)
    around = _turns(adaptor.FirstUParameter(), adaptor.LastUParameter())
    if kind == kinds.GeomAbs_Plane:
        place = adaptor.Plane().Position()
        return FaceSurface(_plane(*_frame(place)), none, none)
    if kind == kinds.GeomAbs_Cylinder:
        cylinder = adaptor.Cylinder()
        turned = _turned(*_frame(cylinder.Position()), cylinder.Radius(), 0.0)
        return FaceSurface(turned, around, none)
    if kind == kinds.GeomAbs_Cone:
        cone = adaptor.Cone()
        turned = _turned(*_frame(cone.Position()), cone.RefRadius(), cone.SemiAngle())
        return FaceSurface(turned, around, none)
    along = _turns(adaptor.FirstVParameter(), adaptor.LastVParameter())
    if kind == kinds.GeomAbs_Sphere:
        sphere = adaptor.Sphere()
        return FaceSurface(_torus(*_frame(sphere.Position()), 0.0, sphere.Radius()), around, along)
    if kind == kinds.GeomAbs_Torus:
        torus = adaptor.Torus()
        at = _torus(*_frame(torus.Position()), torus.MajorRadius(), torus.MinorRadius())
        return FaceSurface(at, around, along)
    if kind == kinds.GeomAbs_BSplineSurface:
        return _spline(adaptor)
    return FaceSurface(_asked(adaptor), _intervals(adaptor, "U"), _intervals(adaptor, "V"))


def _frame(place: Any) -> tuple[Floats, Floats, Floats, Floats]:
    """Origin and axes of a place, which may be left-handed."""
    points = (place.Location(), place.XDirection(), place.YDirection(), place.Direction())
    origin, x, y, z = (np.array([p.X(), p.Y(), p.Z()]) for p in points)
    return origin, x, y, z


def _turns(first: float, last: float) -> Floats:
    """Multiples of a right angle within a range; an endless one has those of four turns around zero."""
    low, high = max(first, -8.0 * np.pi), min(last, 8.0 * np.pi)
    return _QUARTER * np.arange(np.floor(low / _QUARTER) - 8.0, np.ceil(high / _QUARTER) + 9.0)


def _plane(origin: Floats, x: Floats, y: Floats, _: Floats) -> Surface:
    normal = np.cross(x, y)

    def at(u: Floats, v: Floats) -> tuple[Floats, Floats]:
        return origin + u[:, None] * x + v[:, None] * y, np.broadcast_to(normal, (len(u), 3))

    return at


def _turned(origin: Floats, x: Floats, y: Floats, z: Floats, radius: float, angle: float) -> Surface:
    """Cylinder and cone: a straight line turned about z, at `angle` to it."""
    sine, cosine = np.sin(angle), np.cos(angle)

    def at(u: Floats, v: Floats) -> tuple[Floats, Floats]:
        outward = np.cos(u)[:, None] * x + np.sin(u)[:, None] * y
        sideways = np.cos(u)[:, None] * y - np.sin(u)[:, None] * x
        r = (radius + v * sine)[:, None]
        along = sine * outward + cosine * z
        return origin + r * outward + (v * cosine)[:, None] * z, np.cross(r * sideways, along)

    return at


def _torus(origin: Floats, x: Floats, y: Floats, z: Floats, major: float, minor: float) -> Surface:
    """Torus, and the sphere as one whose major radius is zero."""

    def at(u: Floats, v: Floats) -> tuple[Floats, Floats]:
        outward = np.cos(u)[:, None] * x + np.sin(u)[:, None] * y
        sideways = np.cos(u)[:, None] * y - np.sin(u)[:, None] * x
        cosine, sine = np.cos(v)[:, None], np.sin(v)[:, None]
        r = major + minor * cosine
        along = minor * (cosine * z - sine * outward)
        return origin + r * outward + minor * sine * z, np.cross(r * sideways, along)

    return at


def _asked(adaptor: Any) -> Surface:
    gp = occt("gp")

    def at(u: Floats, v: Floats) -> tuple[Floats, Floats]:
        points, normals = np.empty((len(u), 3)), np.empty((len(u), 3))
        point, along_u, along_v = gp.gp_Pnt(), gp.gp_Vec(), gp.gp_Vec()
        for row, (a, b) in enumerate(zip(u.tolist(), v.tolist(), strict=True)):
            adaptor.D1(a, b, point, along_u, along_v)
            normal = along_u.Crossed(along_v)
            points[row] = point.X(), point.Y(), point.Z()
            normals[row] = normal.X(), normal.Y(), normal.Z()
        return points, normals

    return at


def _intervals(adaptor: Any, axis: str) -> Floats:
    """Where a surface that OCCT is asked for stops being smooth, and right angles where it may turn."""
    numbers = occt("collections")
    shapes = occt("GeomAbs").GeomAbs_Shape
    count = getattr(adaptor, f"Nb{axis}Intervals")(shapes.GeomAbs_CN)
    cuts = numbers.Array1_double(1, count + 1)
    getattr(adaptor, f"{axis}Intervals")(cuts, shapes.GeomAbs_CN)
    found = [cuts.Value(i) for i in range(1, count + 2)]
    extent = found[-1] - found[0]
    if extent <= 8.0 * np.pi:  # an angle, perhaps
        found += _turns(found[0], found[-1]).tolist()
    return np.unique(found)


def _spline(adaptor: Any) -> FaceSurface:
    spline = adaptor.BSpline()
    if spline.IsUPeriodic():
        spline.SetUNotPeriodic()
    if spline.IsVPeriodic():
        spline.SetVNotPeriodic()
    knots_u, knots_v = _knots(spline, "U"), _knots(spline, "V")
    rows, columns = spline.NbUPoles(), spline.NbVPoles()
    poles = np.empty((rows, columns, 4))
    for i in range(rows):
        for j in range(columns):
            pole, weight = spline.Pole(i + 1, j + 1), spline.Weight(i + 1, j + 1)
            poles[i, j] = weight * pole.X(), weight * pole.Y(), weight * pole.Z(), weight
    degree_u, degree_v = spline.UDegree(), spline.VDegree()
    period_u = knots_u[-degree_u - 1] - knots_u[degree_u] if adaptor.IsUPeriodic() else 0.0
    period_v = knots_v[-degree_v - 1] - knots_v[degree_v] if adaptor.IsVPeriodic() else 0.0

    def at(u: Floats, v: Floats) -> tuple[Floats, Floats]:
        u, v = _within(u, knots_u, degree_u, period_u), _within(v, knots_v, degree_v, period_v)
        first_u, basis_u, slope_u = _basis(u, knots_u, degree_u)
        first_v, basis_v, slope_v = _basis(v, knots_v, degree_v)
        over_u = first_u[:, None] + np.arange(degree_u + 1)
        over_v = first_v[:, None] + np.arange(degree_v + 1)
        near = poles[over_u[:, :, None], over_v[:, None, :]]
        along = np.einsum("nj,nijk->nik", basis_v, near)
        value = np.einsum("ni,nik->nk", basis_u, along)
        by_u = np.einsum("ni,nik->nk", slope_u, along)
        by_v = np.einsum("ni,nj,nijk->nk", basis_u, slope_v, near)
        weight = value[:, 3:]
        point = value[:, :3] / weight
        tangent_u = (by_u[:, :3] - by_u[:, 3:] * point) / weight
        tangent_v = (by_v[:, :3] - by_v[:, 3:] * point) / weight
        return point, np.cross(tangent_u, tangent_v)

    cuts_u, cuts_v = _repeated(knots_u, period_u), _repeated(knots_v, period_v)
    return FaceSurface(at, cuts_u, cuts_v)


def _knots(spline: Any, axis: str) -> Floats:
    """Give the knots, each as often as it counts."""
    count = getattr(spline, f"Nb{axis}Knots")()
    knot, times = getattr(spline, f"{axis}Knot"), getattr(spline, f"{axis}Multiplicity")
    return np.repeat([knot(i) for i in range(1, count + 1)], [times(i) for i in range(1, count + 1)])


def _repeated(knots: Floats, period: float) -> Floats:
    cuts = np.unique(knots)
    return cuts if period == 0.0 else np.unique(np.concatenate([cuts - period, cuts, cuts + period]))


def _within(t: Floats, knots: Floats, degree: int, period: float) -> Floats:
    first = knots[degree]
    return first + np.mod(t - first, period) if period > 0.0 else t


def _basis(t: Floats, knots: Floats, degree: int) -> tuple[NDArray[np.int64], Floats, Floats]:
    """Basis functions that are not zero, and their derivatives, by de Boor's recurrence.

    Returns the first of them for each parameter; beyond the ends the outermost polynomials go on.
    """
    span = np.clip(np.searchsorted(knots, t, side="right") - 1, degree, len(knots) - degree - 2)
    values = np.ones((len(t), 1))
    lower = values
    for k in range(1, degree + 1):
        lower = values
        grown = np.zeros((len(t), k + 1))
        for r in range(k):
            left, right = knots[span + r + 1 - k], knots[span + r + 1]
            share = lower[:, r] / (right - left)
            grown[:, r] += (right - t) * share
            grown[:, r + 1] += (t - left) * share
        values = grown
    slopes = np.zeros_like(values)
    for r in range(degree):
        left, right = knots[span + r + 1 - degree], knots[span + r + 1]
        share = degree * lower[:, r] / (right - left)
        slopes[:, r] -= share
        slopes[:, r + 1] += share
    return span - degree, values, slopes
