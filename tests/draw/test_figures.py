"""What a body is drawn as: the shapes it was made of, in their places, wherever they are known."""

from __future__ import annotations

import copy
import pickle
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, laminae, rods, solids
from polhode.draw.shape import body_shape
from polhode.draw.triangles import solid_surface
from scipy.spatial.transform import Rotation

CORNERS = np.array([(0.0, 0, 0), (3, 0, 0), (0, 2, 0), (0, 0, 1)])
FACES = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
L_SHAPE = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]
COMB = [(0, 0), (7, 0), (7, 3), (6, 3), (6, 1), (4, 1), (4, 3), (3, 3), (3, 1), (1, 1), (1, 3), (0, 3)]

BODIES: dict[str, RigidBody] = {
    "box": solids.box((1, 2, 3), mass=2),
    "cube": solids.cube(2, mass=2),
    "wedge": solids.wedge((1, 2, 3), mass=2),
    "prism": solids.prism(5, 1, 2, mass=2),
    "pyramid": solids.pyramid((1, 2, 3), mass=2),
    "tetrahedron": solids.tetrahedron(2, mass=2),
    "sphere": solids.sphere(1, mass=2),
    "ellipsoid": solids.ellipsoid((1, 2, 3), mass=2),
    "hollow sphere": solids.hollow_sphere(1, 2, mass=2),
    "hemisphere": solids.hemisphere(1, mass=2),
    "cylinder": solids.cylinder(1, 2, mass=2),
    "cone": solids.cone(1, 2, mass=2),
    "tube": solids.tube(1, 2, 3, mass=2),
    "frustum": solids.frustum(2, 1, 3, mass=2),
    "capsule": solids.capsule(1, 2, mass=2),
    "torus": solids.torus(2, 1, mass=2),
    "disk": laminae.disk(2, mass=2),
    "annulus": laminae.annulus(1, 2, mass=2),
    "annulus without breadth": laminae.annulus(2, 2, mass=2),
    "ellipse": laminae.ellipse((2, 1), mass=2),
    "rectangle": laminae.rectangle((2, 1), mass=2),
    "triangle": laminae.triangle([(0, 0), (3, 0), (0, 1)], mass=2),
    "L": laminae.polygon(L_SHAPE, mass=2),
    "comb": laminae.polygon(COMB[::-1], mass=2),
    "rod": rods.rod(2, mass=2),
    "ring": rods.ring(2, mass=2),
    "arc": rods.arc(2, 1.0, mass=2),
    "arc in degrees": rods.arc(2, 57.29577951308232, mass=2, degrees=True),
    "mesh": RigidBody.from_mesh(CORNERS, FACES, mass=2),
    "surface": RigidBody.from_surface(CORNERS, FACES, mass=2),
    "wire": RigidBody.from_curve([(0, 0, 0), (1, 0, 0), (1, 0, 0), (1, 2, 0), (1, 2, 3)], mass=2),
    "particles": RigidBody.from_particles([1, 2, 0, 3], [(0, 0, 0), (1, 0, 0), (9, 0, 0), (1, 2, 3)]),
}
HOLLOW = {"hollow sphere"}
THIN = {"rod", "ring", "arc", "arc in degrees", "wire", "annulus without breadth"}
SHEETS = {"disk", "annulus", "ellipse", "rectangle", "triangle", "L", "comb", "surface"}


def drawn(body: RigidBody) -> tuple[np.ndarray, np.ndarray]:
    shape, notes = body_shape(body, np.zeros(3), is_cut=False)
    assert not notes
    assert len(shape.faces) == len(shape.colors)
    return shape.vertices, shape.faces


@pytest.mark.parametrize("name", BODIES)
def test_the_surface_has_the_inertia_of_the_body(name: str) -> None:
    """The mesh that is drawn, given back to polhode: an oracle but for the shapes that are drawn thick."""
    turned = Rotation.from_rotvec((0.3, -0.4, 1.2))
    body = BODIES[name].translated((0.3, 0.2, -0.1)).rotated(turned).scaled(length=1.5)
    vertices, faces = drawn(body)
    if name in SHEETS:
        whole = RigidBody.from_surface(vertices, faces[: len(faces) // 2], mass=2)
        other = RigidBody.from_surface(vertices, faces[len(faces) // 2 :], mass=2)
        assert other.isclose(whole)
    elif name == "particles":
        masses = np.repeat([1.0, 2.0, 3.0], len(vertices) // 3) / (
            len(vertices) // 3
        )  # that without mass is not drawn
        whole = RigidBody.from_particles(masses, vertices)
    else:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            whole = RigidBody.from_mesh(vertices, faces, mass=2, check=name not in THIN)
    size = float(np.sqrt(body.inertia.max() / body.mass))
    assert np.abs(whole.center_of_mass - body.center_of_mass).max() < 0.02 * size
    if name not in HOLLOW:
        assert np.abs(whole.inertia / whole.mass - body.inertia / body.mass).max() < 0.05 * size**2


def test_parts_stay_in_their_places() -> None:
    bar = solids.box((4, 1, 1), density=1).translated((0, 0, 0.5))
    stem = solids.cylinder(0.2, 3, density=1).translated((0, 0, -1.5))
    handle = (bar + stem).translated((1, 2, 3))
    shape, notes = body_shape(handle, handle.center_of_mass, is_cut=False)
    alone = [
        body_shape(part.translated((1, 2, 3)), handle.center_of_mass, is_cut=False)[0] for part in (bar, stem)
    ]
    assert not notes
    assert np.allclose(shape.vertices, np.concatenate([part.vertices for part in alone]), atol=1e-14)
    assert len(np.unique(shape.colors[:12], axis=0)) == 1
    assert set(map(tuple, shape.colors[:12])).isdisjoint(map(tuple, shape.colors[12:]))


def test_a_box_alone_has_six_colors_wherever_it_is_turned() -> None:
    cube = solids.cube(1.0, mass=1.0).rotated(
        Rotation.from_rotvec((0.1, 0.7, 0.2))
    )  # its principal axes are any
    shape, _ = body_shape(cube, np.zeros(3), is_cut=False)
    a, b, c = np.moveaxis(shape.vertices[shape.faces], 1, 0)
    normals = np.cross(b - a, c - a)
    by_color: dict[tuple[int, ...], list[np.ndarray]] = {}
    for color, normal in zip(shape.colors, normals, strict=True):
        by_color.setdefault(tuple(color), []).append(normal)
    assert len(by_color) == 6
    assert all(np.allclose(first, second) for first, second in by_color.values())


def test_every_way_keeps_the_shape(tmp_path: Path) -> None:
    ball = solids.sphere(1.0, mass=2.0)
    kept = {
        "pickle": pickle.loads(pickle.dumps(ball)),
        "copy": copy.deepcopy(ball),
        "sum": sum([ball]),
        "with_sigma": ball.with_sigma(mass=0.1),
        "with_covariance": ball.with_covariance(1e-6 * np.eye(10)),
        "with_error_bound": ball.with_error_bound(),
        "stack": RigidBody.stack([ball, solids.cube(1, mass=1)])[0],
        "iteration": next(iter(RigidBody.stack([ball, solids.cube(1, mass=1)]))),
        "of a stack": solids.sphere([1.0, 2.0], mass=2.0)[0],
        "combined": solids.sphere([1.0], mass=2.0).combined(),
        "pickle of an uncertain one": pickle.loads(pickle.dumps(ball.with_sigma(mass=0.1))),
    }
    for name, body in kept.items():
        assert np.array_equal(drawn(body)[0], drawn(ball)[0]), name
    wheels = laminae.disk(1.0, mass=2.0).translated([(0, 0, -1), (0, 0, 1)]).combined() + rods.rod(
        2.0, mass=3.0
    )
    assert np.allclose(np.ptp(drawn(wheels)[0], axis=0), 2.0, rtol=0.01)
    (tmp_path / "water.xyz").write_text("3\n\nO 0 0 0\nH 0.76 0.59 0\nH -0.76 0.59 0\n")
    assert len(drawn(RigidBody.from_file(tmp_path / "water.xyz"))[1]) == 3 * 32


def test_no_number_depends_on_it() -> None:
    ball = solids.sphere(1.0, mass=5.0)
    bare = RigidBody._from_numbers(ball.__reduce__()[1][0])
    assert ball == bare
    assert hash(ball) == hash(bare)
    assert repr(ball) == repr(bare)
    assert bare._figures() is None


def test_a_part_without_a_shape_is_the_box_of_its_inertia() -> None:
    part = RigidBody(
        mass=12.0, inertia=np.diag([13.0, 10.0, 5.0]), center_of_mass=(9, 0, 0)
    )  # of a box 1 × 2 × 3
    vertices, _ = drawn(part + solids.sphere(1.0, mass=1.0))
    assert np.allclose(np.ptp(vertices[vertices[:, 0] > 5.0], axis=0), (1, 2, 3))


LINES = [
    solids.cylinder(0, 1, mass=1),
    solids.cone(0, 1, mass=1),
    solids.capsule(0, 1, mass=1),
    solids.tube(0, 0, 1, mass=1),
    solids.prism(5, 0, 1, mass=1),
    solids.ellipsoid((0, 0, 0.5), mass=1),
    solids.box((0, 0, 1), mass=1),
    solids.wedge((0, 1, 0), mass=1),
    solids.pyramid((0, 0, 1), mass=1),
    laminae.ellipse((0.5, 0), mass=1),
    laminae.rectangle((0, 1), mass=1),
    laminae.triangle([(0, 0), (1, 0), (0.5, 0)], mass=1),
]
POINTS = [
    *(solid(0, mass=1) for solid in (solids.cube, solids.sphere, solids.hemisphere, solids.tetrahedron)),
    *(solid(0, 0, mass=1) for solid in (solids.cylinder, solids.capsule, solids.torus, solids.hollow_sphere)),
    *(solid(0, mass=1) for solid in (rods.rod, rods.ring, laminae.disk)),
    *(rods.arc(*numbers, mass=1) for numbers in ((0, 1), (1, 0))),
    laminae.annulus(0, 0, mass=1),
]


@pytest.mark.parametrize("number", range(len(LINES) + len(POINTS)))
def test_what_has_no_width_is_seen(number: int) -> None:
    """A line is drawn a little thick and a point as a ball, alone and beside other parts, where they are."""
    body = [*LINES, *POINTS][number].translated((5.0, 6.0, 7.0))
    length = 1.0 if number < len(LINES) else 0.0
    for whole, first in ((body, 0), (solids.cube(2.0, mass=1.0) + body, 12)):
        vertices, faces = drawn(whole)
        a, b, c = np.moveaxis(vertices[faces[first:]], 1, 0)
        area = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
        assert area > 0.005
        extent = np.sort(np.ptp(np.concatenate([a, b, c]), axis=0))
        assert extent[1] < 0.12 * max(np.ptp(vertices), 1.0)
        assert extent[2] == pytest.approx(length, rel=0.05) or (length == 0.0 and extent[2] == extent[1])
        assert (
            np.abs(np.concatenate([a, b, c]).mean(axis=0) - body.center_of_mass).max() < 0.3 * length + 0.01
        )


def test_what_is_taken_out_again_is_not_drawn() -> None:
    """Parts come and go in any order, while the body is moved: what is drawn are those that are left."""
    turn = Rotation.from_rotvec((0.2, -0.5, 0.9))
    base, lid = solids.cube(4.0, density=1.0), solids.cylinder(0.5, 1.0, density=1.0).translated((0, 0, 2.5))
    bolt = solids.cube(0.3, density=1.0).translated((0, 2.15, 0))

    def moved(body: RigidBody) -> RigidBody:
        return body.translated((1.0, 2.0, -3.0)).rotated(turn).scaled(length=1.5, mass=2.0)

    without = moved(base + bolt)
    for body in (
        moved(base + lid + bolt) - moved(lid),
        moved((base + lid) - lid + bolt),
        moved((base - bolt) + bolt + bolt),
        moved(base + lid + bolt) - moved(lid) + moved(lid) - moved(lid),
    ):
        assert body.isclose(without)
        assert np.allclose(drawn(body)[0], drawn(without)[0], rtol=0.0, atol=1e-12)
    twice = (base + lid + lid) - lid  # one of them is left
    assert len(drawn(twice)[0]) == len(drawn(base + lid)[0])
    _, notes = body_shape((base + lid) - lid.translated((1e-6, 0, 0)), np.zeros(3), is_cut=False)
    assert notes == ("parts taken out of the body are not drawn: 1",)


def test_parts_taken_out_are_told(tmp_path: Path) -> None:
    body = solids.box((4, 4, 4), density=1.0) - solids.sphere(1.0, density=1.0).translated((0.5, 0, 0))
    shape, (note,) = body_shape(body, np.zeros(3), is_cut=False)
    assert note == "parts taken out of the body are not drawn: 1"
    assert np.allclose(np.ptp(shape.vertices, axis=0), 4.0)
    with pytest.warns(UserWarning, match="not drawn: 1"):
        body.simulate([0.0, 0.5, 1.0], omega=(0, 0, 1)).animate(tmp_path / "body.html")


@pytest.mark.parametrize(("count", "is_kept"), [(256, True), (257, False)])
def test_many_parts(count: int, is_kept: bool) -> None:
    body: Any = sum(solids.cube(0.1, mass=1.0).translated((k, 0, k % 3)) for k in range(count))
    shape, notes = body_shape(body, np.zeros(3), is_cut=False)
    assert len(shape.faces) == (12 * count if is_kept else 12)
    assert ("too many parts" in "".join(notes)) is not is_kept
    more, notes = body_shape(body + solids.cube(1.0, mass=1.0), np.zeros(3), is_cut=False)
    assert len(more.faces) == 12
    assert "too many parts" in notes[0]


@pytest.mark.parametrize(("count", "is_kept"), [(256, True), (257, False)])
def test_many_particles(count: int, is_kept: bool) -> None:
    positions = np.random.default_rng(count).normal(size=(count, 3))
    assert (RigidBody.from_particles(np.ones(count), positions)._figures() is not None) is is_kept


@pytest.mark.parametrize(("count", "is_kept"), [(64, True), (65, False)])
def test_large_stacks(count: int, is_kept: bool) -> None:
    assert (solids.cube(np.full(count, 2.0), mass=1.0)._figures() is not None) is is_kept


@pytest.mark.parametrize(("count", "is_kept"), [(20_000, True), (20_001, False)])
def test_large_meshes(count: int, is_kept: bool) -> None:
    faces = np.tile(FACES, (count // 4 + 1, 1))[:count]
    body = RigidBody.from_surface(CORNERS, faces, mass=1.0)
    assert (body._figures() is not None) is is_kept


def signed_volume(body: RigidBody) -> float:
    """What the faces that are drawn span, seen from outside."""
    vertices, faces = drawn(body)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


BRICK = np.array([(x, y, z) for x in (0.0, 1.0) for y in (0.0, 2.0) for z in (0.0, 3.0)])
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CLOSED = np.array([face for a, b, c, d in SIDES for face in ((a, b, c), (a, c, d))])
OPEN = CLOSED[:-2]
TWO = np.concatenate([BRICK, BRICK + np.array((5.0, 0.0, 0.0))])
HOLLOWED = np.concatenate([BRICK, 0.5 * BRICK + np.array((0.25, 0.5, 0.75))])


@pytest.mark.parametrize(
    ("vertices", "faces", "options"),
    [
        (BRICK, CLOSED, {}),
        (BRICK, OPEN, {"closure": "caps"}),
        (BRICK, OPEN[:, ::-1], {"closure": "caps", "orient": True}),
        (BRICK, OPEN, {"closure": "hull"}),
        (BRICK, OPEN[:, ::-1], {"closure": "hull"}),
        (BRICK, OPEN[:4], {"closure": "hull"}),
        (BRICK, CLOSED[:, ::-1], {"orient": True}),
        (BRICK, CLOSED, {"orient": True}),
        (TWO, np.concatenate([CLOSED, CLOSED[:, ::-1] + 8]), {"orient": True}),
        (TWO, np.concatenate([CLOSED[:, ::-1], CLOSED[:, ::-1] + 8]), {"orient": True}),
        (HOLLOWED, np.concatenate([CLOSED, CLOSED[:, ::-1] + 8]), {"orient": True}),
        (HOLLOWED, np.concatenate([CLOSED[:, ::-1], CLOSED + 8]), {"orient": True}),
    ],
)
def test_the_surface_that_was_summed_is_drawn(vertices: Any, faces: Any, options: dict[str, Any]) -> None:
    """Not the open or inverted mesh that was given."""
    body = RigidBody.from_mesh(vertices, faces, density=1.0, **options)
    assert signed_volume(body) == pytest.approx(float(body.mass), rel=1e-12)
    shown = RigidBody.from_mesh(*drawn(body), density=1.0)
    np.testing.assert_allclose(shown.inertia, body.inertia, rtol=1e-12, atol=1e-12)


# Surfaces of solids: closed, outward, with the moments of the solid as they get finer.

SOLIDS: list[tuple[str, tuple[float, ...]]] = [
    ("cuboid", (1.0, 2.0, 3.0)),
    ("cube", (2.0,)),
    ("wedge", (1.0, 2.0, 3.0)),
    ("pyramid", (1.0, 2.0, 3.0)),
    ("tetrahedron", (2.0,)),
    ("cylinder", (1.5, 0.7)),
    ("tube", (0.5, 1.5, 0.7)),
    ("cone", (1.5, 2.0)),
    ("frustum", (1.5, 0.5, 2.0)),
    ("frustum", (1.5, 0.0, 2.0)),
    ("sphere", (1.5,)),
    ("ellipsoid", (1.0, 2.0, 0.5)),
    ("hemisphere", (1.5,)),
    ("capsule", (0.5, 2.0)),
    ("torus", (2.0, 0.5)),
    ("prism", (5, 1.5, 2.0)),
]
BY_SIZE = {"cuboid": "box", "wedge": "wedge", "pyramid": "pyramid", "ellipsoid": "ellipsoid"}
"""Those that take their lengths as one argument."""


@pytest.mark.parametrize(("name", "numbers"), SOLIDS)
def test_it_is_the_solid(name: str, numbers: tuple[float, ...]) -> None:
    make = getattr(solids, BY_SIZE.get(name, name))
    exact = make(numbers, density=2.0) if name in BY_SIZE else make(*numbers, density=2.0)
    off = []
    for segments in (40, 160):
        surface = solid_surface(name, np.array(numbers), segments)
        assert surface is not None
        drawn = RigidBody.from_mesh(*surface, density=2.0)  # closed and outward, or this is an error
        assert np.allclose(drawn.center_of_mass, exact.center_of_mass, atol=0.02)
        off.append(np.abs(drawn.inertia - exact.inertia).max() / exact.inertia.max() + 1e-13)
    assert off[0] < 0.05
    assert off[1] < off[0] / 12.0 or off[0] < 1e-12  # by the square of the segments


def test_others_have_none() -> None:
    assert solid_surface("disk", np.array([1.0])) is None
    assert solid_surface("", np.array([])) is None
