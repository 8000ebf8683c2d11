"""Boxes, several of them as one mesh, and files with a group for each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from oracles.meshes import box

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["NESTED", "SHARED", "TWO", "at", "joined", "written"]


def joined(*meshes: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Several meshes as one, their vertices one after the other."""
    before = np.cumsum([0] + [len(vertices) for vertices, _ in meshes])
    faces = [faces + start for (_, faces), start in zip(meshes, before[:-1], strict=True)]
    return np.concatenate([vertices for vertices, _ in meshes]), np.concatenate(faces)


def at(size: Any, place: Any, inward: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """A box with its centre there."""
    vertices, faces = box(size)
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2.0
    return vertices - middle + np.asarray(place), faces[:, ::-1] if inward else faces


TWO = joined(at((1, 1, 1), (0, 0, 0)), at((1, 0.5, 0.7), (0.6, 0.1, 0.05)))
SHARED = 0.4 * 0.5 * 0.7
NESTED = joined(at((1, 1, 1), (0, 0, 0)), at((0.1, 0.1, 0.1), (0.2, 0, 0)))


def written(
    path: Path, *meshes: tuple[np.ndarray, np.ndarray], names: tuple[str, ...] = ("body", "insert")
) -> Path:
    """An OBJ file with a group for each mesh."""
    text, before = "", 1
    for name, (vertices, faces) in zip(names, meshes, strict=True):
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (faces + before).tolist()]
        text += f"o {name}\n" + "\n".join(lines) + "\n"
        before += len(vertices)
    path.write_text(text)
    return path
