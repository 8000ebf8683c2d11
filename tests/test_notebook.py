"""What notebooks show of bodies: a table and a drawing without any drawing library."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import numpy as np
from polhode import RigidBody, solids
from polhode._notebook import ellipsoid_svg

NAMESPACE = "{http://www.w3.org/2000/svg}"


def test_one_body_has_its_numbers_and_a_drawing() -> None:
    text = solids.box((3.0, 2.0, 1.0), mass=1.25)._repr_html_()
    assert ElementTree.fromstring(text).tag == "div"
    assert "1.25" in text
    assert "asymmetric" in text
    assert "<svg" in text


def test_the_outline_is_that_of_the_ellipsoid() -> None:
    """That of a ball is a circle, seen from anywhere; no point of a ring lies beyond the outline."""
    outline = _drawing(solids.sphere(1.0, mass=1.0)).find(f"{NAMESPACE}ellipse")
    assert outline is not None
    assert outline.get("rx") == outline.get("ry") == "72.00"
    drawing = _drawing(solids.box((3.0, 2.0, 1.0), mass=1.0))
    outline = drawing.find(f"{NAMESPACE}ellipse")
    assert outline is not None
    radii = float(outline.get("rx", "")), float(outline.get("ry", ""))
    angle = np.deg2rad(float(outline.get("transform", "")[len("rotate(") : -1]))
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    reached = []
    for ring in drawing.iter(f"{NAMESPACE}polyline"):
        points = np.array([pair.split(",") for pair in ring.get("points", "").split()], dtype=float)
        reached.append(np.linalg.norm(points @ turn.T / radii, axis=1).max())
    assert len(reached) == 6
    assert max(reached) < 1.001
    assert max(reached) > 0.99


def test_rods_points_and_stacks() -> None:
    assert "<svg" in RigidBody.from_principal(1.0, (0.0, 1.0, 1.0))._repr_html_()
    assert "<svg" not in RigidBody.from_principal(1.0, (0.0, 0.0, 0.0))._repr_html_()
    stack = solids.cube(np.ones(3), mass=1.0)._repr_html_()
    assert stack.startswith("<pre>&lt;RigidBody stack of shape (3,)")


def _drawing(body: RigidBody) -> ElementTree.Element:
    return ElementTree.fromstring(ellipsoid_svg(body))
