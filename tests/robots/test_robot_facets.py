"""How far facets stand from what is round: prisms inscribed in cylinders, in closed form."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
import trimesh
from mesh_files import obj
from oracles.meshes import cube
from polhode import robots
from polhode.robots.geometry import sagitta
from robot_texts import link, urdf

if TYPE_CHECKING:
    from pathlib import Path


def prism(sides: int, radius: float, height: float) -> trimesh.Trimesh:
    mesh: trimesh.Trimesh = trimesh.creation.cylinder(radius, height, sections=sides)
    return mesh


@pytest.mark.parametrize("sides", [10, 12, 32, 100])
def test_of_a_prism_it_is_the_height_of_the_arc(sides: int) -> None:
    mesh = prism(sides, 0.3, 2.0)
    want = 0.3 * (1.0 - np.cos(np.pi / sides))
    assert sagitta(mesh.vertices, mesh.faces) == pytest.approx(want, rel=1e-9)
    loose = mesh.vertices[mesh.faces].reshape(-1, 3)  # as STL has them
    assert sagitta(loose, np.arange(len(loose)).reshape(-1, 3)) == pytest.approx(want, rel=1e-9)


def test_edges_of_the_part_are_not_round() -> None:
    """Eight sides turn by 45 degrees, a cube's by 90; nothing at all has no edges."""
    mesh = prism(8, 0.3, 2.0)
    assert sagitta(mesh.vertices, mesh.faces) == pytest.approx(0.0, abs=1e-15)
    assert sagitta(*cube(1.0)) == pytest.approx(0.0, abs=1e-15)
    assert sagitta(np.zeros((3, 3)), np.array([[0, 1, 2]])) == 0.0


@pytest.mark.parametrize(("beyond", "word"), [(0.9, "coarse"), (1.1, "impossible")])
def test_a_centre_beyond_the_facets(beyond: float, word: str, tmp_path: Path) -> None:
    """A slice without thickness outside the flat side of a prism, by so much of the height of its arcs."""
    sides, radius = 12, 0.3
    mesh = prism(sides, radius, 2.0)
    cosine, sine = np.cos(np.pi / sides), np.sin(np.pi / sides)
    turned = mesh.vertices @ np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    (tmp_path / "m.obj").write_bytes(obj(turned, mesh.faces))
    flat = turned[:, 0].max()
    assert flat == pytest.approx(radius * np.cos(np.pi / sides))
    x = flat + beyond * (radius - flat)
    text = urdf(link("a", 1.0, (0.38, 0.33, 0.05), '<mesh filename="m.obj"/>', at=f"{float(x)!r} 0 0"))
    (verdict,) = robots.check(robots.parse_robot(text.encode(), name="r", folder=tmp_path))
    assert verdict.verdict == word
    assert f"; walls {1e3 * beyond * (radius - flat):.3g} mm farther out would do, " in verdict.reason
    assert f"off by {'no more than ' * (word != 'coarse')}{1e3 * (radius - flat):.3g} mm" in verdict.reason
