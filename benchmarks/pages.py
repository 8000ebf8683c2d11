"""The numbers of the pages "the same elsewhere" and "how it is checked": ``python benchmarks/pages.py``.

They are kept in ``pages.json`` with their date and machine; the site makes its tables of them
(``docs/site/measured.py``).
Needs SymPy, trimesh, MuJoCo and heyoka beside the development tools; what is not installed is left out.
"""

from __future__ import annotations

import datetime
import inspect
import json
import os
import platform
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "POLHODE_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import elsewhere  # noqa: E402
import numpy as np  # noqa: E402

FILE = Path(__file__).with_name("pages.json")
PEERS = {
    "scipy": "SciPy",
    "sympy": "SymPy",
    "mujoco": "MuJoCo",
    "heyoka": "heyoka",
    "trimesh": "trimesh",
    "numpy": "NumPy",
}


def main() -> None:
    """Measure everything, and write the file."""
    if len(sys.argv) == 2:  # one function in a fresh interpreter, for its time with imports
        print(json.dumps(timed(sys.argv[1])))
        return
    import polhode

    found = {
        "date": datetime.datetime.now(tz=datetime.UTC).date().isoformat(),
        "machine": {
            "cpu": cpu(),
            "cores": os.cpu_count(),
            "python": platform.python_version(),
            "polhode": polhode.__version__,
        },
        "elsewhere": {problem: list(compared(problem)) for problem in EXACT},
        "validation": [
            {"what": what, "against": against, "error": error()} for what, against, error in CHECKS
        ],
    }
    FILE.write_text(json.dumps(found, indent=2) + "\n", "utf-8")


def cpu() -> str:
    """The processor, as Linux names it."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    return next(
        (line.partition(":")[2].strip() for line in lines if line.startswith("model name")),
        platform.machine(),
    )


def arguments(name: str) -> tuple[Any, ...]:
    """What the functions of a problem are given."""
    problem = name.partition("_")[0]
    given = {"tensor": elsewhere.mesh, "axes": lambda: (elsewhere.tensors(),), "particles": elsewhere.cloud}
    return given[problem]() if problem in given else ()


def timed(name: str) -> dict[str, float]:
    """Seconds of the first call, with its imports, and of later ones."""
    function, given = getattr(elsewhere, name), arguments(name)
    seconds = []
    for _ in range(4):
        start = time.perf_counter()
        function(*given)
        seconds.append(time.perf_counter() - start)
    return {"first": seconds[0], "again": statistics.median(seconds[1:])}


def compared(problem: str) -> Iterator[dict[str, Any]]:
    """Lines, seconds and error of each program that has a function for a problem."""
    exact = EXACT[problem]()
    for name, function in inspect.getmembers(elsewhere, inspect.isfunction):
        kind, _, program = name.partition("_")
        if kind != problem or not find_spec(program):
            continue
        answer = function(*arguments(name))
        answer = answer[0] if isinstance(answer, tuple) else answer  # rates, moments
        done = subprocess.run([sys.executable, __file__, name], capture_output=True, text=True, check=True)
        lines = [line for line in inspect.getsource(function).splitlines()[1:] if line.strip()]
        yield {
            "program": PEERS.get(program, program),
            "version": version(program),
            "function": name,
            "lines": len(lines),
            "error": float(np.abs(answer - exact).max() / np.abs(exact).max()),
            **json.loads(done.stdout),
        }


def exact_rates() -> Any:
    """ω by Jacobi's functions in 45 digits."""
    from oracles.free_motion import jacobi_rates

    found = jacobi_rates(elsewhere.MOMENTS, elsewhere.SPIN, elsewhere.TIMES.tolist())
    return np.array([[float(x) for x in row] for row in found])


def exact_tensor() -> Any:
    """The tensor of the mesh in rational numbers."""
    from oracles.exact_polyhedron import polyhedron

    solid = polyhedron(*elsewhere.mesh())
    return 1000.0 * np.array([[float(x) for x in row] for row in solid.inertia])


def exact_moments() -> Any:
    """The moments of the tensors in forty digits."""
    import mpmath

    with mpmath.workdps(40):
        return np.array(
            [
                sorted(float(x) for x in mpmath.eigsy(mpmath.matrix(one.tolist()), eigvals_only=True))
                for one in elsewhere.tensors()
            ]
        )


def exact_particles() -> Any:
    """The tensor of the particles in rational numbers."""
    from fractions import Fraction

    masses, positions = elsewhere.cloud()
    m, r = [Fraction(x) for x in masses], [[Fraction(x) for x in row] for row in positions]
    center = [sum(w * row[i] for w, row in zip(m, r, strict=True)) / sum(m) for i in range(3)]
    arms = [[x - c for x, c in zip(row, center, strict=True)] for row in r]
    second = np.array(
        [
            [float(sum(w * a[i] * a[j] for w, a in zip(m, arms, strict=True))) for j in range(3)]
            for i in range(3)
        ]
    )
    return np.trace(second) * np.eye(3) - second


EXACT: dict[str, Callable[[], Any]] = {
    "motion": exact_rates,
    "tensor": exact_tensor,
    "axes": exact_moments,
    "particles": exact_particles,
}


def _relative(found: Any, exact: Any) -> float:
    return float(np.abs(np.asarray(found) - exact).max() / np.abs(exact).max())


def of_solids() -> float:
    from oracles import textbook_shapes as shapes
    from polhode import solids

    f = shapes.fifty_digits()
    pairs = [
        (solids.box((0.3, 0.7, 1.9), density=1.0), shapes.box(f, 0.3, 0.7, 1.9)),
        (solids.tube(0.3, 0.7, 1.9, density=1.0), shapes.tube(f, 0.3, 0.7, 1.9)),
        (solids.torus(1.7, 0.4, density=1.0), shapes.torus(f, 1.7, 0.4)),
        (solids.capsule(0.3, 1.9, density=1.0), shapes.capsule(f, 0.3, 1.9)),
        (solids.frustum(0.9, 0.2, 1.3, density=1.0), shapes.frustum(f, 0.9, 0.2, 1.3)),
    ]
    worst = 0.0
    for body, shape in pairs:
        xx, yy, zz = shape.means[:3]
        exact = np.array([float(shape.measure * x) for x in (yy + zz, zz + xx, xx + yy)])
        worst = max(worst, _relative(body.inertia.diagonal(), exact))
    return worst


def of_meshes() -> float:
    return _relative(elsewhere.tensor_polhode(*elsewhere.mesh()), exact_tensor())


def of_axes() -> float:
    import mpmath
    import polhode

    rng = np.random.default_rng(5)
    worst = 0.0
    with mpmath.workdps(40):
        for _ in range(50):
            a = rng.normal(size=(3, 3))
            a = a @ a.T
            exact = sorted(float(x) for x in mpmath.eigsy(mpmath.matrix(a.tolist()), eigvals_only=True))
            worst = max(worst, _relative(polhode.principal_moments(a), np.array(exact)))
    return worst


def of_free_motion() -> float:
    return _relative(elsewhere.motion_polhode()[0], exact_rates())


def of_long_motion() -> float:
    from oracles.free_motion import jacobi_rates
    from polhode import RigidBody

    moments, spin = (1.0, 2.0, 2.5), (0.3, 0.2, 1.1)
    times = [0.0, 1e3, 1e6]
    exact = np.array([[float(x) for x in row] for row in jacobi_rates(moments, spin, times)])
    return _relative(RigidBody.from_principal(1.0, moments).free_motion(spin).at(times).omega, exact)


def of_simulate() -> float:
    from oracles.free_motion import as_floats, taylor_motion
    from polhode import RigidBody, loads

    moments, spin, torque = (1.0, 2.0, 2.5), (0.3, 0.2, 1.1), (0.01, -0.02, 0.03)
    times = [0.0, 5.0, 20.0]
    exact, _ = as_floats(taylor_motion(np.diag(moments), spin, times, body_torque=torque))
    run = RigidBody.from_principal(1.0, moments).simulate(
        times, spin, load=loads.constant_torque(torque), rtol=1e-13
    )
    return _relative(run.omega, exact)


def of_density() -> float:
    from polhode import RigidBody, regions

    ball = RigidBody.from_density(lambda p: 1.0 + (p**2).sum(axis=-1), regions.ball(1.0))
    exact = 8 * np.pi / 3 * (1 / 5 + 1 / 7)  # 8π/3 ∫ ρ r⁴ dr
    return float(abs(ball.inertia[0, 0] / exact - 1))


CHECKS: list[tuple[str, str, Callable[[], float]]] = [
    ("moments of solids", "their formulas in fifty digits", of_solids),
    ("tensor of a mesh of 20 000 triangles", "rational numbers", of_meshes),
    ("principal moments of fifty random tensors", "mpmath in forty digits", of_axes),
    ("angular velocity of a free body that flips", "Jacobi's functions in 45 digits", of_free_motion),
    ("angular velocity after a million seconds", "Jacobi's functions in 45 digits", of_long_motion),
    ("angular velocity under a torque", "Taylor series in 45 digits", of_simulate),
    ("tensor of a ball whose density varies", "its integral by hand", of_density),
]


if __name__ == "__main__":
    main()
