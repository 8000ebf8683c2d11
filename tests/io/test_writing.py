"""Files are written whole or not at all, over nothing that is read, and by one module alone."""

from __future__ import annotations

import ast
import json
import os
import signal
import stat
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import polhode
import pytest
from command_line import one_line, run
from polhode import Trajectory, solids
from polhode.io.writing import replacing, write_bytes, writing
from writers import OLD, WRITERS

PACKAGE = Path(polhode.__file__).parent
MESH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def test_every_writer_on_a_full_disk(tmp_path: Path) -> None:
    """The old file stands, nothing is left over, and the error names the file."""
    done = subprocess.run(
        [sys.executable, Path(__file__).with_name("writers.py"), tmp_path],
        check=True,
        capture_output=True,
        text=True,
        timeout=110,
    )
    found = json.loads(done.stdout)
    assert list(found) == list(WRITERS)
    assert {name: faults for name, faults in found.items() if faults} == {}


@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError, MemoryError, OSError(28, "full")])
def test_what_ends_a_writing_leaves_the_old_file(error: Any, tmp_path: Path) -> None:
    path = tmp_path / "old.bin"
    path.write_bytes(OLD)
    kind = error if isinstance(error, type) else type(error)

    def into_a_stream() -> None:
        with writing(path) as stream:
            stream.write(b"half")
            raise error

    def by_a_name() -> None:
        with replacing(path) as new:
            new.write_bytes(b"half")
            raise error

    for write in (into_a_stream, by_a_name):
        with pytest.raises(kind):
            write()
    assert path.read_bytes() == OLD
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("suffix", [".gif", ".mp4"])
def test_a_film_that_is_given_up(suffix: str, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    path = tmp_path / f"film{suffix}"
    path.write_bytes(OLD)
    motion = solids.box((3.0, 2.0, 1.0), mass=1.0).free_motion((0.1, 1.0, 0.2)).at(np.linspace(0.0, 1.0, 5))

    def stop(fraction: float) -> None:
        if fraction > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        motion.animate(path, duration=1.0, progress=stop)
    assert path.read_bytes() == OLD
    assert list(tmp_path.iterdir()) == [path]


def test_killed_in_the_middle(tmp_path: Path) -> None:
    """Not even then: what is left over has another name."""
    path = tmp_path / "old.bin"
    path.write_bytes(OLD)
    program = f"""
import sys, time
from polhode.io.writing import writing
with writing({str(path)!r}) as stream:
    stream.write(bytes(1 << 20))
    print("half", flush=True)
    time.sleep(60)
"""
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        process.send_signal(signal.SIGKILL)
    assert path.read_bytes() == OLD
    assert [name.name[:9] for name in tmp_path.iterdir() if name != path] == [".polhode-"]


class TestThePlace:
    def test_permissions_and_links_are_kept(self, tmp_path: Path) -> None:
        (tmp_path / "there").mkdir()
        target, link = tmp_path / "there" / "body.json", tmp_path / "link.json"
        target.write_bytes(OLD)
        target.chmod(0o640)
        link.symlink_to(target)
        write_bytes(link, b"new")
        assert link.is_symlink()
        assert target.read_bytes() == b"new"
        assert stat.S_IMODE(target.stat().st_mode) == 0o640
        assert [path.name for path in target.parent.iterdir()] == [target.name]

    def test_a_new_file_has_the_permissions_that_new_files_have(self, tmp_path: Path) -> None:
        plain, ours = tmp_path / "plain", tmp_path / "ours"
        for mask in (0o022, 0o077):
            old = os.umask(mask)
            try:
                plain.write_bytes(b"")
                write_bytes(ours, b"")
            finally:
                os.umask(old)
            assert ours.stat().st_mode == plain.stat().st_mode
            plain.unlink()
            ours.unlink()

    def test_a_link_to_nothing_makes_its_target(self, tmp_path: Path) -> None:
        (tmp_path / "link").symlink_to("target")
        write_bytes(tmp_path / "link", b"new")
        assert (tmp_path / "target").read_bytes() == b"new"
        assert (tmp_path / "link").is_symlink()

    def test_a_name_as_long_as_can_be(self, tmp_path: Path) -> None:
        for name in ("x" * 250 + ".json", "x." + "y" * 250):
            write_bytes(tmp_path / name, b"new")
            assert (tmp_path / name).read_bytes() == b"new"

    def test_a_pipe_is_written_straight_into(self, tmp_path: Path) -> None:
        pipe = tmp_path / "motion.csv"
        os.mkfifo(pipe)
        motion = solids.box((3.0, 2.0, 1.0), mass=1.0).free_motion((0.1, 1.0, 0.2)).at([0.0, 1.0])
        motion.save(tmp_path / "whole.csv")
        got: list[bytes] = []
        reader = threading.Thread(target=lambda: got.append(pipe.read_bytes()))
        reader.start()
        motion.save(pipe)
        reader.join(timeout=20)
        assert got == [(tmp_path / "whole.csv").read_bytes()]
        assert stat.S_ISFIFO(pipe.stat().st_mode)

    def test_devices(self) -> None:
        write_bytes("/dev/null", OLD)
        assert stat.S_ISCHR(Path("/dev/null").stat().st_mode)
        with pytest.raises(OSError, match="'/dev/full'"):
            write_bytes("/dev/full", OLD)
        assert stat.S_ISCHR(Path("/dev/full").stat().st_mode)

    @pytest.mark.parametrize("name", ["-", "/dev/stdout", "/proc/self/fd/1"])
    def test_standard_output(self, name: str, tmp_path: Path) -> None:
        """Behind what it holds already, be it a pipe or a file."""
        program = f"""
import os
from polhode.io.writing import write_bytes
os.write(1, b"before ")
write_bytes({name!r}, b"new ")
os.write(1, b"after")
"""
        command = [sys.executable, "-c", program]
        assert subprocess.run(command, check=True, capture_output=True).stdout == b"before new after"
        with (tmp_path / "out").open("wb") as out:
            subprocess.run(command, check=True, stdout=out)
        assert (tmp_path / "out").read_bytes() == b"before new after"
        with Path("/dev/full").open("wb") as full:
            failed = subprocess.run(
                [*command[:2], program.replace("os.write", "str")],
                check=False,
                stdout=full,
                stderr=subprocess.PIPE,
            )
        assert failed.returncode == 1

    def test_what_can_not_be_written(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        body = solids.sphere(1.0, mass=1.0)
        (tmp_path / "folder.json").mkdir()
        with pytest.raises(IsADirectoryError, match=r"folder\.json"):
            body.save(tmp_path / "folder.json")
        with pytest.raises(FileNotFoundError, match=r"no/body\.json"):
            body.save(tmp_path / "no" / "body.json")
        (tmp_path / "file").write_bytes(OLD)
        with pytest.raises(NotADirectoryError, match=r"file/body\.json"):
            body.save(tmp_path / "file" / "body.json")
        with pytest.raises(OSError, match=r"x\.json"):
            body.save(tmp_path / ("x" * 300 + ".json"))
        (tmp_path / "body.json").write_bytes(OLD)
        with monkeypatch.context() as patch:
            patch.setattr(os, "access", lambda *_: False)  # as for who is not root
            with pytest.raises(PermissionError, match=r"body\.json"):
                body.save(tmp_path / "body.json")

        def no(*_: object) -> int:
            raise PermissionError(13, "Permission denied", "hidden")

        with monkeypatch.context() as patch:
            patch.setattr(os, "open", no)
            with pytest.raises(PermissionError, match=r"takes no new file.*body\.json"):
                body.save(tmp_path / "body.json")
        assert (tmp_path / "body.json").read_bytes() == OLD
        assert len(list(tmp_path.iterdir())) == 3

    def test_readers_see_the_old_file_or_the_new_one(self, tmp_path: Path) -> None:
        path = tmp_path / "motion.json"
        box = solids.box((3.0, 2.0, 1.0), mass=1.0)
        motions = [box.free_motion((0.1, 1.0, 0.2)).at(np.linspace(0.0, 1.0, n)) for n in (2, 300)]
        motions[0].save(path)
        counts = set()
        stop = threading.Event()

        def write() -> None:
            while not stop.is_set():
                for motion in motions:
                    motion.save(path)

        writer = threading.Thread(target=write)
        writer.start()
        try:
            for _ in range(30):
                counts.add(len(Trajectory.from_file(path)))
        finally:
            stop.set()
            writer.join()
        assert counts <= {2, 300}


class TestOutputsOfCommands:
    @pytest.fixture
    def folder(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
        (tmp_path / "part.obj").write_text(MESH, "utf-8")
        (tmp_path / "link.obj").symlink_to("part.obj")
        (tmp_path / "hard.obj").hardlink_to(tmp_path / "part.obj")
        (tmp_path / "n2.xyz").write_text("2\nnitrogen\nN 0 0 0\nN 0 0 1.1\n", "utf-8")
        (tmp_path / "known.json").write_text('{"mass": 1}', "utf-8")
        (tmp_path / "arm.urdf").write_text(
            '<robot name="r"><link name="a"><inertial><mass value="1"/>'
            '<inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/></inertial>'
            '<visual><geometry><mesh filename="part.obj"/></geometry></visual></link></robot>',
            "utf-8",
        )
        monkeypatch.chdir(tmp_path)
        return tmp_path

    @pytest.mark.parametrize(
        ("command", "says"),
        [
            ("report part.obj --output part.obj", "--output: part.obj is a file that is read"),
            ("report part.obj --output ./part.obj", "--output: part.obj is a file that is read"),
            ("report part.obj --output link.obj", "--output: link.obj is a file that is read"),
            ("report link.obj --output hard.obj", "--output: hard.obj is a file that is read"),
            ("report part.obj --expect known.json --output known.json", "--output: known.json is a file"),
            ("molecule n2.xyz --output n2.xyz", "--output: n2.xyz is a file that is read"),
            ("spin part.obj --omega 0 1 0 --output hard.obj", "--output: hard.obj is a file that is read"),
            ("check arm.urdf --output arm.urdf", "--output: arm.urdf is a file that is read"),
            ("check arm.urdf --fix arm.urdf", "--fix: arm.urdf is a file that is read"),
            ("check arm.urdf --fix hard.obj", "--fix: hard.obj is a file that is read"),
            ("check arm.urdf --output link.obj", "--output: link.obj is a file that is read"),
            ("check arm.urdf --fix a --output a", "--output: a is written by --fix too"),
            (
                "spin part.obj --omega 0 1 0 --end 1 --save a.csv --save ./a.csv",
                "--save: a.csv is written by --save",
            ),
            (
                "spin part.obj --omega 0 1 0 --end 1 --save a.json --output a.json",
                "--output: a.json is written by",
            ),
        ],
    )
    def test_over_a_file_that_is_read(self, command: str, says: str, folder: Path) -> None:
        before = {path.name: path.read_bytes() for path in folder.iterdir()}
        code, out, err = run(*command.split())
        assert code == 2
        assert out == ""
        assert one_line(err)
        assert says in err
        assert {path.name: path.read_bytes() for path in folder.iterdir()} == before

    def test_beside_it(self, folder: Path) -> None:
        assert run("report", "part.obj", "--output", "report.json")[0] == 0
        assert json.loads((folder / "report.json").read_text("utf-8"))["mass"] == pytest.approx(1 / 6)
        assert run("report", "part.obj", "--output", "/dev/null") == (0, "", "")
        told = run("report", "part.obj", "--format", "json", "--output", "-")
        assert told[0] == 0
        assert json.loads(told[1])["mass"] == pytest.approx(1 / 6)
        code, _, err = run("report", "part.obj", "--output", "/dev/full")
        assert code == 2
        assert err == "polhode: /dev/full: No space left on device\n"


def calls(tree: ast.AST) -> list[ast.Call]:
    """Every call in a module."""
    return [node for node in ast.walk(tree) if isinstance(node, ast.Call)]


def writes_by_path(call: ast.Call) -> bool:
    """Whether a call would write a file by its name."""
    name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
    if name == "open":
        # A member of an archive is no file: the archive itself was opened by its own line.
        is_member = isinstance(call.func, ast.Attribute) and getattr(call.func.value, "id", "") == "archive"
        if is_member:
            return False
        by_name = call.args[1:] if isinstance(call.func, ast.Name) else call.args
        words = [*by_name, *(word.value for word in call.keywords if word.arg == "mode")]
        modes = [
            word.value for word in words if isinstance(word, ast.Constant) and isinstance(word.value, str)
        ]
        is_of_os = isinstance(call.func, ast.Attribute) and getattr(call.func.value, "id", "") == "os"
        return is_of_os or any(set(mode) & set("wax+") for mode in modes)
    if name == "ZipFile" and not any(isinstance(word, ast.Constant) for word in call.args[1:]):
        return False
    if name in ("savez", "savez_compressed", "savetxt", "savefig", "ZipFile"):
        return not (call.args and isinstance(call.args[0], ast.Name) and call.args[0].id == "stream")
    if isinstance(call.func, ast.Attribute):
        return name in ("write_text", "write_bytes", "tofile", "dump", "copyfile", "to_netcdf", "fdopen")
    return False


def test_no_other_module_opens_a_file_for_writing() -> None:
    # The last two open what they read, and the device that swallows all.
    allowed = {"io/writing.py", "robots/sources.py", "cli/terminal.py"}
    found = {
        f"{path.relative_to(PACKAGE).as_posix()}:{call.lineno}"
        for path in PACKAGE.rglob("*.py")
        for call in calls(ast.parse(path.read_text("utf-8")))
        if writes_by_path(call)
    }
    assert {place for place in found if place.partition(":")[0] not in allowed} == set()
    by_path = "open('a', 'w'); path.open('xb'); path.write_text(''); np.savez(path); os.open(path, flags)"
    by_path += "; ZipFile(path, 'w')"
    assert all(writes_by_path(call) for call in calls(ast.parse(by_path)))
    others = "open('a'); path.open('rb'); write_bytes(path, b''); np.savez(stream); ZipFile(path)"
    others += "; figure.savefig(stream); ZipFile(stream, 'w'); archive.open('a.npy', 'w')"
    assert not any(writes_by_path(call) for call in calls(ast.parse(others)))
