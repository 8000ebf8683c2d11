"""What MuJoCo and Pinocchio say of the inertia in robot files: the links that they refuse or cannot move."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING

import numpy as np
import robots_files as files
import robots_law as law

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    import mujoco

OF_INERTIA = re.compile(r"mass|inertia", re.IGNORECASE)
NAMED = re.compile(r"Element name '([^']*)'")


def urdf_without_shapes(path: Path) -> ET.Element:
    """Read a URDF file and leave out what it shows."""
    root = files.parsed(path)
    for link in root.findall("link"):
        for role in ("visual", "collision"):
            for each in link.findall(role):
                link.remove(each)
    for extra in [*root.findall("gazebo"), *root.findall("transmission"), *root.findall("mujoco")]:
        root.remove(extra)
    return root


def refused_by_mujoco(path: Path) -> dict[str, str]:
    """Return the links of a URDF file whose mass or inertia MuJoCo refuses; "" where the whole file."""
    import mujoco

    root = urdf_without_shapes(path)
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", balanceinertia="false", discardvisual="false")
    links = {link.get("name", ""): link for link in root.findall("link")}
    refused: dict[str, str] = {}
    for _ in range(len(links) + 1):
        try:
            mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
        except ValueError as error:
            words = str(error)
            name = NAMED.search(words)
            if not OF_INERTIA.search(words) or name is None or name[1] in refused or name[1] not in links:
                return refused | {"": words.splitlines()[0]}
            refused[name[1]] = words.splitlines()[0]
            _heal(links[name[1]])
        else:
            break
    return refused


def _heal(link: ET.Element) -> None:
    """Return a link the inertia of a body, so that the next one that is refused is told."""
    for inertial in link.findall("inertial"):
        link.remove(inertial)
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "mass", value="1")
    ET.SubElement(inertial, "inertia", ixx="1", iyy="1", izz="1", ixy="0", ixz="0", iyz="0")


def idle_in_pinocchio(path: Path) -> tuple[list[str], bool]:
    """Return the links that a joint moves without inertia, and whether the mass matrix is singular."""
    import pinocchio as pin

    root = urdf_without_shapes(path)
    children = {
        j.get("name"): child.get("link", "") for j in root.findall("joint") for child in j.findall("child")
    }
    model = pin.buildModelFromXML(ET.tostring(root, encoding="unicode"))
    data = model.createData()
    if not model.nv:
        return [], False
    generator = np.random.default_rng(0)
    matrices = []
    for turn in (0.0, 1.0, 1.0):
        q = pin.integrate(model, pin.neutral(model), turn * generator.normal(size=model.nv))
        upper = np.triu(pin.crba(model, data, q))
        matrices.append(upper + np.triu(upper, 1).T)
    diagonal = np.max([np.abs(np.diag(m)) for m in matrices], axis=0)
    idle = [
        children.get(model.names[i], "")
        for i, joint in enumerate(model.joints)
        if joint.nv > 0 and (diagonal[joint.idx_v : joint.idx_v + joint.nv] < 1e-15).all()
    ]
    scale = 1.0 / np.sqrt(np.maximum(diagonal, 1e-300))
    least = min(float(np.linalg.eigvalsh(m * np.outer(scale, scale))[0]) for m in matrices)
    return idle, least < 1e-13


def mjcf(path: Path) -> tuple[list[tuple[str, str, str]], str]:
    """Judge the bodies of an MJCF file as MuJoCo reads it: name, word and rule; and why it is unread."""
    import mujoco

    spec = mujoco.MjSpec.from_file(str(path))
    refused: dict[str, str] = {}
    for i, body in enumerate(spec.bodies):
        body.name = body.name or f"#{i}"
    model = None
    for _ in range(len(spec.bodies) + 1):
        try:
            model = spec.compile()
            break
        except ValueError as error:
            words = str(error)
            name = NAMED.search(words)
            if not OF_INERTIA.search(words) or name is None or name[1] in refused or not spec.body(name[1]):
                return [], words.splitlines()[0]
            refused[name[1]] = words.splitlines()[0]
            body = spec.body(name[1])
            body.explicitinertial, body.mass, body.inertia = True, 1.0, [1.0, 1.0, 1.0]
            body.fullinertia = [np.nan] * 6
    if model is None:
        return [], "refused"
    from_geoms = spec.compiler.inertiafromgeom == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE
    links, said = [], []
    for body in spec.bodies[1:]:
        is_given = bool(body.explicitinertial) and not from_geoms and body.name not in refused
        links.append(_link(model, model.body(body.name).id) if is_given else files.Link(body.name))
    moments = [law.isotropic(link.tensor) for link in links]
    copied = {
        m
        for m in moments
        if m and (m == 1.0 or len({x.mass for x, n in zip(links, moments, strict=True) if n == m}) > 1)
    }
    for link in links:
        if link.name in refused:
            said.append((link.name, "impossible", "mujoco"))
        elif link.is_empty:
            said.append((link.name, "good", "mujoco"))
        else:
            said.append((link.name, *law.of_tensor(link, copied, is_tied=_is_tied(model, link.name))))
    return said, ""


def _is_tied(model: mujoco.MjModel, name: str) -> bool:
    """Whether no joint stands between a body and the world, or another body with three moments above 0."""
    i = model.body(name).id
    weld = model.body_weldid[i]
    others = (k for k in range(1, model.nbody) if k != i and model.body_weldid[k] == weld)
    return bool(weld == 0 or any(model.body_inertia[k].min() > 0.0 for k in others))


def lost_by_fix(path: Path, packages: tuple[Path, ...]) -> tuple[int, list[str]]:
    """Count the engines that load a file before ``--fix``, and name those that do not after it."""
    from polhode import robots

    robot = robots.read_robot(path, packages)
    verdicts = robots.check(robot, packages)
    before = _loading(path)
    lost = []
    for words in (robots.FAILURES, robots.FAILURES | {"suspect"}):
        fixed = path.with_name(f"fixed-{path.name}")
        fixed.write_bytes(robots.fix(robot, verdicts, words))
        after = _loading(fixed)
        fixed.unlink()
        lost += [f"{engine}: {after[engine]}" for engine, why in before.items() if not why and after[engine]]
    return sum(not why for why in before.values()), lost


def _loading(path: Path) -> dict[str, str]:
    """Return for each engine why it does not load a file; "" where it does. Of URDF shapes are left out."""
    import mujoco

    if path.suffix == ".xml":
        return {"mujoco": _why(lambda: mujoco.MjModel.from_xml_path(str(path)))}
    import pinocchio as pin

    text = ET.tostring(urdf_without_shapes(path), encoding="unicode")
    return {
        "mujoco": _why(lambda: mujoco.MjModel.from_xml_string(text)),
        "pinocchio": _why(lambda: pin.buildModelFromXML(text)),
    }


def _why(load: Callable[[], object]) -> str:
    try:
        load()
    except Exception as error:  # whatever an engine says
        return str(error).splitlines()[0]
    return ""


def _link(model: mujoco.MjModel, i: int) -> files.Link:
    """Return a body as MuJoCo compiled it, each geom as the box that MuJoCo puts around it."""
    import mujoco
    import trimesh

    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[i])
    rotation = turn.reshape(3, 3)
    link = files.Link(
        model.body(i).name, float(model.body_mass[i]), model.body_ipos[i].copy(), is_declared=True
    )
    link.tensor = rotation @ np.diag(model.body_inertia[i]) @ rotation.T
    for g in range(model.body_geomadr[i], model.body_geomadr[i] + model.body_geomnum[i]):
        mujoco.mju_quat2Mat(turn, model.geom_quat[g])
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = turn.reshape(3, 3), model.geom_pos[g]
        low, high = (
            model.geom_aabb[g, :3] - model.geom_aabb[g, 3:],
            model.geom_aabb[g, :3] + model.geom_aabb[g, 3:],
        )
        is_solid = bool((high > low).all())
        corners = trimesh.bounds.corners(np.array([low, high]))
        if model.geom_type[g] == mujoco.mjtGeom.mjGEOM_MESH:
            first, count = (
                int(each[model.geom_dataid[g]]) for each in (model.mesh_vertadr, model.mesh_vertnum)
            )
            corners = model.mesh_vert[first : first + count].astype(float)
        solid = files.Solid.of(trimesh.PointCloud(corners).convex_hull) if is_solid else None
        link.shapes.append(("collision", solid and solid.moved(pose)))
    return link
