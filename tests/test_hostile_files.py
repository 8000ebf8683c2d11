"""Small files that ask for much: each reader ends, with an error of its own, in little time and memory."""

# ruff: noqa: E501, SIM105, S110 (texts of programs)
from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from hostile_files import HOSTILE, dae, doubling
from polhode import RigidBody, Trajectory, assembly, robots
from polhode.errors import PolhodeError
from polhode.files import load
from polhode.files.budget import LIMITS, Budget, LimitError
from polhode.uncertainty import ledger

SECONDS, MEGABYTES = 10.0, 1000


def _solid(path: Path) -> object:
    return RigidBody.from_file(path, density=1.0)


READERS: dict[str, Callable[[Path], object]] = {
    "molecules": RigidBody.from_file,
    "robots": lambda path: robots.check(robots.read_robot(path)),
    "assemblies": lambda path: assembly.read(path).body,
    "ledgers": ledger,
    "bodies": RigidBody.load,
    "motions": Trajectory.from_file,
}
NEEDED = {"VTK": "pyvista", "CAD": "OCP", "meshes": "trimesh"}
SLOW = {
    "COLLADA: packed elements", "COLLADA: a packed text of zeros", "robots: MJCF: bodies", "3MF: items",
    "3MF: packed vertices", "3MF: settings", "assemblies: round parts that overlap", "assemblies: a file again",
    "3MF: packed elements", "3MF: nested", "3MF: negative volumes", "ledgers: shared sources in a chain",
}  # fmt: skip
"""Cases of some seconds, with the mark `long`."""


def cases() -> list[Any]:
    found = []
    for kind, make in HOSTILE.items():
        for name in make():
            case = f"{kind}: {name}"
            marks = [pytest.mark.long] if case in SLOW or kind == "CAD" else []
            found.append(pytest.param(kind, name, id=case, marks=marks))
    return found


def used() -> float:
    own, children = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return own.ru_utime + own.ru_stime + children.ru_utime + children.ru_stime


@pytest.mark.timeout(120)
@pytest.mark.parametrize(("kind", "name"), cases())
def test_each_reader_ends(kind: str, name: str, tmp_path: Path) -> None:
    if kind in NEEDED:
        pytest.importorskip(NEEDED[kind])
    files = HOSTILE[kind]()[name]
    assert sum(map(len, files.values())) < 1_200_000
    for file, data in files.items():
        (tmp_path / file).write_bytes(data)
    path = tmp_path / next(iter(files))
    reader = READERS.get(kind, _solid)
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    pages = int(Path("/proc/self/statm").read_text().split()[0]) if sys.platform == "linux" else 0
    most = pages * resource.getpagesize() + MEGABYTES * 10**6
    start = used()
    try:
        if pages and kind not in ("VTK", "CAD"):  # whose libraries reserve more than they use
            resource.setrlimit(resource.RLIMIT_AS, (most, hard))
        reader(path)
    except PolhodeError:
        pass
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
    assert used() - start < SECONDS


class TestBudget:
    @pytest.mark.parametrize("kind", LIMITS)
    @pytest.mark.parametrize("size", [0, 5, 123_456])
    def test_both_sides_of_each_limit(self, kind: str, size: int) -> None:
        least, per_byte, way_out = LIMITS[kind]
        most = least + int(Fraction(per_byte) * size)
        budget = Budget("a.file", size)
        budget.spend(kind, most)
        assert budget.left(kind) == 0
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
    child = (
        "import os, sys; from polhode.files import cad_apart; cad_apart._end_with_parent(int(sys.argv[2])); "
        f"open({str(pid)!r}, 'w').write(str(os.getpid()))\nwhile True: pass"
    )
    parent = (
        f"from pathlib import Path; from polhode.files import cad_apart; cad_apart._COMMAND = ['-c', {child!r}]; "
        f"cad_apart.read_cad_apart(Path({str(tmp_path / 'a.step')!r}))"
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


def _is_running(number: int) -> bool:
    try:
        os.kill(number, 0)
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (ProcessLookupError, FileNotFoundError):
        return False
