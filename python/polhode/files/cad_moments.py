r"""Volume and moments of a solid whose faces are surfaces: integrals over its boundary, with a bound.

By the theorem of Gauss an integral over the solid is one over its faces,

.. math:: \int x_i^2\,dV = \tfrac13 \oint x_i^3\,n_i\,dA, \qquad
          \int x_i x_j\,dV = \tfrac12 \oint x_i^2 x_j\,n_i\,dA,

and by that of Green one over a face is one along the curves around it in the plane of its parameters,

.. math:: \int_D G\,du\,dv = \oint_{\partial D} \Big(\int_{u_0}^{u} G\,du'\Big)\,dv,

done by Gauss's rule in pieces within which everything is smooth. Each piece is computed twice, by 10 and by
15 points each way, and halved where the two differ; what is left of the difference is in the bound.
"""

from __future__ import annotations

from collections import Counter
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode.files.cad_kernel import occt
from polhode.files.cad_surfaces import surface_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from polhode.files.cad_surfaces import FaceSurface

    Floats = NDArray[np.float64]

__all__ = ["Moments", "moments_of_faces"]

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
    """Integrals over one face, in units of `reach`, and how well they are known."""
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
    """Stretches of the edges around a face within which the surface and the curves are smooth."""
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
    """Parameters of a curve between which nothing changes its formula."""
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
    """Where a curve passes parameters v at which the surface changes its formula."""
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
