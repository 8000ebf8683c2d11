"""Arguments of other libraries: what they would lose on the way to an array is an error, not silence."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from polhode import RigidBody, _core, molecules, plot, solids

if TYPE_CHECKING:
    from collections.abc import Callable

MADE: Any = RigidBody
BODY: Any = solids.box((3.0, 2.0, 1.0), mass=1.0)
TETRAHEDRON = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
CORNERS = np.eye(4)[:, :3]

#: Each way that arguments become arrays: what errors call it, and how to pass it.
READERS: dict[str, tuple[str, Callable[[Any], object], Any]] = {
    "read": ("mass", lambda x: MADE(x, np.eye(3)), np.ones(3)),
    "rows": ("positions", lambda x: MADE.from_particles(np.ones(4), x), CORNERS),
    "tensor": ("inertia", _core.principal_axes, np.eye(3)),
    "rotation": ("rotation", BODY.rotated, np.array([0.0, 0.0, 0.0, 1.0])),
    "point": ("about", BODY.inertia_about, np.ones(3)),
    "times": ("t", lambda x: BODY.simulate(x, (0.0, 0.0, 1.0)), np.array([0.0, 1.0])),
    "voxels": ("density", lambda x: MADE.from_voxels(x, 1.0), np.ones((2, 2, 2))),
    "float32 voxels": ("density", lambda x: MADE.from_voxels(x, 1.0), np.ones((2, 2, 2), dtype="f4")),
    "faces": ("faces", lambda x: MADE.from_mesh(CORNERS, x, mass=1.0), TETRAHEDRON),
    "cells": ("cells", lambda x: MADE.from_tetrahedra(CORNERS, x, density=1.0), np.arange(4)[None]),
    "labels": (
        "labels",
        lambda x: MADE.from_labelled_particles(np.ones(4), CORNERS, x),
        np.array([0, 0, 1, 1]),
    ),
    "windows": (
        "windows",
        lambda x: _core.schedule(_core.constant_torque((0, 0, 1)), x),
        np.array([[0.0, 1.0]]),
    ),
    "damping": ("matrix", _core.damping, np.array(1.0)),
    "molecules": ("moments", molecules.planar_moments, np.ones(3)),
    "trajectory": ("point", BODY.simulate([0, 1], (0, 0, 1)).point, np.ones(3)),
    "density": (
        "density",
        lambda x: MADE.from_density(lambda r: type(x)(np.ones(len(r))), [(0, 0, 0), (1, 1, 1)]),
        np.ones(3),
    ),
}


class Quantity:
    """A number with a unit that becomes an array without it, as those of pint do."""

    def __init__(self, magnitude: Any, units: str = "kilogram") -> None:
        self.magnitude, self.units = magnitude, units

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        return np.array(self.magnitude, dtype)


class Measured(np.ndarray[Any, Any]):
    """An array with a unit that is an array itself, as those of astropy are."""

    unit = "kg"

    def to_value(self, _unit: str) -> Any:
        return np.asarray(self)


class Wrapped:
    """An array of another library's within one with names for its axes, as xarray has them."""

    dims = ("x",)

    def __init__(self, data: Any) -> None:
        self.data = data

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        return np.array(self.data, dtype)


@pytest.mark.parametrize("reader", READERS)
def test_masked_elements_have_no_value(reader: str) -> None:
    name, call, good = READERS[reader]
    mask = np.zeros(good.shape, dtype=bool)
    call(np.ma.array(good, mask=mask))  # nothing is masked: nothing is lost
    if reader == "density":
        return
    mask[(-1,) * good.ndim] = True
    with pytest.raises(ValueError, match=rf"^{name}: the element.* is masked and has no value"):
        call(np.ma.array(good, mask=mask))


@pytest.mark.parametrize("reader", [name for name in READERS if name != "density"])
def test_units_are_not_dropped(reader: str) -> None:
    name, call, good = READERS[reader]
    for quantity in (Quantity(good), Wrapped(Quantity(good)), good.view(Measured)):
        with pytest.raises(TypeError, match=rf"^{name}: a \w+ in \"(kilogram|kg)\" would lose its unit"):
            call(quantity)
    call(Wrapped(good))


def test_a_density_with_a_unit() -> None:
    with pytest.raises(TypeError, match=r"^density: a Quantity in"):
        MADE.from_density(lambda r: Quantity(np.ones(len(r))), [(0, 0, 0), (1, 1, 1)])


def test_they_are_found_in_lists() -> None:
    for size in (
        [Quantity(1.0), 2.0, 3.0],
        (1.0, Quantity(2.0), 3.0),
        [[1.0, 2.0, 3.0], [1.0, 2.0, Quantity(3.0)]],
        [np.ones(3), Quantity(np.ones(3))],
    ):
        with pytest.raises(TypeError, match=r"^size: a Quantity in"):
            solids.box(size, mass=1.0)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"^masses: the element is masked"):
        MADE.from_particles([1.0, np.ma.masked], np.eye(2, 3))
    with pytest.raises(ValueError, match=r"^positions: the element at \(1,\) is masked"):
        MADE.from_particles([1.0], [np.ma.array([1.0, 2.0, 3.0], mask=[False, True, False])])


KINDS = {
    "complex": np.ones(3) + 0j,
    "words": np.array(["1", "2", "3"]),
    "bytes": np.array([b"1", b"2", b"3"]),
    "objects": np.array([1, 2, None]),
    "dates": np.array(["2020-01-01"] * 3, dtype="M8[D]"),
    "durations": np.array([1, 2, 3], dtype="m8[s]"),
    "records": np.zeros(3, dtype="f8,f8"),
    "nothing": np.zeros(3, dtype="V8"),
}


@pytest.mark.parametrize(
    ("kind", "form"),
    [(kind, form) for kind in KINDS for form in ("array", "list")]
    + [("complex", "long list"), ("objects", "long list")],
)
def test_what_is_no_real_number(kind: str, form: str) -> None:
    numbers: Any = KINDS[kind]
    if form != "array":
        numbers = list(numbers) * (90_000 if form == "long list" else 1)
    with pytest.raises((TypeError, ValueError), match=r"^mass: "):
        MADE(numbers, np.eye(3))


@pytest.mark.parametrize("dtype", ["f2", "f4", ">f8", "g", "i1", "u8", ">i4", "?"])
@pytest.mark.parametrize("order", ["C", "F", "reversed", "every other"])
def test_every_dtype_and_layout_has_the_same_numbers(dtype: str, order: str) -> None:
    """Large arrays are converted piece by piece."""
    numbers = np.arange(3 * 150_000).reshape(-1, 3) % 100
    array = np.array(numbers, dtype=dtype)
    array = {
        "C": array,
        "F": np.asfortranarray(array),
        "reversed": array[::-1, ::-1],
        "every other": np.repeat(array, 2, axis=0)[::2],
    }[order]
    got = _core.real_numbers(array, "array")
    assert got.dtype == np.float64
    assert got.flags.c_contiguous
    assert np.array_equal(got, np.asarray(array, dtype=np.float64))


@pytest.mark.parametrize(
    "rows",
    [
        [1.0] * 300_000,
        [1] * 299_999 + [2.5],
        [[1, 2, 3]] * 100_000 + [[1.5, 2.5, 3.5]],
        ([1.0] * 300_000, [2.0] * 300_000),
        [[[1.0, 2.0]] * 2] * 100_000,
        [(1.0, 2.0, 3.0)] * 100_000,
        [np.ones(3)] * 100_000,
        [True] * 300_000,
        [1.5] * 299_999 + [True],
        [2**63] * 300_000,
    ],
    ids=range(10),
)
def test_long_lists_have_the_numbers_that_numpy_reads(rows: Any) -> None:
    got = _core.real_numbers(rows, "rows")
    assert np.array_equal(got, np.asarray(rows, dtype=np.float64))


def test_long_lists_that_are_no_arrays() -> None:
    for rows in ([[1.0, 2.0]] * 200_000 + [[1.0]], [[1.0]] * 300_000 + [1.0], [[1.0]] * 300_000 + ["a"]):
        with pytest.raises((TypeError, ValueError), match=r"^rows: "):
            _core.real_numbers(rows, "rows")


def test_what_an_object_raises_comes_back_as_it_is() -> None:
    class Failing:
        def __array__(self, *_: Any, **__: Any) -> Any:
            raise failure

    for failure in (RuntimeError("of its own"), KeyError("key"), FloatingPointError("here")):
        with pytest.raises(type(failure)) as caught:
            MADE(Failing(), np.eye(3))
        assert caught.value is failure


NUMBERS = ["read", "rows", "tensor", "rotation", "point", "times", "voxels", "float32 voxels", "windows"]
NUMBERS += ["damping", "molecules", "trajectory"]


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("kind", ["array", "list", "one among floats"])
def test_true_and_false_are_one_and_zero(name: str, kind: str) -> None:
    """As in NumPy, in calls; in files they are refused."""
    _, read, good = READERS[name]
    given: Any = good.astype(bool)
    if kind == "list":
        given = given.tolist()
    elif kind == "one among floats":
        cells = np.empty(good.shape, dtype=object)
        cells[...] = good.astype(float)
        cells.flat[0] = bool(good.flat[0])
        given = cells.tolist()
    np.testing.assert_equal(read_out(read(given)), read_out(read(good.astype(float))))


def read_out(found: Any) -> Any:
    """The numbers of what a reader gives."""
    if isinstance(found, RigidBody):
        return [found.mass, found.center_of_mass, found.inertia]
    if isinstance(found, polhode.Trajectory):
        return [found.t, found.omega, found.quaternion]
    if isinstance(found, polhode.loads.Load):
        return found.torque(0.5, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0), body=BODY, start=0.0)
    return repr(found) if type(found).__module__.startswith("polhode") else found


@pytest.mark.parametrize("true", [True, np.True_])
def test_true_beside_a_number_with_a_sigma_is_one(true: Any) -> None:
    uncertainties = pytest.importorskip("uncertainties")
    masses = [uncertainties.ufloat(2.0, 0.1)] * 3
    bodies = [MADE.from_particles([*masses, one], CORNERS) for one in (true, 1.0)]
    assert repr(bodies[0]) == repr(bodies[1])


# Masks and units: pictures and motions refuse what has them, and name the argument.

BOX = solids.box((3.0, 2.0, 1.0), mass=1.0)
MOTION = BOX.free_motion((0.1, 1.0, 0.2))
FALL = BOX.simulate([0.0, 1.0], (0.1, 1.0, 0.2), about="origin")
TOP = solids.cylinder(1.0, 2.0, mass=1.0).translated((0.0, 0.0, 1.0))
TIMES = np.linspace(0.0, 1.0, 5)
CENTER = np.array([0.1, 0.2, 0.3])
TRIANGLE = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
FACES = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])

CALLS: dict[str, tuple[Any, Callable[[Any], object]]] = {
    "plot.body: vertices": (TRIANGLE, lambda value: plot.body(value, FACES)),
    "plot.body: faces": (FACES, lambda value: plot.body(TRIANGLE, value)),
    "plot.ellipsoid: center": (CENTER, lambda value: plot.ellipsoid(BOX, center=value)),
    "plot.poinsot: t": (TIMES, lambda value: plot.poinsot(MOTION, value)),
    "plot.cones: t": (
        TIMES,
        lambda value: plot.cones(solids.cylinder(1, 3, mass=1).free_motion((0.1, 0, 1)), value),
    ),
    "plot.nutation: t": (
        TIMES,
        lambda value: plot.nutation(TOP.heavy_top((0, 0.1, 9), (0.6, 0, 0, 0.8), (0, 0, -9.81)), value),
    ),
    "animate: shape": (TRIANGLE, lambda value: MOTION.at(TIMES).animate("never.html", shape=(value, FACES))),
    "Trajectory.point: point": (CENTER, MOTION.at(TIMES).point),
    "pivot_reaction: force": (CENTER, lambda value: FALL.pivot_reaction(force=value)),
    "resume: t": (TIMES + 1.0, FALL.resume),
    "ray_kappa: constants": (np.array([3.0, 2.0, 1.0]), molecules.ray_kappa),
    "planar_moments: moments": (np.array([1.0, 2.0, 2.5]), molecules.planar_moments),
}


@cache
def registry() -> Any:
    """The units of pint, which reads their definitions for half a second."""
    return pytest.importorskip("pint").UnitRegistry()


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("agg")
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", CALLS)
def test_a_mask_and_a_unit_are_told(name: str, tmp_path: Path) -> None:
    good, call = CALLS[name]
    argument = name.partition(": ")[2]
    mask = np.zeros(np.shape(good), dtype=bool)
    mask[-1] = True
    with pytest.raises(ValueError, match=f"{argument}: .*is masked"):
        call(np.ma.masked_array(good, mask))
    with pytest.raises(TypeError, match=f"{argument}: .*would lose its unit"):
        call(registry().Quantity(good, "second"))
    assert list(tmp_path.iterdir()) == []
    call(np.ma.masked_array(good, False))  # nothing of it is masked
    pytest.importorskip("matplotlib.pyplot").close("all")
