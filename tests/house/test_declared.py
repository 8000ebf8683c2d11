"""Solids, laminae, rods and loads are declared in Rust alone: stubs and the names of their modules follow."""

from __future__ import annotations

import importlib
import importlib.util
from typing import Any

import numpy as np
import pytest
from documented import arrays, takes_arrays_alone
from places import ROOT


def _declared() -> Any:
    spec = importlib.util.spec_from_file_location("declared", ROOT / "rust" / "python" / "declared.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


declared = _declared()


def test_the_files_are_as_the_extension_is_declared() -> None:
    assert not declared.changed(), "run make declare"


@pytest.mark.parametrize("module", declared.MODULES)
def test_every_public_name_of_a_module_is_declared(module: str) -> None:
    public = importlib.import_module(f"polhode.{module}").__all__
    assert set(public) == {*declared.names(module), *declared.CLASSES.get(module, ())}


def test_what_was_forgotten_is_written() -> None:
    stubs = declared.STUBS.read_text(encoding="utf-8")
    line = "def damping(matrix: ArrayLike, quadratic: ArrayLike | None = None) -> Load: ...\n"
    assert stubs.count(line) == stubs.count('    "damping",\n') == 1
    assert declared.of_stubs(stubs.replace(line, "").replace('    "damping",\n', "")) == stubs
    rods = (declared.PACKAGE / "rods.py").read_text(encoding="utf-8")
    assert rods.count("arc, ") == rods.count('"arc", ') == 1
    assert declared.of_module("rods", rods.replace("arc, ", "").replace('"arc", ', "")) == rods


def test_a_type_that_no_docstring_tells_is_refused() -> None:
    (parameter,) = declared.inspect.signature(declared._core.uniform_gravity).parameters.values()
    with pytest.raises(SystemExit, match=r"uniform_gravity: the type of gravity is not known from 'a thing'"):
        declared.typed("loads", "uniform_gravity", parameter, "a thing")


def test_docstrings_tell_what_a_load_takes() -> None:
    """So that hostile and absurd calls are made of a new load without a word in their files."""
    loads = importlib.import_module("polhode.loads")
    assert {name: np.shape(value) for name, value in arrays(loads.damping).items()} == {
        "matrix": (3, 3),
        "quadratic": (3, 3),
    }
    assert takes_arrays_alone(loads.damping)
    assert takes_arrays_alone(loads.rotor)
    assert np.shape(arrays(loads.slug)["inertia"]) == ()
    assert not takes_arrays_alone(loads.slug)  # a name besides
    assert not takes_arrays_alone(loads.sampled)  # as many rows as times
    assert not takes_arrays_alone(loads.callback)
