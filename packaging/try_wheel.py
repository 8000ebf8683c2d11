"""Try the wheels of a folder: ``python packaging/try_wheel.py dist``.

What can be seen in a file is checked by auditwheel, abi3audit, check-wheel-contents and twine. Then the wheel
that fits this machine is installed into an environment of its own, where bodies move on several threads.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: Licences, also of what is compiled in, the bill of materials, types.
HELD = (
    r"/licenses/LICENSE-MIT$",
    r"/licenses/LICENSE-APACHE$",
    r"/licenses/LICENSE-THIRD-PARTY$",
    r"\.cyclonedx\.json$",
    r"^polhode/py\.typed$",
    r"^polhode/_core\.pyi$",
)
#: Runs in the fresh environment: threads share a body, a load and an accumulator; the bits are those of one.
PROGRAM = """
import sys, threading
from concurrent.futures import ThreadPoolExecutor
import numpy as np
import polhode
from polhode import MassAccumulator, RigidBody, loads, solids

body = solids.box((0.3, 0.2, 0.1), density=2700)
load = loads.constant_torque((0, 0, 1e-3), frame="body") + loads.damping(1e-4)
times = np.linspace(0, 20, 200)

def motion(_):
    return body.simulate(times, (1, 2, 3), load=load).omega.tobytes()

together = threading.Barrier(8)

def begin(number):
    together.wait()
    return [motion(number) for _ in range(5)]

with ThreadPoolExecutor(8) as pool:
    bits = {one for many in pool.map(begin, range(8)) for one in many}
assert bits == {motion(0)}, "threads change bits"

shared = MassAccumulator()
points = np.random.default_rng(1).random((1000, 3))

def add(number):
    for _ in range(20):
        shared.add(np.ones(len(points)), points)

with ThreadPoolExecutor(8) as pool:
    list(pool.map(add, range(8)))
mass = shared.finish().mass
assert mass == 160_000, mass

with_lock = getattr(sys, "_is_gil_enabled", lambda: True)()
is_free = "t" in getattr(sys, "abiflags", "")
assert not (is_free and with_lock), "the extension has called the lock back"
with_or_without = "without" if is_free else "with"
print("polhode", polhode.__version__, "on", sys.version.split()[0], with_or_without, "the lock")
"""


def main() -> None:
    """Check the files, and run what fits."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("dist", type=Path)
    parser.add_argument("--run", action="store_true", help="only install and run")
    options = parser.parse_args()
    wheels = sorted(options.dist.glob("*.whl"))
    if not wheels:
        parser.error(f"{options.dist}: no wheel")
    if not options.run:
        for wheel in wheels:
            check(wheel)
        if any("musllinux" in wheel.name for wheel in wheels):
            return
    with tempfile.TemporaryDirectory() as folder:
        tried(options.dist, Path(folder))


def check(wheel: Path) -> None:
    """What can be told without running it."""
    lacking = lacks(wheel)
    if lacking:
        sys.exit(f"{wheel.name}: {'; '.join(lacking)}")
    tool("twine", "check", "--strict", wheel)
    tool("check_wheel_contents", wheel)
    if "-abi3-" in wheel.name:
        tool("abi3audit", "--strict", wheel)
    if "manylinux" in wheel.name:
        told = tool("auditwheel", "show", wheel)
        tag = re.search(r'platform tag:\s*"(manylinux_\d+_\d+)_', told)
        if not tag or tag[1] not in ("manylinux_2_17", "manylinux_2_12", "manylinux_2_5"):
            sys.exit(f"{wheel.name}: not for systems of 2014:\n{told}")


def lacks(wheel: Path) -> list[str]:
    """What a wheel should hold and does not, and links of its description that lead nowhere."""
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        [metadata] = (name for name in names if name.endswith(".dist-info/METADATA"))
        told = archive.read(metadata).decode()
    lacking = [f"no {pattern}" for pattern in HELD if not any(re.search(pattern, name) for name in names)]
    home = next(iter(re.findall(r"^Project-URL: Repository, (\S+)$", told, re.MULTILINE)), None)
    if home is None:
        return [*lacking, "no address of the project"]
    for target in re.findall(r"\]\(([^)\s]+)\)", told):
        within = re.fullmatch(re.escape(home) + r"/(?:raw|tree|blob)/v[^/]+/([^#]+)(?:#.*)?", target)
        if not (ROOT / within[1]).exists() if within else not target.startswith("https://"):
            lacking.append(f"a link leads nowhere: {target}")
    return lacking


def tried(dist: Path, folder: Path) -> None:
    """Install the wheel and run the program from elsewhere."""
    python = folder / "venv" / ("Scripts" if sys.platform == "win32" else "bin") / "python"
    subprocess.run([sys.executable, "-m", "venv", folder / "venv"], check=True)
    pip = [python, "-m", "pip", "install", "--quiet"]
    subprocess.run([*pip, "numpy"], check=True)
    command = ["--no-index", "--no-deps", "--find-links", str(dist.resolve()), "polhode"]
    subprocess.run([*pip, *command], check=True)
    subprocess.run([python, "-c", PROGRAM], cwd=folder, check=True)


def tool(*command: str | Path) -> str:
    """What a tool of this environment says; its failure ends everything."""
    done = subprocess.run(
        [sys.executable, "-m", *map(str, command)], check=False, capture_output=True, text=True
    )
    print(done.stdout, end="", flush=True)
    if done.returncode:
        sys.exit(f"{command[0]}: {done.stdout}{done.stderr}")
    return done.stdout


if __name__ == "__main__":
    main()
