"""Solids of triangle meshes beside libigl, unchecked as it is, and beside trimesh with its watertightness.

libigl (``pip install libigl``) is left out where it is not installed.
"""

from __future__ import annotations

import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import trimesh
from harness import Row
from polhode import RigidBody

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

STL_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def globe(parallels: int, meridians: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return a ball of 2 (parallels − 1) meridians triangles, its vertices row by row."""
    theta = np.linspace(0.0, np.pi, parallels + 1)[1:-1, np.newaxis]
    phi = np.linspace(0.0, 2.0 * np.pi, meridians, endpoint=False)
    rings = np.stack(
        np.broadcast_arrays(np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)), axis=-1
    )
    vertices = np.concatenate([[[0.0, 0.0, 1.0]], rings.reshape(-1, 3), [[0.0, 0.0, -1.0]]])
    row = 1 + meridians * np.arange(parallels - 2)[:, np.newaxis]
    here = np.arange(meridians)
    there = np.roll(here, -1)
    a, b = (row + here).ravel(), (row + there).ravel()
    top = np.stack([np.zeros_like(here), 1 + here, 1 + there], axis=1)
    last = 1 + meridians * (parallels - 2)
    bottom = np.stack([np.full_like(here, len(vertices) - 1), last + there, last + here], axis=1)
    sides = [
        np.stack([a, a + meridians, b + meridians], axis=1),
        np.stack([a, b + meridians, b], axis=1),
    ]
    return vertices, np.concatenate([*sides, top, bottom]).astype(np.int64)


def write_stl(path: Path, vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> None:
    """Write a binary STL."""
    records = np.zeros(len(faces), dtype=STL_RECORD)
    records["corners"] = vertices[faces]
    path.write_bytes(b"globe".ljust(80) + len(faces).to_bytes(4, "little") + records.tobytes())


def with_trimesh(mesh: Any) -> tuple[float, Any, Any]:
    """Mass properties and the test of watertightness."""
    assert mesh.is_watertight
    found = mesh.mass_properties
    return found.mass, found.center_mass, found.inertia


def ours(body: RigidBody) -> tuple[float, Any, Any]:
    """Return what is compared."""
    return body.mass, body.center_of_mass, body.inertia


def same(one: Any, other: Any) -> None:
    """Compare mass, centre and tensor, to what plain sums of millions leave."""
    for mine, theirs in zip(one, other, strict=True):
        assert np.abs(np.asarray(mine) - theirs).max() < 1e-9


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    for parallels, meridians in ((224, 224), (1000, 1000)):
        vertices, faces = globe(parallels, meridians)
        count = len(faces)
        name = f"{count:.0e} triangles".replace("e+0", "e")
        if find_spec("igl"):
            import igl

            def moments(vertices: Any = vertices, faces: Any = faces) -> Any:
                mass, first, inertia = igl.moments(vertices, faces)
                return mass, np.asarray(first) / mass, np.asarray(inertia)

            yield Row(
                name=f"unchecked solid, {name}",
                peer="igl.moments",
                ours=lambda v=vertices, f=faces: ours(RigidBody.from_mesh(v, f, density=1.0, check=False)),
                theirs=moments,
                compare=same,
                items=count,
                at_least=1.2,
            )
        yield Row(
            name=f"checked solid, {name}",
            peer="trimesh",
            ours=lambda v=vertices, f=faces: ours(RigidBody.from_mesh(v, f, density=1.0)),
            theirs=lambda v=vertices, f=faces: with_trimesh(trimesh.Trimesh(v, f, process=False)),
            compare=same,
            items=count,
            at_least=15.0,
        )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "globe.stl"
        vertices, faces = globe(1582, 1582)
        write_stl(path, vertices, faces)
        yield Row(
            name="binary STL of 5e6 triangles, checked",
            peer="trimesh",
            ours=lambda: ours(RigidBody.from_file(path, density=1.0)),
            theirs=lambda: with_trimesh(trimesh.load_mesh(path)),
            compare=same,
            items=len(faces),
            at_least=8.0,
        )
