"""Meshes of an MJCF model: where their vertices are put, and what matter MuJoCo takes them for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode import RigidBody
from polhode._core import rotate
from polhode.robots.model import Place, Shape, numbers, scale, unit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode.files.xml_source import Element

__all__ = ["legacy_solid", "matrix", "mesh_shape"]


def matrix(quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give the rotation of a unit quaternion, scalar last."""
    return np.stack([rotate(quaternion, axis) for axis in np.eye(3)], axis=-1)


def mesh_shape(
    geom: Element,
    place: Place,
    mesh: Element,
    attributes: dict[str, str],
    address: str,
    density: float,
    mass: float | None,
    *,
    weighs: bool,
) -> Shape:
    """Give the shape of a geom that is a mesh.

    MuJoCo moves the vertices by minus `refpos`, turns them by the inverse of `refquat`, and then scales them.

    Parameters
    ----------
    geom, mesh : Element
    place : Place
        Of the geom, in its body.
    attributes : dict
        Of the mesh, with those of its class.
    address : str
        Of its file; "" where the model lists the vertices.
    density : float
    mass : float, optional
    weighs : bool
        Whether the inertia of the body is taken from it, so that `inertia` of the mesh counts.
    """
    factors = scale(mesh, attributes.get("scale", "1"))
    counting = attributes.get("inertia", "legacy") if weighs else ""
    kind = "mesh" if address else "mesh without a file"
    kind = "mesh, hollow" if counting == "shell" else kind
    shift = numbers(mesh, attributes.get("refpos", "0 0 0"), 3, "refpos")
    w, x, y, z = numbers(mesh, attributes.get("refquat", "1 0 0 0"), 4, "refquat")
    back = matrix(unit(mesh, np.array([x, y, z, w]))).T
    if len(set(factors)) > 1 and not np.array_equal(back, np.eye(3)):
        kind = "mesh, turned by refquat and scaled unevenly"
    inner = Place(back, -np.array(factors) * (back @ shift))
    return Shape(
        kind, factors, place.then(inner), "collision", address, density, mass, geom.where, counting=counting
    )


def legacy_solid(vertices: NDArray[np.float64], faces: NDArray[np.integer]) -> RigidBody:
    """Give the matter of density 1 that MuJoCo takes a mesh for with ``inertia="legacy"``, its default.

    The tetrahedra from the centroid of the surface to its triangles all count as full, whichever way they are
    wound: twice where they overlap, as where a mesh is not convex. From their centre of mass new tetrahedra
    are made, whose volumes and moments about that point count.
    """
    corners = vertices[faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    middle = areas @ corners.mean(axis=1) / areas.sum()
    volumes = _volumes(corners - middle)
    center = middle + volumes @ (corners - middle).sum(axis=1) / 4.0 / volumes.sum()
    about = corners - center
    volumes = _volumes(about)
    # With one corner at the point, ∫ x xᵀ dV = V/20 (Σ a aᵀ + (Σ a)(Σ a)ᵀ) over the other three.
    sums = about.sum(axis=1)
    second = np.einsum("t,tki,tkj->ij", volumes, about, about) + np.einsum("t,ti,tj->ij", volumes, sums, sums)
    second /= 20.0
    tensor = np.trace(second) * np.eye(3) - second
    return RigidBody(float(volumes.sum()), (tensor + tensor.T) / 2.0, center)


def _volumes(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give the volumes of the tetrahedra from the origin to triangles, all positive."""
    heights = np.cross(corners[:, 0], corners[:, 1])
    found: NDArray[np.float64] = np.abs((heights * corners[:, 2]).sum(axis=1)) / 6.0
    return found
