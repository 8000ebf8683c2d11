"""The public surface: names, docstrings and their examples, the README's code, what an import loads."""

from __future__ import annotations

import concurrent.futures
import doctest
import importlib
import inspect
import os
import pickle
import subprocess
import sys
import types
from functools import cached_property
from pathlib import Path

import numpy as np
import polhode
import pytest
from markdown_code import blocks, run_examples, run_page
from places import ROOT
from polhode import RigidBody, loads, solids
from public_objects import MODULES, OBJECTS

HEAVY = (
    "uncertainties",
    "matplotlib",
    "sympy",
    "trimesh",
    "scipy",
    "rich",
    "cyclopts",
    "periodictable",
    "pint",
    "pandas",
    "PIL",
    "pyvista",
    "dask",
    "distributed",
    "xarray",
    "zarr",
)


def test_examples_of_every_module_are_run() -> None:
    modules = {name for name in polhode.__all__ if isinstance(getattr(polhode, name), types.ModuleType)}
    assert {f"polhode.{name}" for name in modules} <= set(MODULES)


FUNCTIONS = [n for n, v in OBJECTS.items() if inspect.isroutine(v) and not isinstance(v, cached_property)]
WITH_EXAMPLES = [name for name, value in OBJECTS.items() if ">>>" in (inspect.getdoc(value) or "")]


class TestNames:
    def test_the_package_exports_what_it_lists(self) -> None:
        assert all(hasattr(polhode, name) for name in polhode.__all__)  # each is loaded when it is asked for
        assert dir(polhode) == polhode.__all__
        visible = {n for n in vars(polhode) if not n.startswith("_")} | {"__version__"}
        visible -= {"TYPE_CHECKING"}
        modules = {name for name in visible if isinstance(getattr(polhode, name), types.ModuleType)}
        internal = modules - set(polhode.__all__)
        assert visible - internal == set(polhode.__all__)
        known = {
            "accumulator",
            "animation",
            "cli",
            "draw",
            "ensembles",
            "images",
            "io",
            "molecules",
            "motion",
        }
        known |= {"plot", "principal", "results", "robots", "samples", "symbolic", "units", "view"}
        assert internal <= known

    @pytest.mark.parametrize("name", MODULES)
    def test_lists_are_sorted_and_complete(self, name: str) -> None:
        module = importlib.import_module(name)
        assert sorted(set(module.__all__)) == sorted(module.__all__)
        assert all(hasattr(module, export) for export in module.__all__)

    def test_the_version_is_the_distributions(self) -> None:
        from importlib.metadata import version

        assert polhode.__version__ == version("polhode")

    def test_names_that_bodies_and_motions_have(self) -> None:
        names = """
            from_principal from_positive_products from_particles from_mesh from_tetrahedra from_density
            from_radial_density from_file combined stack mass center_of_mass inertia principal
            principal_moments radii_of_gyration inertia_about moment_about principal_about translated rotated
            scaled isclose kinetic_energy angular_momentum angular_acceleration torque simulate shape
            point_velocity point_acceleration pivot_reaction stability equimomental_particles
        """
        missing = [name for name in names.split() if not hasattr(RigidBody, name)]
        assert not missing
        fields = "t omega quaternion position velocity body about steps evaluations status events failures"
        assert set(fields.split()) <= set(polhode.Trajectory.__dataclass_fields__)

    def test_classes_know_where_they_live(self) -> None:
        """Tracebacks and pickles name public places."""
        assert RigidBody.__module__ in {"polhode", "polhode._core"}
        assert pickle.loads(pickle.dumps(RigidBody)) is RigidBody
        assert loads.Load.__name__ == "Load"


class TestDocumentation:
    def test_every_public_object_has_a_docstring(self) -> None:
        assert [name for name, value in OBJECTS.items() if not (inspect.getdoc(value) or "").strip()] == []

    @pytest.mark.parametrize("name", WITH_EXAMPLES)
    def test_its_examples_print_what_they_show(self, name: str) -> None:
        text = inspect.getdoc(OBJECTS[name]) or ""
        examples = doctest.DocTestParser().get_doctest(text, {}, name, name, 0)
        run_examples(examples)

    def test_the_main_objects_have_examples(self) -> None:
        assert {"polhode.RigidBody", "polhode.principal_axes"} <= set(WITH_EXAMPLES)

    def test_every_function_shows_its_parameters(self) -> None:
        without = []
        for name in FUNCTIONS:
            value = OBJECTS[name]
            function = value.__func__ if isinstance(value, staticmethod | classmethod) else value
            try:
                inspect.signature(function)
            except ValueError:
                without.append(name)
        assert without == []


class TestReadme:
    def test_python_blocks_print_what_is_shown(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        readme = ROOT / "README.md"
        assert any(language == "python" for language, _ in blocks(readme))
        monkeypatch.chdir(tmp_path)
        run_page(readme)


class TestImport:
    def test_it_loads_numpy_and_nothing_else_that_is_heavy(self) -> None:
        code = f"import sys; from polhode import *; print(*[m for m in {HEAVY!r} if m in sys.modules])"
        assert _python(code).strip() == ""

    def test_it_works_in_a_forked_child(self) -> None:
        code = (
            "import os, numpy as np, polhode\n"
            "body = polhode.solids.cube(np.ones(10000), mass=1.0)\n"
            "body.simulate([0.0, 1.0], (1.0, 2.0, 3.0))\n"
            "child = os.fork()\n"
            "if child == 0:\n"
            "    body.simulate([0.0, 1.0], (1.0, 2.0, 3.0)); os._exit(0)\n"
            "print(os.waitpid(child, 0)[1])"
        )
        assert _python(code).strip() == "0"


def _python(code: str, **environment: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        env={**os.environ, **environment},
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


class TestThreads:
    def test_threads_get_the_bits_of_one_thread(self, rng: np.random.Generator) -> None:
        body = solids.box((1.0, 2.0, 3.0), mass=1.0)
        starts = rng.normal(size=(16, 3))
        load = loads.constant_torque((0.1, 0.2, 0.3), "space")

        def run_one(omega: np.ndarray) -> np.ndarray:
            return body.simulate(np.linspace(0, 50, 51), omega, load=load).omega

        want = [run_one(omega) for omega in starts]
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            got = list(pool.map(run_one, starts))
        assert all(np.array_equal(a, b) for a, b in zip(got, want, strict=True))

    def test_callbacks_from_several_threads(self, rng: np.random.Generator) -> None:
        body = solids.box((1.0, 2.0, 3.0), mass=1.0)
        load = loads.torque_callback(lambda _t, w, _q: -0.1 * w)
        starts = rng.normal(size=(8, 3))
        want = [body.simulate([0.0, 5.0], omega, load=load).omega for omega in starts]
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            got = list(pool.map(lambda omega: body.simulate([0.0, 5.0], omega, load=load).omega, starts))
        assert all(np.array_equal(a, b) for a, b in zip(got, want, strict=True))

    def test_a_large_stack_has_the_bits_of_its_rows(self, rng: np.random.Generator) -> None:
        """Large enough to be shared among threads."""
        stack = solids.box(rng.uniform(1, 2, size=(20_000, 3)), mass=1.0)
        turned = stack.rotated(RigidBody.from_principal(1, [1, 1, 1]).principal.axes)
        moments = turned.principal.moments
        for i in (0, 1, 4095, 4096, 9999, 19_999):
            assert np.array_equal(turned[i].principal.moments, moments[i])


class TestEnvironment:
    CODE = (
        "import numpy as np, polhode\n"
        "a = np.random.default_rng(5).normal(size=(3000, 3, 3))\n"
        "found = polhode.principal_axes(a + a.swapaxes(1, 2))\n"
        "print(hash(found.moments.tobytes() + found.axes.tobytes()))"
    )

    def test_bits_depend_neither_on_threads_nor_on_the_width_of_the_lanes(self) -> None:
        settings = [{"POLHODE_NUM_THREADS": "1"}, {"POLHODE_NUM_THREADS": "3"}]
        settings += [{"POLHODE_LEVEL": level} for level in ("avx2", "avx512") if _has(level)]
        outputs = {_python(self.CODE, PYTHONHASHSEED="0", **setting) for setting in settings}
        assert len(outputs) == 1

    @pytest.mark.parametrize(
        ("variable", "value"),
        [("POLHODE_NUM_THREADS", "0"), ("POLHODE_NUM_THREADS", "many"), ("POLHODE_LEVEL", "abacus")],
    )
    def test_nonsense_is_named(self, variable: str, value: str) -> None:
        code = "try:\n    from polhode import RigidBody\nexcept ValueError as error:\n    print(error)"
        assert variable in _python(code, **{variable: value})


def _has(level: str) -> bool:
    return "no" not in _python(
        "try:\n    from polhode import RigidBody\nexcept ValueError:\n    print('no')", POLHODE_LEVEL=level
    )
