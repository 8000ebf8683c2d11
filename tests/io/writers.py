"""Everything that writes a file, by name; run as a program, each of them with a disk that is full half way.

``python writers.py FOLDER`` writes every file whole, puts old content in its place, and lets the system
refuse what goes beyond a part of the file's size. It prints, as JSON, what became of each.
"""

from __future__ import annotations

import contextlib
import io
import json
import resource
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from polhode import Trajectory, solids
from polhode.cli import main
from polhode.uncertainty import ledger

__all__ = ["OLD", "WRITERS"]

OLD = b"what stood here before\n" * 400
PARTS = (0.0, 0.6)
"""Of the size of the whole file."""
_READ = {
    "part.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    "arm.urdf": """<robot name="r"><link name="a"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><box size="1 2 3"/></geometry></visual></link></robot>
""",
    "craft.csv": "id,parent,mass,Cx,Cy,Cz,Ipoint,sigma_mass\na,,,,,,,\nb,a,1,0,0,0,TRUE,0.1\n",
    "pair.toml": """[[part]]
name = "b"
solid = "cube"
side = 1
mass = 1
""",
    "n2.xyz": "2\nnitrogen\nN 0 0 0\nN 0 0 1.1\n",
}
"""What the commands read."""


def _motion() -> Trajectory:
    return solids.box((3.0, 2.0, 1.0), mass=1.0).simulate(np.linspace(0.0, 1.0, 4), (0.1, 1.0, 0.2))


def _ledger() -> Any:
    point = {"mass": 1.0, "Cx": 0.5, "Cy": 0.0, "Cz": 0.0, "Ipoint": True, "sigma_mass": 0.1}
    return ledger([{"id": "all"}, *({"id": f"p{k}", "parent": "all"} | point for k in range(100))])


def _stack() -> Any:
    return solids.box(np.linspace(1.0, 2.0, 300).reshape(100, 3), mass=1.0)


def _command(*words: str) -> Callable[[Path], object]:
    """A command whose word "OUT" is the file."""

    def act(path: Path) -> object:
        told = io.StringIO()
        names = {"OUT": str(path), **{name: str(path.parent / name) for name in _READ}}
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(told):
            code = main([names.get(word, word) for word in words])
        if code == 2:
            raise OSError(told.getvalue().strip())
        return code

    return act


_MOTION = ("--omega", "0", "1", "0.01", "--end", "1", "--times", "4", "--save", "OUT")
_SPIN = ("spin", "part.obj", *_MOTION)
_LINES = ("spin", "--moments", "1 2 2.5", *_MOTION)
"""Draws lines alone: a body is of thousands of patches, which formats of lines write one by one."""

WRITERS: dict[str, tuple[str, Callable[[Path], object]]] = {
    "body, JSON": ("body.json", lambda path: _stack().save(path)),
    "body, npz": ("body.npz", lambda path: _stack().save(path)),
    "motion, JSON": ("motion.json", lambda path: _motion().save(path)),
    "motion, npz": ("motion.npz", lambda path: _motion().save(path)),
    "motion, CSV": ("motion.csv", lambda path: _motion().save(path)),
    "page": ("motion.html", lambda path: _motion().animate(path)),
    "GIF": ("motion.gif", lambda path: _motion().animate(path, frames=4, size=64)),
    "film": ("motion.mp4", lambda path: _motion().animate(path, frames=4, size=64)),
    "report": ("report.txt", _command("report", "part.obj", "--output", "OUT")),
    "report, JSON": ("report.json", _command("report", "part.obj", "--output", "OUT")),
    "check": ("verdict.json", _command("check", "arm.urdf", "--output", "OUT")),
    "fix": ("better.urdf", _command("check", "arm.urdf", "--fix", "OUT")),
    "molecule": ("constants.json", _command("molecule", "n2.xyz", "--output", "OUT")),
    "spin": ("spin.json", _command(*_SPIN[:-2], "--output", "OUT")),
    "spin, PNG": ("spin.png", _command(*_LINES)),
    "spin, PDF": ("spin.pdf", _command(*_LINES)),
    "spin, SVG": ("spin.svg", _command(*_LINES)),
    "ledger, CSV": ("all.csv", lambda path: _ledger().to_csv(path)),
    "ledger, JSON": ("all.json", lambda path: _ledger().to_json(path)),
    "ledger, report": ("told.txt", _command("ledger", "craft.csv", "--output", "OUT")),
    "ledger, rows": ("rows.csv", _command("ledger", "craft.csv", "--save", "OUT")),
    "assembly, report": ("told.txt", _command("assemble", "pair.toml", "--output", "OUT")),
    "snippet": ("told.urdf", _command("report", "pair.toml", "--as", "solidworks", "--output", "OUT")),
    "ledger, PNG": ("craft.png", _command("ledger", "craft.csv", "--save", "OUT")),
}


def filled_disk(name: str, folder: Path) -> list[str]:
    """What is wrong with a writer whose disk is full half way."""
    file, write = WRITERS[name]
    path = folder / file
    write(path)
    size = path.stat().st_size
    faults: list[str] = []
    for part in PARTS:
        path.write_bytes(OLD)
        before = sorted(folder.iterdir())
        resource.setrlimit(resource.RLIMIT_FSIZE, (max(int(part * size), 1), resource.RLIM_INFINITY))
        try:
            write(path)
        except OSError as error:
            if file not in str(error):
                faults.append(f"{part}: the error does not name the file: {error}")
        except BaseException as error:
            faults.append(f"{part}: {type(error).__name__}: {error}")
        else:
            faults.append(f"{part}: no error")
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        if path.read_bytes() != OLD:
            faults.append(f"{part}: the old file is lost")
        if sorted(folder.iterdir()) != before:
            faults.append(f"{part}: left over {set(folder.iterdir()) - set(before)}")
    return faults


def run(folder: Path) -> dict[str, list[str]]:
    """Every writer, each in a folder of its own."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # so that the write fails, as on a full disk
    found = {}
    for number, name in enumerate(WRITERS):
        own = folder / str(number)
        own.mkdir()
        for file, text in _READ.items():
            (own / file).write_text(text, "utf-8")
        found[name] = filled_disk(name, own)
    return found


if __name__ == "__main__":
    print(json.dumps(run(Path(sys.argv[1]))))
