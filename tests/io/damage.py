"""Damaged files: every kind of file that the package reads, and the ways in which files go bad.

A reader may refuse a damaged file, by an error of polhode that names it, or read a valid body from it. It may
not raise anything else, take long, or read another body from a file that is cut short or has a checksum.
"""

from __future__ import annotations

import gzip
import re
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from command_line import one_line, run
from mesh_files import (
    ascii_ply,
    ascii_stl,
    binary_ply,
    binary_stl,
    dae,
    glb,
    gltf,
    numbered_plates,
    obj,
    off,
    three_mf,
)
from oracles.meshes import icosphere
from polhode import RigidBody, Trajectory, loads, robots, solids
from polhode.errors import PolhodeError
from polhode.io import read_mesh

__all__ = ["KINDS", "LONGEST", "Kind", "cuts", "damaged", "every_damage", "outcome", "tally", "whole_file"]

LONGEST = 5.0
"""Seconds that a reader may take over a small file."""
WAYS = ("bit", "bits", "character", "word", "zeros", "noise", "insert", "remove", "repeat", "swap")
PRINTABLE = np.arange(32, 127)
HOSTILE = (
    *b"nan inf -inf -0.0 1e400 1e308 1e-320 -1 0 7 1_0 0x10 1,5 true null NaN Infinity".split(),
    *b"99999999999999999999 2147483648 -2147483648 4294967295 18446744073709551615 1e19 3.5 {} [[[".split(),
    *b"format vertex end_header robot".split(),
    b"9" * 5000,
    b"[" * 20000,
    b"\n" * 300,
)


@dataclass(frozen=True)
class Kind:
    """One kind of file.

    Attributes
    ----------
    suffix : str
    write : callable
        Gives the bytes of a whole one; is told a path to write to.
    read : callable
        Gives what is compared of it, and raises where it is not valid.
    has_checksum : bool
        Whether no change can go unseen.
    is_self_ending : bool
        Whether a file that is cut short cannot be read as another one.
    """

    suffix: str
    write: Callable[[Path], bytes]
    read: Callable[[Path], object]
    has_checksum: bool = False
    is_self_ending: bool = True


def _saved(thing: Any) -> Callable[[Path], bytes]:
    def write(path: Path) -> bytes:
        thing.save(path)
        return path.read_bytes()

    return write


def _mesh(writer: Callable[..., bytes]) -> Callable[[Path], bytes]:
    vertices, faces = icosphere(1)  # 42 vertices: numbers of one and two digits
    return lambda _: writer(vertices + np.array([3.0, -1.0, 0.5]), faces)


def _text(text: str) -> Callable[[Path], bytes]:
    return lambda _: text.encode()


def _numbers(body: RigidBody) -> tuple[object, ...]:
    """What is compared of a body, which is one: finite, and after the laws that all bodies obey."""
    moments = np.asarray(body.principal_moments)
    assert np.isfinite(body.mass).all()
    assert (np.asarray(body.mass) > 0.0).all()
    assert np.isfinite(body.inertia).all()
    assert np.isfinite(body.center_of_mass).all()
    assert (moments[..., 2] <= (moments[..., 0] + moments[..., 1]) * (1.0 + 1e-12)).all()
    return np.asarray(body.mass).tobytes(), body.center_of_mass.tobytes(), body.inertia.tobytes(), body.shape


def _body(path: Path) -> object:
    return _numbers(RigidBody.from_file(path))


def _motion(path: Path) -> object:
    motion = Trajectory.from_file(path)
    states = [getattr(motion, name) for name in ("t", "omega", "quaternion", "position", "velocity", "about")]
    assert all(state.dtype == np.float64 for state in states)
    assert set(np.ravel(motion.status).tolist()) <= {"complete", "stopped", "failed"}
    kept = [state.tobytes() for state in states]
    counts = np.asarray(motion.steps).tolist(), np.asarray(motion.evaluations).tolist()
    return _numbers(motion.body), kept, counts, np.asarray(motion.status).tolist(), motion.pivoted


def _solid(path: Path) -> object:
    return _numbers(RigidBody.from_file(path, density=2.0))


def _mended(path: Path) -> object:
    return _numbers(
        RigidBody.from_file(path, mass=2.0, length_unit="km", weld=1e-9, closure="caps", orient=True)
    )


def _molecule(path: Path) -> object:
    return _numbers(RigidBody.from_file(path))


def _triangles(path: Path) -> object:
    mesh = read_mesh(path)
    assert mesh.vertices.dtype == np.float64
    assert mesh.faces.dtype == np.int64
    assert mesh.faces.min() >= 0
    assert mesh.faces.max() < len(mesh.vertices)
    return mesh.vertices.tobytes(), mesh.faces.tobytes()


def _robot(path: Path) -> object:
    robot = robots.read_robot(path)
    verdicts = robots.check(robot)
    robots.fix(robot, verdicts)
    return [(link.name, link.inertial.mass if link.inertial else None) for link in robot.links]


def _expected(path: Path) -> object:
    """A report held against an earlier one, on the command line."""
    part = path.with_name("part.obj")
    part.write_bytes(obj(*icosphere(0)))
    code, _, err = run("report", part, "--expect", path)
    if code != 2:
        return code
    if not one_line(err):
        raise AssertionError(err)
    raise PolhodeError(err.strip())


def _report(path: Path) -> bytes:
    path.with_name("part.obj").write_bytes(obj(*icosphere(0)))
    return run("report", path.with_name("part.obj"), "--format", "json")[1].encode()


_BOX = solids.box((3.0, 0.2, 1.1), mass=0.7).translated((0.1, 1e3, 0.3))
_STACK = solids.box(np.arange(1.0, 19.0).reshape(2, 3, 3), density=2.0)
_FALL = _BOX.simulate(
    np.linspace(0, 1, 5), (0.1, 1.0, 0.2), load=loads.uniform_gravity((0.0, 0.0, -9.81)), about="origin"
)
_SPINS = _STACK.simulate([0.0, 0.5, 1.0], (0.1, 1.0, 0.2))
_INERTIA = '<inertia ixx="1" iyy="1" izz="1.5" ixy="0" ixz="0" iyz="0"/>'
_LINK = f'<inertial><mass value="2"/><origin xyz="0 0 0.1"/>{_INERTIA}</inertial>'
_URDF = f"""<?xml version="1.0"?>
<!-- two links --><robot name="arm">
<link name="base">{_LINK}<visual><geometry><box size="1 2 3"/></geometry></visual></link>
<link name="tip">{_LINK}<collision><origin rpy="0.1 0.2 0.3"/>
<geometry><cylinder radius="0.1" length="2"/></geometry></collision></link>
<joint name="j" type="fixed"><parent link="base"/><child link="tip"/></joint></robot>
"""
_SDF = """<sdf version="1.9"><model name="m"><link name="a"><pose>0 0 1 0 0 0.5</pose>
<inertial><mass>2.5</mass><pose relative_to="a">0 0.1 0 0 0 0</pose>
<inertia><ixx>1</ixx><iyy>1.2</iyy><izz>1.4</izz><ixy>0.1</ixy></inertia></inertial>
<collision name="c"><geometry><sphere><radius>0.4</radius></sphere></geometry></collision></link>
<model name="inner"><link name="b"/></model></model></sdf>
"""
_MJCF = """<mujoco model="m"><compiler angle="degree"/><default><geom density="900"/></default>
<worldbody><body name="a" pos="0 0 1" euler="10 20 30">
<inertial pos="0 0 0" mass="3" diaginertia="1 1 1.5"/><geom type="capsule" size="0.1" fromto="0 0 0 0 0 1"/>
<body name="b"><geom type="ellipsoid" size="1 2 3"/></body>
<replicate count="3" offset="1 0 0"><body name="c"><geom type="box" size="1 1 1" mass="2"/></body></replicate>
</body></worldbody></mujoco>
"""
_PDB = """HEADER    WATER
HETATM    1  O   HOH A   1       0.000   0.000   0.119  1.00  0.00           O
HETATM    2  H1  HOH A   1       0.000   0.763  -0.477  1.00  0.00           H
HETATM    3  H2  HOH A   1       0.000  -0.763  -0.477  1.00  0.00           H
END
"""
_MOL = """water
  test

  3  2  0  0  0  0  0  0  0  0999 V2000
    0.0000    0.0000    0.1193 O   0  0
    0.0000    0.7632   -0.4770 H   0  0
    0.0000   -0.7632   -0.4770 H   0  0
  1  2  1  0
  1  3  1  0
M  END
"""
_WATER = "3\nwater, 96.4 kJ\nO 0 0 0.119262\nH 0 0.763239 -0.477047\nH 0 -0.763239 -0.477047\n"

KINDS: dict[str, Kind] = {
    "body, JSON": Kind(".json", _saved(_BOX), _body),
    "body, npz": Kind(".npz", _saved(_BOX), _body, has_checksum=True),
    "stack, JSON": Kind(".json", _saved(_STACK), _body),
    "stack, npz": Kind(".npz", _saved(_STACK), _body, has_checksum=True),
    "motion, JSON": Kind(".json", _saved(_FALL), _motion),
    "motion, npz": Kind(".npz", _saved(_FALL), _motion, has_checksum=True),
    "motions, JSON": Kind(".json", _saved(_SPINS), _motion),
    "motions, npz": Kind(".npz", _saved(_SPINS), _motion, has_checksum=True),
    "binary STL": Kind(".stl", _mesh(binary_stl), _solid),
    "ASCII STL": Kind(".stl", _mesh(ascii_stl), _solid),
    "OBJ": Kind(".obj", _mesh(obj), _solid),
    "plates": Kind(".tab", _mesh(obj), _solid),
    "plates, mended": Kind(".txt", _mesh(obj), _mended, is_self_ending=False),  # caps close what was cut off
    "binary STL, mended": Kind(".stl", _mesh(binary_stl), _mended),
    "ASCII PLY": Kind(".ply", _mesh(ascii_ply), _solid),
    "binary PLY, streamed": Kind(".ply", _mesh(binary_ply), _solid),
    "binary PLY, whole": Kind(".ply", _mesh(binary_ply), _triangles),
    "OFF": Kind(".off", _mesh(off), _solid),
    "GLB": Kind(".glb", _mesh(glb), _solid),
    "glTF": Kind(".gltf", _mesh(gltf), _solid),
    "DAE": Kind(".dae", _mesh(dae), _solid),
    "3MF": Kind(".3mf", _mesh(three_mf), _solid, has_checksum=True),
    "numbered plates": Kind(
        ".tab", _mesh(numbered_plates), _solid, is_self_ending=False
    ),  # of its last number
    "packed STL": Kind(".stl.gz", lambda path: gzip.compress(_mesh(ascii_stl)(path)), _solid),
    "PDB": Kind(".pdb", _text(_PDB), _molecule, is_self_ending=False),
    "MOL": Kind(".mol", _text(_MOL), _molecule),
    "XYZ": Kind(".xyz", _text(_WATER), _molecule, is_self_ending=False),  # its last number may lose digits
    "URDF": Kind(".urdf", _text(_URDF), _robot),
    "SDF": Kind(".sdf", _text(_SDF), _robot),
    "MJCF": Kind(".xml", _text(_MJCF), _robot),
    "expected report": Kind(".json", _report, _expected),
}


def cuts(data: bytes, places: Iterator[int]) -> Iterator[tuple[str, bytes]]:
    """The beginnings of a file."""
    for place in places:
        yield f"cut after {place} bytes", data[:place]


def damaged(data: bytes, rng: np.random.Generator) -> tuple[str, bytes]:
    """A file gone bad in one of many ways, and which."""
    copy = bytearray(data)
    place, length = int(rng.integers(len(data))), int(rng.integers(1, 17))
    way = WAYS[rng.integers(len(WAYS))]
    if way == "bit":
        copy[place] ^= 1 << rng.integers(8)
    elif way == "bits":
        for where in rng.integers(len(data), size=length):
            copy[where] ^= 1 << rng.integers(8)
    elif way == "zeros":
        copy[place : place + length] = bytes(len(copy[place : place + length]))
    elif way == "noise":
        copy[place : place + length] = rng.bytes(len(copy[place : place + length]))
    elif way == "character":
        copy[place] = int(rng.choice(PRINTABLE))
    elif way == "word":
        words = list(re.finditer(rb"[-+.\w]+", data))
        word = words[rng.integers(len(words))] if words else re.match(b"", data)
        assert word is not None
        copy[word.start() : word.end()] = HOSTILE[rng.integers(len(HOSTILE))]
    elif way == "insert":
        copy[place:place] = rng.bytes(length)
    elif way == "remove":
        del copy[place : place + length]
    elif way == "repeat":
        copy[place:place] = copy[place : place + 16 * length]
    else:
        other = int(rng.integers(len(data)))
        first, second = sorted((place, other))
        copy[first : first + length], copy[second : second + length] = (
            copy[second : second + length],
            copy[first : first + length],
        )
    return f"{way} at {place}", bytes(copy)


def every_damage(data: bytes, seed: int, cut: int, bad: int) -> Iterator[tuple[str, bytes]]:
    """So many files cut short, spread over the file and near its end, and so many gone bad otherwise."""
    rng = np.random.default_rng(seed)
    places = {int(place) for place in np.linspace(0, len(data) - 1, min(cut, len(data)))}
    places |= set(range(max(0, len(data) - 8), len(data)))
    yield from cuts(data, iter(sorted(places)))
    for _ in range(bad):
        yield damaged(data, rng)


def whole_file(kind: Kind, folder: Path) -> tuple[bytes, object]:
    """A whole file of a kind, and what is read of it."""
    path = folder / f"whole{kind.suffix}"
    data = kind.write(path)
    path.write_bytes(data)
    return data, kind.read(path)


def outcome(kind: Kind, path: Path, whole: object, way: str) -> str:
    """What a reader makes of a damaged file: "refused", "same" or "other"; an AssertionError for all else."""
    start = time.perf_counter()
    try:
        found = kind.read(path)
    except (PolhodeError, MemoryError) as error:
        told = str(error)
        if isinstance(error, PolhodeError) and (path.name not in told or "\n" in told):
            raise AssertionError(f"{way}: does not name the file in one line: {told}") from error
        result = "refused"
    except Exception as error:
        raise AssertionError(f"{way}: {type(error).__name__}: {error}") from error
    else:
        result = "same" if found == whole else "other"
    took = time.perf_counter() - start
    assert took < LONGEST, f"{way}: {took} s"
    assert result != "other" or not kind.has_checksum, f"{way}: read another one"
    assert result != "other" or not way.startswith("cut") or not kind.is_self_ending, (
        f"{way}: read another one"
    )
    return result


def tally(kind: Kind, folder: Path, ways: Iterator[tuple[str, bytes]], whole: object) -> Counter[str]:
    """How many files were refused, read the same and read as another one."""
    counts: Counter[str] = Counter()
    path = folder / f"damaged{kind.suffix}"
    for way, data in ways:
        path.write_bytes(data)
        counts[outcome(kind, path, whole, way)] += 1
    return counts
