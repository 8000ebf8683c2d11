"""What all windows share: a new one, and lines, arrows and names in it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._extras import require

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from pyvista import Plotter, PolyData

    Floats = NDArray[np.float64]

__all__ = ["AXIS_STYLE", "add_name", "arrow", "line", "new_plotter", "pyvista", "show_all", "surface"]

AXIS_STYLE: Final[dict[str, Any]] = {"lighting": False, "reset_camera": False}
"""Of lines: in their own colour from every side."""


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
    """Move the camera to where all is seen, nearer than pyvista puts it."""
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
    """Make an arrow from the origin, not of length zero; its head is as thick whatever its length."""
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
