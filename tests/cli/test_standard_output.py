"""Standard output that is closed, or full, or left by its reader: an exit code, and at most one line."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr
from pathlib import Path

import pytest
from polhode.cli import main

MESH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
ROBOT = """<robot name="r"><link name="a"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>
"""
COMMANDS = (
    "",
    "--help",
    "--version",
    "report --help",
    "report part.obj",
    "report part.obj --format json",
    "check arm.urdf",
    "molecule n2.xyz",
    "spin part.obj --omega 0 1 0",
    "ledger craft.csv",
    "ledger craft.csv --output -",
    "demo --save demo",
)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "part.obj").write_text(MESH, "utf-8")
    (tmp_path / "arm.urdf").write_text(ROBOT, "utf-8")
    (tmp_path / "craft.csv").write_text("id,parent,mass,Cx,Cy,Cz,Ipoint\na,,1,0,0,0,TRUE\n", "utf-8")
    (tmp_path / "n2.xyz").write_text("2\nnitrogen\nN 0 0 0\nN 0 0 1.1\n", "utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@contextmanager
def left_pipe(buffering: int) -> Iterator[io.TextIOWrapper]:
    """A pipe whose reader has gone."""
    read, write = os.pipe()
    os.close(read)
    stream = open(write, "w", buffering=buffering, encoding="utf-8")  # noqa: PTH123, SIM115 (no path)
    yield stream
    stream.close()  # which fails where something is left to be written


def outcome(
    command: str, stream: io.TextIOWrapper | None, monkeypatch: pytest.MonkeyPatch
) -> tuple[int, str]:
    """Exit code and stderr."""
    told = io.StringIO()
    with monkeypatch.context() as patch, redirect_stderr(told):
        patch.setattr(sys, "stdout", stream)
        code = main(command.split())
    return code, told.getvalue()


@pytest.mark.parametrize("buffering", [1, 1 << 20])
@pytest.mark.parametrize("command", COMMANDS)
def test_the_reader_has_left(command: str, buffering: int, monkeypatch: pytest.MonkeyPatch) -> None:
    with left_pipe(buffering) as stream:
        assert outcome(command, stream, monkeypatch) == (0, "")


@pytest.mark.parametrize("command", COMMANDS)
def test_the_disk_is_full(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with Path("/dev/full").open("w", encoding="utf-8") as stream:
        code, told = outcome(command, stream, monkeypatch)
    assert code == 2
    assert told == "polhode: standard output: No space left on device\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_it_is_closed(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever closes it asks for the exit code alone."""
    assert outcome(command, None, monkeypatch) == (1 if command.startswith("check") else 0, "")


def test_what_is_wrong_is_told_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    with left_pipe(1) as stream:
        code, told = outcome("report absent.obj", stream, monkeypatch)
    assert code == 2
    assert told == "polhode: absent.obj: No such file or directory; check the path\n"


def test_what_is_left_over_when_the_process_ends() -> None:
    """Python flushes standard output once more, which may tell nothing new."""
    command = [sys.executable, "-m", "polhode", "report", "part.obj"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() in (0, -13)
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(command, check=False, stdout=full, stderr=subprocess.PIPE, text=True)
    assert (done.returncode, done.stderr) == (2, "polhode: standard output: No space left on device\n")
    for closed in (">&-", "2>&-", ">&- 2>&-", "</dev/null >&- 2>&-"):
        done = subprocess.run(
            ["/bin/sh", "-c", f'"$@" {closed}', "sh", *command], check=False, capture_output=True, text=True
        )
        assert (done.returncode, done.stderr) == (0, "")


def test_standard_input_that_never_ends() -> None:
    command = [sys.executable, "-m", "polhode", "report", "-"]
    with Path("/dev/zero").open("rb") as endless:
        done = subprocess.run(command, check=False, stdin=endless, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert "standard input is a device" in done.stderr
    assert done.stderr.count("\n") == 1
