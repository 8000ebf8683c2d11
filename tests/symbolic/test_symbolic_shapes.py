"""Tensors in letters: derived by integrals, and equal to the numbers of the core."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import polhode
import pytest

sympy = pytest.importorskip("sympy", reason="pip install sympy")
from polhode import symbolic  # noqa: E402 (needs SymPy)
from sympy import Rational, cos, pi, sin, sqrt  # noqa: E402

R, r, h, L, a, b, c, alpha = sympy.symbols("R r h L a b c alpha", positive=True)
t, u, v, z = sympy.symbols("t u v z", real=True)
ROUND = (t, 0, 2 * pi)
Piece = tuple[tuple[Any, ...], tuple[Any, ...]]


def ball(x: Any, y: Any, w: Any, lower: Any = 0, half: bool = False, up: Any = 0) -> Piece:
    """An ellipsoid with these semi-axes, in spherical coordinates; or its upper half, raised."""
    place = (u * sin(v) * cos(t) * x, u * sin(v) * sin(t) * y, u * cos(v) * w + up)
    return place, ((u, lower, 1), (v, 0, pi / 2 if half else pi), ROUND)


def turned(radius: Any, bottom: Any, top: Any, inner: Any = 0) -> Piece:
    """Between z = bottom and top, out to a radius, from a share of it on."""
    return (u * radius * cos(t), u * radius * sin(t), z), ((u, inner, 1), ROUND, (z, bottom, top))


def simplex(corners: list[tuple[Any, ...]]) -> Piece:
    """A triangle or tetrahedron with these corners."""
    first, *others = (sympy.Matrix(corner) for corner in corners)
    letters = (u, v, z)[: len(others)]
    place = first + sum((k * (o - first) for k, o in zip(letters, others, strict=True)), first * 0)
    limits = [(k, 0, 1 - sum(letters[:i])) for i, k in enumerate(letters)]
    return tuple(place), tuple(reversed(limits))


def scaled(piece: Piece, factor: Any) -> Piece:
    return tuple(factor * x for x in piece[0]), piece[1]


LOW = -a / sqrt(24)
PIECES: dict[str, list[Piece]] = {
    "box": [((u, v, z), ((u, -a / 2, a / 2), (v, -b / 2, b / 2), (z, -c / 2, c / 2)))],
    "cube": [((u, v, z), ((u, -a / 2, a / 2), (v, -a / 2, a / 2), (z, -a / 2, a / 2)))],
    "sphere": [ball(R, R, R)],
    "hollow_sphere": [
        ((u * sin(v) * cos(t), u * sin(v) * sin(t), u * cos(v)), ((u, r, R), (v, 0, pi), ROUND))
    ],
    "hemisphere": [ball(R, R, R, half=True)],
    "ellipsoid": [ball(a, b, c)],
    "cylinder": [turned(R, 0, h)],
    "tube": [((u * cos(t), u * sin(t), z), ((u, r, R), ROUND, (z, 0, h)))],
    "cone": [turned(R * (1 - z / h), 0, h)],
    "frustum": [turned(R + (r - R) * z / h, 0, h)],
    "capsule": [
        turned(R, -L / 2, L / 2),
        ball(R, R, R, half=True, up=L / 2),
        ball(R, R, -R, half=True, up=-L / 2),
    ],
    "torus": [
        (
            ((R + u * cos(v)) * cos(t), (R + u * cos(v)) * sin(t), u * sin(v)),
            ((u, 0, r), (v, 0, 2 * pi), ROUND),
        )
    ],
    "tetrahedron": [
        simplex(
            [
                (0, 0, a * sqrt(6) / 4),
                (a / sqrt(3), 0, LOW),
                (-a / sqrt(12), a / 2, LOW),
                (-a / sqrt(12), -a / 2, LOW),
            ]
        )
    ],
    "pyramid": [
        (
            (u * a * (1 - z / c), v * b * (1 - z / c), z),
            ((u, -Rational(1, 2), Rational(1, 2)), (v, -Rational(1, 2), Rational(1, 2)), (z, 0, c)),
        )
    ],
    "wedge": [((u, v, z), ((z, 0, c * (1 - u / a)), (u, 0, a), (v, -b / 2, b / 2)))],
    "disk": [((u * cos(t), u * sin(t)), ((u, 0, R), ROUND))],
    "annulus": [((u * cos(t), u * sin(t)), ((u, r, R), ROUND))],
    "ellipse": [((u * a * cos(t), u * b * sin(t)), ((u, 0, 1), ROUND))],
    "rectangle": [((u, v), ((u, -a / 2, a / 2), (v, -b / 2, b / 2)))],
    "rod": [((0, 0, z), ((z, -L / 2, L / 2),))],
    "ring": [((R * cos(t), R * sin(t), 0), (ROUND,))],
    "arc": [((R * cos(t), R * sin(t), 0), ((t, -alpha / 2, alpha / 2),))],
}
"""Places over their coordinates with the limits, innermost first: nothing of the table."""


@cache
def definite(part: Any, limit: Any) -> Any:
    """An integral that many terms share."""
    return sympy.integrate(part, limit)


def term_by_term(value: Any, limit: Any) -> Any:
    """The integral of a sum, over one letter."""
    whole = sympy.S.Zero
    for term in sympy.Add.make_args(sympy.expand(value)):
        factor, part = term.as_independent(limit[0])
        whole += factor * definite(part, limit)
    return whole


def integrated(pieces: list[Piece]) -> tuple[Any, Any]:
    """Measure, and ∫ r rᵀ dm/M about the centre of mass."""
    measure, first, second = sympy.S.Zero, sympy.zeros(3, 1), sympy.zeros(3, 3)
    for place, limits in pieces:
        at = sympy.Matrix(place)
        jacobian = at.jacobian([limit[0] for limit in limits])
        if jacobian.shape[0] == jacobian.shape[1]:
            element = sympy.simplify(sympy.sqrt(sympy.simplify(jacobian.det() ** 2)))
            element = sympy.simplify(jacobian.det()) if element.has(sympy.Abs) else element
        else:
            element = sympy.simplify(sympy.sqrt(sympy.simplify((jacobian.T * jacobian).det())))
        full = sympy.Matrix([*at, *[0] * (3 - len(at))])

        def over(value: Any, element: Any = element, limits: Any = limits) -> Any:
            value = value * element
            for limit in limits:
                value = term_by_term(value, limit)
            return value

        one = over(sympy.S.One)
        sign = 1 if one.subs({R: 2, r: 1, h: 1, L: 1, a: 1, b: 1, c: 1, alpha: 1}) > 0 else -1
        measure += sign * one
        first += sign * full.applyfunc(over)
        second += sign * sympy.Matrix(
            3, 3, lambda i, j, of=full, over=over: over(of[i] * of[j]) if i <= j else 0
        )
    second = sympy.Matrix(3, 3, lambda i, j: second[min(i, j), max(i, j)])
    center = first / measure
    return measure, second / measure - center * center.T


def tensor(second: Any) -> Any:
    return sympy.trace(second) * sympy.eye(3) - second


@pytest.mark.parametrize("name", PIECES)
def test_the_integrals_give_it(name: str) -> None:
    shape = symbolic.shape(name)
    measure, second = integrated(PIECES[name])
    assert sympy.simplify(measure - shape.measure) == 0
    assert sympy.simplify(shape.mass * tensor(second) - shape.inertia) == sympy.zeros(3, 3)


@pytest.mark.parametrize("n", [3, 4, 5, 6, 8])
def test_a_prism_is_made_of_triangles(n: int) -> None:
    shape = symbolic.shape("prism")
    numbers = {shape.sizes["sides"]: n, shape.sizes["radius"]: Rational(3, 2), shape.sizes["height"]: 2}
    turns = [sympy.N(2 * pi * k / n, 60) for k in range(n)]
    corners = [(cos(turn) * Rational(3, 2), sin(turn) * Rational(3, 2)) for turn in turns]
    area, flat = integrated([simplex([(0, 0), corners[k - 1], corners[k]]) for k in range(n)])
    want = tensor(flat + sympy.diag(0, 0, Rational(4, 12)))
    assert abs(sympy.N(2 * area - shape.measure.subs(numbers), 40)) < 1e-35
    assert max(abs(sympy.N(x, 40)) for x in want - shape.inertia.subs(numbers).subs(shape.mass, 1)) < 1e-35


@pytest.mark.parametrize("corners", [[(0, 0), (3, 1), (1, 4)], [(1, 1), (5, 0), (4, 4), (2, 2), (0, 3)]])
def test_polygons_are_made_of_triangles(corners: list[tuple[int, int]]) -> None:
    shape = symbolic.shape("polygon", corners=len(corners))
    ears = {3: [(0, 1, 2)], 5: [(0, 1, 3), (1, 2, 3), (0, 3, 4)]}[len(corners)]
    area, second = integrated([simplex([corners[k] for k in ear]) for ear in ears])
    numbers = dict(zip(shape.arguments[1:], sum(corners, ()), strict=True))
    assert shape.measure.subs(numbers) == area
    assert shape.inertia.subs(numbers) == shape.mass * tensor(second)
    if len(corners) == 3:
        triangle = symbolic.shape("triangle")
        assert sympy.simplify(triangle.inertia.subs(numbers) - shape.inertia.subs(numbers)) == sympy.zeros(
            3, 3
        )


def drawn(name: str, shape: Any, rng: np.random.Generator) -> dict[str, Any]:
    """Sizes for the numeric function."""
    if name in ("triangle", "polygon"):
        n = len(shape.sizes["vertices"])
        angles = np.sort((np.arange(n) + rng.uniform(-0.3, 0.3, n)) * 2 * np.pi / n)
        return {
            "vertices": rng.uniform(0.7, 1.5, (n, 1)) * np.stack([np.cos(angles), np.sin(angles)], -1) + 0.3
        }
    given: dict[str, Any] = {}
    for key, letters in shape.sizes.items():
        size = rng.uniform(0.5, 2.0, len(letters)) if isinstance(letters, tuple) else rng.uniform(0.5, 2.0)
        given[key] = rng.integers(3, 20) if key == "sides" else size
    if {"inner_radius", "minor_radius"} & set(given):
        small, large = (
            sorted(["inner_radius", "outer_radius"])
            if "inner_radius" in given
            else ("minor_radius", "major_radius")
        )
        given[small] = given[large] * rng.uniform(0.1, 1.0)
    if name == "arc":
        given["angle"] = rng.uniform(1.0, 6.2)
    return given


@pytest.mark.parametrize("name", symbolic.names())
def test_the_numbers_are_those_of_the_core(name: str, rng: np.random.Generator) -> None:
    shape = symbolic.shape(name, corners=5 if name == "polygon" else None)
    numeric: Callable[..., Any] = getattr(getattr(polhode, shape.room), name)
    tensors = shape.function()
    rest = symbolic.function(sympy.Matrix([shape.measure, *shape.moments]), shape.arguments)
    axes, center = (symbolic.function(one, shape.arguments) for one in (shape.axes, shape.center_of_mass))
    place = sympy.symbols("p_x p_y p_z")
    about = symbolic.function(shape.inertia_about(place), [*shape.arguments, *place])
    for _ in range(50):
        mass, given = rng.uniform(0.5, 3.0), drawn(name, shape, rng)
        body = numeric(**given, mass=mass)
        flat = [mass, *np.concatenate([np.ravel(value) for value in given.values()])]
        size = np.abs(body.inertia).max()
        assert np.abs(tensors(*flat) - body.inertia).max() <= 1e-14 * size
        measure, *moments = rest(*flat)
        assert measure == pytest.approx(numeric(**given, density=1.0).mass, rel=1e-14)
        assert np.abs(np.sort(moments) - body.principal_moments).max() <= 1e-14 * size
        V = axes(*flat)
        assert np.abs(V @ np.diag(moments) @ V.T - body.inertia).max() <= 2e-14 * size
        assert np.linalg.det(V) == pytest.approx(1.0, rel=1e-14)
        assert np.abs(center(*flat) - body.center_of_mass).max() <= 1e-14
        point = rng.normal(size=3)
        want = body.inertia_about(point)
        assert np.abs(about(*flat, *point) - want).max() <= 1e-14 * np.abs(want).max()


def test_all_shapes_are_there() -> None:
    rooms = {name: room for room in ("solids", "laminae", "rods") for name in getattr(polhode, room).__all__}
    assert {
        name: symbolic.shape(name, corners=4 if name == "polygon" else None).room for name in symbolic.names()
    } == rooms
    assert set(PIECES) | {"prism", "triangle", "polygon"} == set(rooms)


def test_latex_and_reprs() -> None:
    for name in symbolic.names():
        if name != "polygon":
            text = symbolic.shape(name).latex()
            assert text.count("{") == text.count("}")
            assert "I_1" in text
    assert symbolic.shape("cone").latex().endswith(r"I_3 = \frac{3 M R^{2}}{10}")
    assert symbolic.shape("cone")._repr_latex_().startswith("$\\displaystyle V")


def test_names_that_are_none() -> None:
    with pytest.raises(ValueError, match="'cilinder' is no shape; did you mean cylinder"):
        symbolic.shape("cilinder")
    with pytest.raises(ValueError, match="needs their number: shape"):
        symbolic.shape("polygon")
    with pytest.raises(ValueError, match="a polygon has at least 3, got 2"):
        symbolic.shape("polygon", corners=2)
    cone = symbolic.shape("cone")
    with pytest.raises(ValueError, match="the expression also holds R, h"):
        symbolic.function(cone.inertia, [cone.mass])
    with pytest.raises(TypeError, match=r"it takes 3 values \(M, R, h\), got 1"):
        cone.function()(1.0)
