"""An assembly drawn: each part where it stands, those of one branch in one colour."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from polhode._hints import with_hints
from polhode.draw.shape import body_shape
from polhode.draw.triangles import cluster_vertices
from polhode.io.content import is_molecule
from polhode.io.formats import CAD_SUFFIXES, SAVED_SUFFIXES, load
from polhode.io.images import is_image
from polhode.io.unpacked import inner_suffix
from polhode.plot import body as draw_body
from polhode.plot import principal_axes

if TYPE_CHECKING:
    from pathlib import Path

    from mpl_toolkits.mplot3d.axes3d import Axes3D
    from numpy.typing import NDArray

    from polhode.assembly.result import Assembly, Member

    Floats = NDArray[np.float64]

__all__ = ["draw"]

_COLORS: Final = np.array(
    [
        (0.55, 0.72, 0.86), (0.94, 0.75, 0.47), (0.52, 0.78, 0.68), (0.90, 0.62, 0.50), (0.84, 0.68, 0.78),
        (0.72, 0.86, 0.95), (0.95, 0.90, 0.58),
    ]
)  # fmt: skip
"""Paler than those of the sunburst, in the same order."""
_MOST: Final = 20_000
"""Triangles that are drawn of all parts together."""


@with_hints
def draw(assembly: Assembly, ax: Axes3D | None = None, *, length_label: str | None = None) -> Axes3D:
    """Draw the parts where they stand; see :meth:`Assembly.plot`.

    A mesh is drawn as it is, or coarser where it has many triangles; a solid as it is; a part of which no
    shape is known as the box of the same inertia.
    """
    branches = sorted(assembly.ledger[assembly.ledger.root].children, key=lambda node: -node.mass)
    tops = {node.id: k for k, node in enumerate(branches)}
    vertices, faces, colors = [], [], []
    corners = 0
    for part in assembly.parts:
        color = tops[part.id.partition("/")[0]]
        points, triangles = _surface(part, max(_MOST // len(assembly.parts), 400))
        vertices.append(points)
        faces.append(triangles + corners)
        colors.append(np.tile(_COLORS[color % len(_COLORS)], (len(triangles), 1)))
        corners += len(points)
    every = np.concatenate(vertices)
    ax = draw_body(every, np.concatenate(faces), ax, length_label=length_label, colors=np.concatenate(colors))
    reach = 0.55 * float(np.ptp(every, axis=0).max())
    if assembly.body.principal.top != "point":
        principal_axes(assembly.body, ax, length=reach)
    return ax


def _surface(part: Member, most: int) -> tuple[Floats, NDArray[np.int64]]:
    """Return the triangles of a part where it stands."""
    if part.file is not None and _is_mesh(part.file):
        mesh = load(part.file).mesh
        vertices, faces, _ = cluster_vertices(mesh.vertices * part.metres, mesh.faces, most)
        if np.linalg.det(part.rotation) < 0.0:  # a mirror image: turned outward again
            faces = faces[:, ::-1]
        return vertices @ part.rotation.T + part.displacement, faces
    drawn, _ = body_shape(part.body, np.zeros(3), is_cut=False)
    vertices, faces, _ = cluster_vertices(drawn.vertices, drawn.faces, most)
    return vertices, faces


def _is_mesh(file: Path) -> bool:
    """Return whether a file holds triangles: no atoms, no solids of CAD, no numbers alone."""
    return (
        not is_molecule(file)
        and not is_image(file)
        and inner_suffix(file) not in (*SAVED_SUFFIXES, *CAD_SUFFIXES)
    )
