"""A body in a window: surface, principal axes, ellipsoid of inertia; what all windows share."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode._hints import check_kind, with_hints
from polhode._optional import require
from polhode.draw.shape import body_shape, check_one, given_shape, longest
from polhode.draw.style import AXIS_COLORS, OUTLINE_COLOR
from polhode.draw.surface import inertia_semi_axes, principal_circles

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from pyvista import Plotter, PolyData

    from polhode import RigidBody
    from polhode.draw.shape import Shape

    Floats = NDArray[np.float64]

__all__ = [
    "AXIS_STYLE",
    "add_name",
    "add_surface",
    "arrow",
    "body",
    "ellipsoid",
    "line",
    "new_plotter",
    "principal_axes",
    "pyvista",
    "rigid_body",
    "show_all",
    "surface",
]

_FEATURE_ANGLE: Final = 40.0
_ELLIPSOID_COLOR: Final = "#9DB2CF"


@with_hints
def body(
    vertices: ArrayLike,
    faces: ArrayLike,
    plotter: Plotter | None = None,
    *,
    opacity: float = 1.0,
    length_label: str | None = None,
    name: str = "body",
) -> Plotter:
    """Show a mesh as a shaded body with its sharp edges.

    Parameters
    ----------
    vertices : array_like, shape (n, 3)
        Corners.
    faces : array_like of int, shape (m, 3)
        Triangles, counted from 0.
    plotter : pyvista.Plotter, optional
        Where to show it; a new one by default.
    opacity : float
        Opacity of the surface, from 0 to 1.
    length_label : str, optional
        Word for the unit of the coordinates at their axes; without it the axes are not drawn. It converts no
        number.
    name : str
        Name of the actors; another body of that name is replaced.

    Returns
    -------
    pyvista.Plotter

    Examples
    --------
    >>> from polhode import view
    >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    >>> faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    >>> plotter = view.body(corners, faces)  # doctest: +SKIP
    >>> plotter.show()  # doctest: +SKIP
    """
    plotter = new_plotter() if plotter is None else plotter
    add_surface(plotter, given_shape(vertices, faces, np.zeros(3)), name, opacity)
    if length_label is not None:
        titles = {f"{axis}title": f"{axis} ({length_label})" for axis in "xyz"}
        counts = {f"n_{axis}labels": 3 for axis in "xyz"}
        plotter.show_bounds(grid="back", location="outer", color="#555555", font_size=12, **titles, **counts)
    plotter.reset_camera()
    return plotter


def principal_axes(
    rigid_body: RigidBody,
    plotter: Plotter | None = None,
    *,
    length: float = 1.0,
    center: ArrayLike | None = None,
    labels: tuple[str, str, str] = ("e1", "e2", "e3"),
    name: str = "axes",
) -> Plotter:
    """Show the principal axes of one body through its centre of mass.

    Parameters
    ----------
    rigid_body : RigidBody
        One body.
    plotter : pyvista.Plotter, optional
        Where to show them; a new one by default.
    length : float
        Length from the centre to each tip.
    center : array_like, shape (3,), optional
        Where to show the centre of mass; at its own position by default.
    labels : tuple of str
        Labels at the tips, in the order of ascending moments.
    name : str
        Name of the actors; other axes of that name are replaced.

    Returns
    -------
    pyvista.Plotter
    """
    check_kind(rigid_body, "rigid_body", "RigidBody")
    check_one(rigid_body.shape, "body")
    plotter = new_plotter() if plotter is None else plotter
    origin = _core.real_numbers(rigid_body.center_of_mass if center is None else center, "center")
    for k, (color, axis) in enumerate(zip(AXIS_COLORS, rigid_body.principal.axes.T, strict=True)):
        mesh = line(origin - length * axis, origin + length * axis, 0.008 * length)
        plotter.add_mesh(mesh, color=color, name=f"{name}-{k}", **AXIS_STYLE)
        add_name(plotter, origin + 1.1 * length * axis, labels[k], color, f"{name}-label-{k}")
    middle = pyvista().Sphere(radius=0.02 * length, center=origin)
    plotter.add_mesh(middle, color="black", name=f"{name}-center", **AXIS_STYLE)
    show_all(plotter)
    return plotter


def ellipsoid(
    body: RigidBody,
    plotter: Plotter | None = None,
    *,
    size: float = 1.0,
    center: ArrayLike | None = None,
    opacity: float = 1.0,
    name: str = "ellipsoid",
) -> Plotter:
    """Show the ellipsoid of inertia about the centre of mass and the principal axes.

    Parameters
    ----------
    body : RigidBody
        One body.
    plotter : pyvista.Plotter, optional
        Where to show it; a new one by default.
    size : float
        Length of the longest semi-axis. The semi-axes are proportional to 1/√I_k; for a zero moment the
        ellipsoid is infinitely long and is cut off.
    center : array_like, shape (3,), optional
        Where to show the centre of mass; at its own position by default.
    opacity : float
        Opacity of the surface, from 0 to 1.
    name : str
        Name of the actors; another ellipsoid of that name is replaced.

    Returns
    -------
    pyvista.Plotter
    """
    check_kind(body, "body", "RigidBody")
    check_one(body.shape, "body")
    plotter = new_plotter() if plotter is None else plotter
    middle = _core.real_numbers(body.center_of_mass if center is None else center, "center")
    semi_axes = inertia_semi_axes(body.principal.moments)
    semi_axes *= size / semi_axes.max()
    placed = np.eye(4)
    placed[:3, :3], placed[:3, 3] = body.principal.axes, middle
    mesh = pyvista().ParametricEllipsoid(*semi_axes, u_res=121, v_res=61, w_res=61)
    plotter.add_mesh(
        mesh.transform(placed, inplace=False),
        color=_ELLIPSOID_COLOR,
        opacity=opacity,
        smooth_shading=True,
        ambient=0.3,
        name=name,
        reset_camera=False,
    )
    for k, ring in enumerate(principal_circles()):
        curve = pyvista().MultipleLines(1.002 * (ring * semi_axes) @ body.principal.axes.T + middle)
        plotter.add_mesh(curve, color="#4A5568", line_width=1.5, name=f"{name}-ring-{k}", **AXIS_STYLE)
    return principal_axes(body, plotter, length=1.25 * size, center=middle, name=f"{name}-axes")


def rigid_body(
    body: RigidBody,
    plotter: Plotter | None = None,
    *,
    shape: tuple[ArrayLike, ArrayLike] | None = None,
    opacity: float = 0.35,
) -> Plotter:
    """Show a body with its principal axes and, through it, its ellipsoid of inertia.

    Parameters
    ----------
    body : RigidBody
        One body.
    plotter : pyvista.Plotter, optional
        Where to show it; a new one by default.
    shape : (vertices, faces), optional
        A mesh of the body in its frame, (n, 3) and (m, 3). By default the shape from which the body was made,
        see :func:`polhode.animation.animate`.
    opacity : float
        Opacity of the ellipsoid, from 0 to 1.

    Returns
    -------
    pyvista.Plotter
    """
    check_kind(body, "body", "RigidBody")
    check_one(body.shape, "body")
    plotter = new_plotter() if plotter is None else plotter
    if shape is None:
        drawn, notes = body_shape(body, np.zeros(3), is_cut=False)
        for note in notes:
            warnings.warn(note, stacklevel=2)
    else:
        drawn = given_shape(*shape, np.zeros(3))
    add_surface(plotter, drawn, "body", 1.0)
    reach = longest(drawn.vertices - body.center_of_mass)
    return ellipsoid(body, plotter, size=reach, opacity=opacity)


def _outline(mesh: PolyData) -> PolyData:
    """Find the edges at which a surface turns sharply, or ends."""
    edges: PolyData = mesh.clean().extract_feature_edges(
        feature_angle=_FEATURE_ANGLE, boundary_edges=True, non_manifold_edges=False, manifold_edges=False
    )
    return edges


def add_surface(plotter: Plotter, shape: Shape, name: str, opacity: float) -> list[Any]:
    """Add a shaded surface in its colours with its outline; return the actors."""
    mesh = surface(shape.vertices, shape.faces)
    colors = shape.colors.astype(np.uint8)
    actors = [
        plotter.add_mesh(
            mesh, scalars=colors, rgb=True, opacity=opacity, name=name, reset_camera=False, ambient=0.25
        )
    ]
    edges = _outline(mesh)
    if edges.n_points:
        style = {**AXIS_STYLE, "line_width": 2.0, "name": f"{name}-outline"}
        actors.append(plotter.add_mesh(edges, color=OUTLINE_COLOR, **style))
    return actors


AXIS_STYLE: Final[dict[str, Any]] = {"lighting": False, "reset_camera": False}
"""Style of lines: in their own colour from every side."""


def pyvista() -> Any:
    """Import pyvista, or say what installs it."""
    return require("pyvista", extra="view", purpose="a window")


def new_plotter() -> Plotter:
    """Open a plotter with a white background, seen as the pictures of :mod:`polhode.plot` are."""
    plotter: Plotter = pyvista().Plotter(window_size=(800, 800))
    plotter.set_background("white")
    plotter.camera_position = [(1.0, -1.7, 0.7), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    return plotter


def show_all(plotter: Plotter) -> None:
    """Move the camera so that all is seen, nearer than pyvista does."""
    plotter.reset_camera()
    plotter.camera.zoom(1.1)


def surface(vertices: Floats, faces: NDArray[np.int64]) -> PolyData:
    """Make the mesh of triangles that pyvista draws."""
    threes = np.full((len(faces), 1), 3, dtype=np.int64)
    mesh: PolyData = pyvista().PolyData(vertices, faces=np.hstack([threes, faces]).reshape(-1))
    return mesh


def line(start: Floats, end: Floats, radius: float) -> PolyData:
    """Make a straight line thick enough to be seen."""
    mesh: PolyData = pyvista().Line(start, end).tube(radius=radius, n_sides=16, capping=True)
    return mesh


def arrow(tip: Floats, radius: float) -> PolyData:
    """Make an arrow from the origin; its head has the same thickness for any length."""
    length = float(np.linalg.norm(tip))
    mesh: PolyData = pyvista().Arrow(
        direction=tip,
        scale=length,
        tip_length=min(1.0, 9.0 * radius / length),
        tip_radius=2.6 * radius / length,
        shaft_radius=radius / length,
        shaft_resolution=24,
        tip_resolution=32,
    )
    return mesh


def add_name(
    plotter: Plotter, place: Floats, text: str, color: str, name: str, *, side: str = "center"
) -> None:
    """Write a name at a point or beside it, in front of everything."""
    plotter.add_point_labels(
        np.atleast_2d(place),
        [text],
        text_color=color,
        font_size=22,
        bold=True,
        shape=None,
        show_points=False,
        always_visible=True,
        justification_horizontal=side,
        justification_vertical="center",
        reset_camera=False,
        name=name,
    )
