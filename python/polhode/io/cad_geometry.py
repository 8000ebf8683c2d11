"""Surfaces of CAD files as functions of two parameters; volume and moments of their solids, with a bound."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode._optional import require

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Surface = Callable[[Floats, Floats], tuple[Floats, Floats]]

__all__ = [
    "FaceSurface",
    "Moments",
    "check_occt",
    "moments_of_faces",
    "occt",
    "surface_of",
]


@cache
def occt(module: str, purpose: str = "reading CAD files (STEP, IGES)") -> Any:
    """Import a module of OCP by its short name, as in ``occt("TopoDS")``."""
    return require(f"OCP.{module}", extra="cad", purpose=purpose)


def check_occt(purpose: str) -> None:
    """Refuse with the line that installs OCCT where it is absent; it is not imported."""
    if find_spec("OCP") is None:
        require("OCP", extra="cad", purpose=purpose)


_QUARTER: Final = np.pi / 2.0


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
    """Return the surface of a face of OCCT, in the face's own place."""
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
        turned = _surface_of_revolution(*_frame(cylinder.Position()), cylinder.Radius(), 0.0)
        return FaceSurface(turned, around, none)
    if kind == kinds.GeomAbs_Cone:
        cone = adaptor.Cone()
        turned = _surface_of_revolution(*_frame(cone.Position()), cone.RefRadius(), cone.SemiAngle())
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
    return FaceSurface(_query_surface(adaptor), _intervals(adaptor, "U"), _intervals(adaptor, "V"))


def _frame(place: Any) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the origin and axes of a place, which may be left-handed."""
    points = (place.Location(), place.XDirection(), place.YDirection(), place.Direction())
    origin, x, y, z = (np.array([p.X(), p.Y(), p.Z()]) for p in points)
    return origin, x, y, z


def _turns(first: float, last: float) -> Floats:
    """Return the multiples of a right angle within a range; an endless one has those of four turns."""
    low, high = max(first, -8.0 * np.pi), min(last, 8.0 * np.pi)
    return _QUARTER * np.arange(np.floor(low / _QUARTER) - 8.0, np.ceil(high / _QUARTER) + 9.0)


def _plane(origin: Floats, x: Floats, y: Floats, _: Floats) -> Surface:
    normal = np.cross(x, y)

    def at(u: Floats, v: Floats) -> tuple[Floats, Floats]:
        return origin + u[:, None] * x + v[:, None] * y, np.broadcast_to(normal, (len(u), 3))

    return at


def _surface_of_revolution(
    origin: Floats, x: Floats, y: Floats, z: Floats, radius: float, angle: float
) -> Surface:
    """Return the cylinder and cone: a straight line turned about z, at `angle` to it."""
    sine, cosine = np.sin(angle), np.cos(angle)

    def at(u: Floats, v: Floats) -> tuple[Floats, Floats]:
        outward = np.cos(u)[:, None] * x + np.sin(u)[:, None] * y
        sideways = np.cos(u)[:, None] * y - np.sin(u)[:, None] * x
        r = (radius + v * sine)[:, None]
        along = sine * outward + cosine * z
        return origin + r * outward + (v * cosine)[:, None] * z, np.cross(r * sideways, along)

    return at


def _torus(origin: Floats, x: Floats, y: Floats, z: Floats, major: float, minor: float) -> Surface:
    """Compute the torus, and the sphere as one whose major radius is zero."""

    def at(u: Floats, v: Floats) -> tuple[Floats, Floats]:
        outward = np.cos(u)[:, None] * x + np.sin(u)[:, None] * y
        sideways = np.cos(u)[:, None] * y - np.sin(u)[:, None] * x
        cosine, sine = np.cos(v)[:, None], np.sin(v)[:, None]
        r = major + minor * cosine
        along = minor * (cosine * z - sine * outward)
        return origin + r * outward + minor * sine * z, np.cross(r * sideways, along)

    return at


def _query_surface(adaptor: Any) -> Surface:
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
    """Find where a surface that OCCT is asked for stops being smooth, and right angles where it may turn."""
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

    cuts_u, cuts_v = _repeat(knots_u, period_u), _repeat(knots_v, period_v)
    return FaceSurface(at, cuts_u, cuts_v)


def _knots(spline: Any, axis: str) -> Floats:
    """Return the knots, each as often as it counts."""
    count = getattr(spline, f"Nb{axis}Knots")()
    knot, times = getattr(spline, f"{axis}Knot"), getattr(spline, f"{axis}Multiplicity")
    return np.repeat([knot(i) for i in range(1, count + 1)], [times(i) for i in range(1, count + 1)])


def _repeat(knots: Floats, period: float) -> Floats:
    cuts = np.unique(knots)
    return cuts if period == 0.0 else np.unique(np.concatenate([cuts - period, cuts, cuts + period]))


def _within(t: Floats, knots: Floats, degree: int, period: float) -> Floats:
    first = knots[degree]
    return first + np.mod(t - first, period) if period > 0.0 else t


def _basis(t: Floats, knots: Floats, degree: int) -> tuple[NDArray[np.int64], Floats, Floats]:
    """Compute the basis functions that are not zero, and their derivatives, by de Boor's recurrence.

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


_COARSE, _FINE = (np.polynomial.legendre.leggauss(n) for n in (10, 15))
_TOLERANCE: Final = 1e-14
_DEEPEST: Final = 12
_MOST_POINTS: Final = 3_000_000
"""Of one face: then its pieces are taken as they are, and the bound says what that came to."""
_WHERE, _WEIGHTS = (
    0.5 + 0.5 * np.polynomial.legendre.leggauss(20)[0],
    0.5 * np.polynomial.legendre.leggauss(20)[1],
)
"""Parts of an edge at which it is looked at: not those through which curves are mostly laid."""
_PAIRS: Final = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
TERMS: Final = 14
"""Vector area (3), area, volume, first moments (3), second moments (6)."""


class Moments(NamedTuple):
    """Integrals over a solid.

    Attributes
    ----------
    area, volume : float
    first : numpy.ndarray, shape (3,)
        About `about`.
    second : numpy.ndarray, shape (3, 3)
        About `about`.
    about : numpy.ndarray, shape (3,)
        The middle of the solid.
    reach : float
        Half of the diagonal of the box around it.
    openness : float
        Length of the vector area, of which a closed boundary has none.
    loose : int
        How many edges do not belong to two faces, or twice to one.
    error : float
        Bound of the volume, of the first moments by `reach`, of the second ones by `reach` squared.
    """

    area: float
    volume: float
    first: Floats
    second: Floats
    about: Floats
    reach: float
    openness: float
    loose: int
    error: float


class _Piece(NamedTuple):
    """A stretch of an edge of a face, along the edge's curve in the plane of the parameters."""

    curve: Any
    start: float
    end: float
    sign: float


def moments_of_faces(faces: list[Any], about: Floats, reach: float) -> Moments:
    """Integrate over the solid within these faces of OCCT.

    Parameters
    ----------
    faces : list of TopoDS_Face
    about : numpy.ndarray, shape (3,)
        The middle of the box around them.
    reach : float
        Half of its diagonal.
    """
    total, error, gaps = np.zeros(TERMS), 0.0, _Gaps()
    for face in faces:
        found, missed = _over_face(face, about, reach, gaps)
        total += found
        error += missed
    second = np.empty((3, 3))
    for term, (i, j) in enumerate(_PAIRS):
        second[i, j] = second[j, i] = total[8 + term]
    openness = float(np.linalg.norm(total[:3]))
    # Faces that meet by halves leave strips open: their area, times what stands under the integral.
    error += gaps.area / reach**2 + openness + 64.0 * np.finfo(float).eps * total[3]
    return Moments(
        area=float(total[3]) * reach**2,
        volume=float(total[4]) * reach**3,
        first=total[5:8] * reach**4,
        second=second * reach**5,
        about=about,
        reach=reach,
        openness=openness * reach**2,
        loose=sum(uses != 2 for uses in gaps.uses.values()),
        error=error * reach**3,
    )


def _over_face(face: Any, about: Floats, reach: float, gaps: _Gaps) -> tuple[Floats, float]:
    """Compute the integrals over one face, in units of `reach`, and how well they are known."""
    abs_ = occt("TopAbs").TopAbs_Orientation
    if occt("BRep").BRep_Tool.Surface_s(face) is None:
        raise ValueError("a face is a mesh of triangles without a surface")
    surface = surface_of(face)
    sign = -1.0 if face.Orientation() == abs_.TopAbs_REVERSED else 1.0
    pieces = list(_pieces(face, surface, gaps))
    start = min((float(_uv(piece.curve, _fractions(piece))[0].min()) for piece in pieces), default=0.0)
    total, error, points = np.zeros(TERMS), 0.0, 0
    waiting = [(piece, 0) for piece in pieces]
    while waiting:
        piece, depth = waiting.pop()
        coarse, used = _along(piece, surface, start, about, reach, _COARSE, depth)
        fine, more = _along(piece, surface, start, about, reach, _FINE, depth)
        points += used + more
        difference = float(np.abs(fine - coarse).max())
        is_enough = difference <= max(_TOLERANCE, 1e-13 * float(np.abs(fine).max()))
        if is_enough or depth == _DEEPEST or points > _MOST_POINTS:
            total += sign * piece.sign * fine
            error += difference
            continue
        middle = 0.5 * (piece.start + piece.end)
        waiting.append((piece._replace(end=middle), depth + 1))
        waiting.append((piece._replace(start=middle), depth + 1))
    total[3] *= sign
    return total, error


def _pieces(face: Any, surface: FaceSurface, gaps: _Gaps) -> Iterator[_Piece]:
    """Return the stretches of the edges around a face within which the surface and the curves are smooth."""
    abs_ = occt("TopAbs")
    explorer = occt("TopExp").TopExp_Explorer
    shapes = occt("TopoDS").TopoDS
    tool = occt("BRep").BRep_Tool
    adaptor = occt("Geom2dAdaptor").Geom2dAdaptor_Curve
    forward = shapes.Face(face.Oriented(abs_.TopAbs_Orientation.TopAbs_FORWARD))
    edges = explorer(forward, abs_.TopAbs_ShapeEnum.TopAbs_EDGE)
    while edges.More():
        edge = shapes.Edge(edges.Current())
        edges.Next()
        orientation = edge.Orientation()
        if orientation in (abs_.TopAbs_Orientation.TopAbs_INTERNAL, abs_.TopAbs_Orientation.TopAbs_EXTERNAL):
            continue
        first, last = tool.Range_s(edge, forward)
        plane_curve = tool.CurveOnSurface_s(edge, forward, first, last)
        if plane_curve is None:
            raise ValueError("an edge has no curve on one of its faces")
        sign = -1.0 if orientation == abs_.TopAbs_Orientation.TopAbs_REVERSED else 1.0
        curve = adaptor(plane_curve, first, last)
        if not tool.Degenerated_s(edge):
            gaps.note(edge, surface, curve, first, last)
        cuts = _cuts(curve, first, last, surface)
        for start, end in pairwise(cuts):
            yield _Piece(curve, float(start), float(end), sign)


def _cuts(curve: Any, first: float, last: float, surface: FaceSurface) -> Floats:
    """Return the parameters of a curve between which nothing changes its formula."""
    kinds = occt("GeomAbs")
    numbers = occt("collections")
    smooth = kinds.GeomAbs_Shape.GeomAbs_CN
    count = curve.NbIntervals(smooth)
    knots = numbers.Array1_double(1, count + 1)
    curve.Intervals(knots, smooth)
    cuts = [knots.Value(i) for i in range(1, count + 2)]
    is_round = curve.GetType() in (
        kinds.GeomAbs_CurveType.GeomAbs_Circle,
        kinds.GeomAbs_CurveType.GeomAbs_Ellipse,
    )
    if is_round:
        cuts += np.linspace(first, last, 1 + int(np.ceil((last - first) / (np.pi / 2.0) - 1e-9))).tolist()
    cuts = sorted({*cuts, first, last})
    if len(surface.v_cuts):
        cuts += _crossings(curve, cuts, surface.v_cuts)
    inside = np.unique([cut for cut in cuts if first <= cut <= last])
    apart = np.concatenate([[True], np.diff(inside) > 1e-13 * (last - first)])
    return inside[apart] if inside[-1] == inside[apart][-1] else np.append(inside[apart][:-1], inside[-1])


def _crossings(curve: Any, cuts: list[float], levels: Floats) -> list[float]:
    """Find where a curve passes parameters v at which the surface changes its formula."""
    fractions = np.linspace(0.0, 1.0, 17)
    found: list[float] = []
    for start, end in pairwise(cuts):
        t = start + (end - start) * fractions
        v = _uv(curve, t)[1]
        for level in levels[(levels > v.min()) & (levels < v.max())].tolist():
            for k in np.flatnonzero((v[:-1] - level) * (v[1:] - level) < 0.0).tolist():
                low, high, rises = float(t[k]), float(t[k + 1]), v[k + 1] > v[k]
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    is_above = curve.Value(middle).Y() > level
                    low, high = (low, middle) if is_above == rises else (middle, high)
                found.append(0.5 * (low + high))
    return found


def _fractions(piece: _Piece) -> Floats:
    return piece.start + (piece.end - piece.start) * _WHERE


def _uv(curve: Any, t: Floats) -> tuple[Floats, Floats]:
    points = [curve.Value(x) for x in t.tolist()]
    return np.array([p.X() for p in points]), np.array([p.Y() for p in points])


def _along(
    piece: _Piece,
    surface: FaceSurface,
    start: float,
    about: Floats,
    reach: float,
    rule: tuple[Floats, Floats],
    depth: int,
) -> tuple[Floats, int]:
    """Integrate along a stretch of an edge what is integrated over u from `start` to it."""
    gp = occt("gp")
    nodes, weights = rule
    half = 0.5 * (piece.end - piece.start)
    point, slope = gp.gp_Pnt2d(), gp.gp_Vec2d()
    u, v, dv = np.empty(len(nodes)), np.empty(len(nodes)), np.empty(len(nodes))
    for row, t in enumerate((0.5 * (piece.start + piece.end) + half * nodes).tolist()):
        piece.curve.D1(t, point, slope)
        u[row], v[row], dv[row] = point.X(), point.Y(), slope.Y()
    scale = half * weights * dv
    if not np.abs(dv).max() * abs(half) > 1e-15 * (1.0 + float(np.abs(v).max())):
        return np.zeros(TERMS), 0
    all_u, all_v, all_w = [], [], []
    parts = 1 << min(depth, 5)
    for end, height, weight in zip(u.tolist(), v.tolist(), scale.tolist(), strict=True):
        low, high = min(start, end), max(start, end)
        inner = surface.u_cuts[(surface.u_cuts > low) & (surface.u_cuts < high)]
        cuts = np.concatenate([[low], inner, [high]])
        if parts > 1:
            cuts = np.unique(
                (cuts[:-1, None] + np.diff(cuts)[:, None] * np.arange(parts + 1) / parts).ravel()
            )
        wide = 0.5 * np.diff(cuts)[:, None]
        all_u.append((0.5 * (cuts[:-1] + cuts[1:])[:, None] + wide * nodes).ravel())
        all_v.append(np.full(wide.size * len(nodes), height))
        all_w.append((wide * weights).ravel() * (weight if end >= start else -weight))
    flat_u, flat_v, flat_w = np.concatenate(all_u), np.concatenate(all_v), np.concatenate(all_w)
    points, normals = surface.at(flat_u, flat_v)
    return _integrand((points - about) / reach, normals / reach**2, flat_w), len(flat_u)


def _integrand(x: Floats, n: Floats, w: Floats) -> Floats:
    wn, squares = w[:, None] * n, x * x
    terms = np.empty(TERMS)
    terms[:3] = wn.sum(axis=0)
    terms[3] = w @ np.linalg.norm(n, axis=1)
    terms[4] = np.einsum("ni,ni->", x, wn) / 3.0
    terms[5:8] = np.einsum("ni,ni->i", squares, wn) / 2.0
    for term, (i, j) in enumerate(_PAIRS):
        if i == j:
            terms[8 + term] = (squares[:, i] * x[:, i]) @ wn[:, i] / 3.0
        else:
            # The mean of the two ways: dx and dy are treated alike.
            terms[8 + term] = (
                (squares[:, i] * x[:, j]) @ wn[:, i] + (squares[:, j] * x[:, i]) @ wn[:, j]
            ) / 4.0
    return terms


class _Gaps:
    """How far the curves around faces lie from the edges in which the faces meet."""

    def __init__(self) -> None:
        self.area = 0.0
        self.uses: Counter[int] = Counter()

    def note(self, edge: Any, surface: FaceSurface, curve: Any, first: float, last: float) -> None:
        """Compare an edge with the curve that one of its faces has for it."""
        self.uses[hash(edge)] += 1
        of_edge = occt("BRep").BRep_Tool.Curve_s(edge, first, last)
        if of_edge is None:
            return
        t = first + (last - first) * _WHERE
        points = surface.at(*_uv(curve, t))[0]
        places = [of_edge.Value(x) for x in t.tolist()]
        apart = np.linalg.norm(points - [(p.X(), p.Y(), p.Z()) for p in places], axis=1)
        length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
        # Doubled, since it is seen at some points only.
        self.area += 2.0 * float(length * (_WEIGHTS @ apart))
