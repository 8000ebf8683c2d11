"""What ``polhode check`` costs: ``python benchmarks/check.py [--rounds N] [FILE ...]``.

For each file, by default one of thirty links with a mesh each that is made here: seconds of a whole process
beside one that imports alone, in turn, and seconds of CPU in a process that has imported everything; median,
least and most of the rounds.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from command_line import torus
from meshes import write_stl
from polhode import robots

LINKS = 30
IMPORTS = "import cyclopts, rich.console, rich.text, numpy, polhode._core"
LINK = """<link name="l{0}"><inertial><mass value="1"/>
<inertia ixx="0.04" iyy="0.04" izz="0.08" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><mesh filename="{0}.stl" scale="0.05 0.05 0.05"/></geometry></collision></link>"""
JOINT = """<joint name="j{1}" type="continuous"><parent link="l{0}"/><child link="l{1}"/></joint>"""


def written(folder: Path) -> Path:
    """A chain of links, each with a mesh of 2000 triangles."""
    for k in range(LINKS):
        write_stl(folder / f"{k}.stl", *torus(50, 20))
    parts = [LINK.format(k) for k in range(LINKS)] + [JOINT.format(k, k + 1) for k in range(LINKS - 1)]
    path = folder / "chain.urdf"
    path.write_text(f"<robot name='chain'>{''.join(parts)}</robot>")
    return path


def seconds(*arguments: str) -> float:
    """Of a process."""
    # As installed: pip compiles modules, PYTHONDONTWRITEBYTECODE would compile them in each run.
    env = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    start = time.perf_counter()
    subprocess.run([sys.executable, *arguments], check=False, stdout=subprocess.DEVNULL, env=env)
    return time.perf_counter() - start


def of_cpu(file: Path) -> float:
    """Of reading and judging in this process."""
    start = time.process_time()
    robots.check(robots.read_robot(file))
    return time.process_time() - start


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE")
    parser.add_argument("--rounds", type=int, default=9)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for file in options.files or [written(Path(folder))]:
            of_cpu(file)  # what is imported late is
            rows: dict[str, list[float]] = {"process": [], "its imports alone": [], "CPU after imports": []}
            for _ in range(options.rounds):
                rows["process"].append(seconds("-m", "polhode", "check", str(file)))
                rows["its imports alone"].append(seconds("-c", IMPORTS))
                rows["CPU after imports"].append(of_cpu(file))
            print(f"{file.name}: median, least and most of {options.rounds} rounds")
            for name, times in rows.items():
                print(f"  {name:18} {statistics.median(times):7.3f} {min(times):7.3f} {max(times):7.3f} s")


if __name__ == "__main__":
    main()
