"""Triangles that the nodes of a scene place, in the order of the file and with the names of their parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode.io.mesh import Mesh, used_vertices, weld

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode.io.budget import Budget

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

__all__ = ["Scene"]


class Scene:
    """Collects placed triangles within a budget.

    Parameters
    ----------
    budget : Budget
    """

    def __init__(self, budget: Budget) -> None:
        self._budget = budget
        self._vertices: list[Floats] = []
        self._faces: list[Integers] = []
        self._count = 0
        self._names: list[str] = []
        self._materials: list[tuple[tuple[str, int], ...]] = []

    def place(
        self,
        vertices: Floats,
        faces: Integers,
        matrix: Floats,
        name: str = "",
        materials: tuple[tuple[str, int], ...] = (),
    ) -> None:
        """Place triangles.

        Parameters
        ----------
        vertices : numpy.ndarray, shape (n, 3)
        faces : numpy.ndarray, shape (m, 3)
            Rows of `vertices`.
        matrix : numpy.ndarray, shape (4, 4)
            Takes their coordinates to those of the scene.
        name : str
            Of the part that they are.
        materials : tuple of (str, int)
            The name of each material and the number of triangles of it, in their order; empty for none.
        """
        self._budget.spend("placements")
        self._budget.spend("triangles", len(faces))
        if not len(faces):
            return
        # A part may use few of the vertices that many parts share.
        is_large = len(vertices) <= 3 * len(faces)
        used = used_vertices(faces, len(vertices)) if is_large else np.unique(faces)
        if len(used) < len(vertices):
            vertices, faces = vertices[used], np.searchsorted(used, faces)
        # A reflection turns every triangle inside out; the opposite winding turns it back.
        if np.linalg.det(matrix[:3, :3]) < 0.0:
            faces = faces[:, ::-1]
        with np.errstate(over="ignore", invalid="ignore"):
            self._vertices.append(vertices @ matrix[:3, :3].T + matrix[:3, 3])
        self._faces.append(faces + self._count)
        self._count += len(vertices)
        self._names.append(name)
        self._materials.append(materials or (("", len(faces)),))

    @property
    def groups(self) -> tuple[tuple[str, int], ...]:
        """The name of each part and the number of its triangles, in the order of the faces."""
        return tuple((name, len(faces)) for name, faces in zip(self._names, self._faces, strict=True))

    @property
    def materials(self) -> tuple[tuple[str, int], ...]:
        """The same of materials; empty where no part has one."""
        runs = tuple(run for of_part in self._materials for run in of_part)
        return runs if any(name for name, _ in runs) else ()

    def mesh(self, name: str) -> Mesh:
        """Join all that was placed, equal corners made one; `name` is that of the format."""
        if not self._faces:
            return Mesh(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64), name)
        return weld(np.concatenate(self._vertices), np.concatenate(self._faces), name)
