"""Small files that ask for much: each reader ends, with an error of its own, in little time and memory."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import time
import traceback
import warnings
from collections.abc import Callable
from contextlib import suppress
from fractions import Fraction
from pathlib import Path

import pytest
from hostile_files import HOSTILE, dae, doubling
from polhode import RigidBody, Trajectory, assembly, robots
from polhode.errors import PolhodeError
from polhode.io import cad_process, load
from polhode.io.budget import LIMITS, Budget, LimitError
from polhode.uncertainty import ledger

SECONDS, MEGABYTES = 10.0, 1000


def _solid(path: Path) -> object:
    return RigidBody.from_file(path, density=1.0)


READERS: dict[str, Callable[[Path], object]] = {
    "molecules": RigidBody.from_file,
    "robots": lambda path: robots.check(robots.read_robot(path)),
    "assemblies": lambda path: assembly.read(path).body,
    "ledgers": ledger,
    "bodies": RigidBody.from_file,
    "motions": Trajectory.from_file,
}
NEEDED = {"VTK": "pyvista", "CAD": "OCP", "meshes": "trimesh"}
SLOW = {
    "3MF: a mesh of many items", "3MF: components of components", "3MF: items", "3MF: negative volumes",
    "3MF: nested", "3MF: one long token", "3MF: packed elements", "3MF: packed vertices", "3MF: settings",
    "COLLADA: a node of many children", "COLLADA: a node shown again and again",
    "COLLADA: a packed text of zeros", "COLLADA: geometries of nodes", "COLLADA: groups of one source",
    "COLLADA: packed elements", "VTK: XML: pieces", "assemblies: a file again",
    "assemblies: a large file again", "assemblies: copies", "assemblies: parts",
    "assemblies: round parts that overlap", "glTF: a chain of nodes", "glTF: meshes of many primitives",
    "ledgers: shared sources in a chain", "meshes: OBJ: packed lines", "meshes: OFF: a large polygon",
    "meshes: OFF: packed words", "meshes: PLY: a large polygon", "meshes: STL: packed facets",
    "robots: MJCF: bodies", "robots: SDF: a large model again", "robots: URDF: a chain",
    "robots: URDF: a mesh in many scales", "robots: URDF: links", "robots: URDF: shapes",
}  # fmt: skip
"""Cases of a second or more, with the mark `long`."""


@pytest.mark.skipif(sys.platform != "linux", reason="processes are forked")
@pytest.mark.timeout(300)
@pytest.mark.parametrize("kind", [kind for kind in HOSTILE if kind != "CAD"])
def test_each_reader_ends(kind: str, tmp_path: Path) -> None:
    check_readers(kind, tmp_path, is_slow=False)


@pytest.mark.long
@pytest.mark.skipif(sys.platform != "linux", reason="processes are forked")
@pytest.mark.timeout(600)
@pytest.mark.parametrize("kind", HOSTILE)
def test_each_reader_ends_in_its_time(kind: str, tmp_path: Path) -> None:
    check_readers(kind, tmp_path, is_slow=True)


def check_readers(kind: str, folder: Path, *, is_slow: bool) -> None:
    """Read each file of a kind in a process of its own, whose time and memory are its own."""
    if kind in NEEDED:
        pytest.importorskip(NEEDED[kind])
    reader = READERS.get(kind, _solid)
    wrong = []
    for number, (name, case) in enumerate(HOSTILE[kind]().items()):
        if is_slow != (kind == "CAD" or f"{kind}: {name}" in SLOW):
            continue
        files = case() if callable(case) else case
        assert sum(map(len, files.values())) < 1_200_000
        place = folder / str(number)
        place.mkdir()
        for file, data in files.items():
            (place / file).write_bytes(data)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # no thread of this process is at work
            child = os.fork()
        if child == 0:
            os._exit(_end_of(reader, place / next(iter(files))))
        _, status, usage = os.wait4(child, 0)
        code, seconds = os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime
        if code != 0 or seconds > SECONDS:
            wrong.append(f"{name}: exit code {code} after {seconds:.1f} s")
    assert not wrong


def _end_of(reader: Callable[[Path], object], path: Path) -> int:
    """Read the file in memory of its own; return 0 for a result or an error of the package."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    try:
        with suppress(PolhodeError):
            reader(path)
    except BaseException:
        traceback.print_exc()
        return 1
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return 0 if (most - before) * 1024 < MEGABYTES * 10**6 else 2


class TestBudget:
    @pytest.mark.parametrize("kind", LIMITS)
    @pytest.mark.parametrize("size", [0, 5, 123_456])
    def test_both_sides_of_each_limit(self, kind: str, size: int) -> None:
        least, per_byte, way_out = LIMITS[kind]
        most = least + int(Fraction(per_byte) * size)
        budget = Budget("a.file", size)
        budget.spend(kind, most)
        assert budget.remaining(kind) == 0
        with pytest.raises(LimitError, match=rf"^a\.file: there are more than {most} {kind}") as caught:
            budget.spend(kind)
        assert str(caught.value).endswith(f"; {way_out}")

    def test_other_files_count_once(self) -> None:
        budget = Budget("a", 100)
        before = budget.most("triangles")
        budget.add_file(50, "b")
        budget.add_file(50, "b")
        assert budget.most("triangles") == before + 50

    def test_a_scene_just_below_it(self, tmp_path: Path) -> None:
        """2^13 places of a tetrahedron are read, 2^60 are not."""
        path = tmp_path / "a.dae"
        shown = '<instance_geometry url="#g"/>'
        start = '<node><instance_node url="#n0"/></node>'
        path.write_bytes(dae(doubling(13, shown), start))
        assert load(path).groups == (("n13", 4),) * 2**13
        path.write_bytes(dae(doubling(60, shown), start))
        with pytest.raises(LimitError, match="placements, the most for"):
            load(path)


@pytest.mark.skipif(sys.platform != "linux", reason="a signal of Linux")
@pytest.mark.timeout(120)
def test_the_process_of_occt_ends_with_its_parent(tmp_path: Path) -> None:
    """Even where it computes without end, in which no thread of Python runs."""
    pid = tmp_path / "pid"
    (tmp_path / "a.step").touch()
    child = (
        "import os, sys; from polhode.io import cad_process; cad_process._end_with_parent(int(sys.argv[2])); "
        f"open({str(pid)!r}, 'w').write(str(os.getpid()))\nwhile True: pass"
    )
    parent = (
        "from pathlib import Path; from polhode.io import cad_process; "
        f"cad_process._COMMAND = ['-c', {child!r}]; "
        f"cad_process.read_cad_apart(Path({str(tmp_path / 'a.step')!r}))"
    )
    process = subprocess.Popen([sys.executable, "-c", parent])
    end = time.monotonic() + 60.0
    while not (pid.exists() and pid.read_text()) and time.monotonic() < end:
        time.sleep(0.05)
    number = int(pid.read_text())
    process.send_signal(signal.SIGKILL)
    process.wait()
    while _is_running(number) and time.monotonic() < end:
        time.sleep(0.05)
    assert not _is_running(number)


def test_the_seconds_of_occt() -> None:
    """A megabyte has seven seconds to be read, eight with what its solids share; a second is always left."""
    sizes = [(45_000_000, None), (45_000_000, 900_000), (45_000_000, 2_000_000), (225_000, 40_000)]
    assert [cad_process._megabytes(*each) for each in sizes] == [45.0, 1.0, 2.0, 0.225]
    assert [cad_process._reading(size) for size in (0.0, 1.0, 10.0)] == [4.0, 7.0, 34.0]
    assert [cad_process._sharing(1.0, elapsed) for elapsed in (0.0, 3.0, 3.1, 6.9, 7.1, 20.0)] == [
        5.0, 5.0, 4.9, 1.1, 1.0, 1.0
    ]  # fmt: skip
    assert [cad_process._sharing(3.0, elapsed) for elapsed in (0.0, 20.0, 30.0)] == [15.0, 4.0, 1.0]


def _is_running(number: int) -> bool:
    try:
        os.kill(number, 0)
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (ProcessLookupError, FileNotFoundError):
        return False
