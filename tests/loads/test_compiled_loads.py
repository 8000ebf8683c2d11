"""Loads that are compiled functions: by address, as `scipy.LowLevelCallable`, with user data, in stacks."""

from __future__ import annotations

import ctypes
import pickle
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, loads
from scipy import LowLevelCallable

SOURCE = """
void drag(double t, const double *state, double *out, void *user_data) {
    double rate = user_data ? *(double *)user_data : 0.1;
    for (int i = 0; i < 3; i++) out[3 + i] = -rate * state[4 + i];
}
void spring(double t, const double *state, double *out, void *user_data) {
    for (int i = 0; i < 3; i++) out[i] = -state[7 + i];
}
void nothing_real(double t, const double *state, double *out, void *user_data) {
    out[3] = t > 1.0 ? 0.0 / (t - t) : 0.0;
}
void nothing(double t, const double *state, double *out, void *user_data) {}
"""
COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
pytestmark = pytest.mark.skipif(COMPILER is None, reason="no C compiler")

BODY = RigidBody(1.0, np.diag([1.0, 2.0, 2.5]))
RATES = (0.5, -1.0, 0.25)
TIMES = np.linspace(0.0, 8.0, 9)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    folder: Path = tmp_path_factory.mktemp("compiled")
    source, shared = folder / "loads.c", folder / "loads.so"
    source.write_text(SOURCE)
    subprocess.run([str(COMPILER), "-O2", "-shared", "-fPIC", "-o", str(shared), str(source)], check=True)
    library = ctypes.CDLL(str(shared))
    for function in (library.drag, library.spring, library.nothing_real, library.nothing):
        function.restype = None
        function.argtypes = [
            ctypes.c_double,
            ctypes.POINTER(ctypes.c_double),
            ctypes.POINTER(ctypes.c_double),
            ctypes.c_void_p,
        ]
    return library


def address(function: Any) -> int:
    return ctypes.cast(function, ctypes.c_void_p).value or 0


def test_every_way_to_name_it(library: ctypes.CDLL) -> None:
    class Numba:
        address = address(library.drag)

    want = BODY.simulate(TIMES, RATES, load=loads.damping(0.1))
    for function in (address(library.drag), LowLevelCallable(library.drag), Numba()):
        load = loads.compiled(function)
        got = BODY.simulate(TIMES, RATES, load=load)
        assert np.abs(got.omega - want.omega).max() < 1e-9
        assert np.abs(load.torque(0.0, RATES, (0, 0, 0, 1)) + 0.1 * np.array(RATES)).max() < 1e-16


def test_user_data_scaling_and_schedules(library: ctypes.CDLL) -> None:
    rate = ctypes.c_double(0.3)
    pointer = ctypes.cast(ctypes.pointer(rate), ctypes.c_void_p)
    by_hand = loads.compiled(address(library.drag), user_data=pointer.value)
    by_scipy = loads.compiled(LowLevelCallable(library.drag, pointer))
    state = (0.0, RATES, (0, 0, 0, 1))
    for load in (by_hand, by_scipy):
        assert np.abs((2 * load).torque(*state) + 0.6 * np.array(RATES)).max() < 1e-15
    windows = [(1.0, 2.5)]
    got = BODY.simulate(TIMES, RATES, load=loads.schedule(by_hand, windows), rtol=1e-12)
    want = BODY.simulate(TIMES, RATES, load=loads.schedule(loads.damping(0.3), windows), rtol=1e-12)
    assert np.abs(got.omega - want.omega).max() < 1e-10


def test_forces_and_stacks_on_all_cores(library: ctypes.CDLL, rng: np.random.Generator) -> None:
    load = loads.compiled(LowLevelCallable(library.spring)) + loads.compiled(LowLevelCallable(library.drag))
    starts = rng.normal(size=(300, 3))
    got = BODY.simulate(TIMES, starts, load=load, position=(1, 0, 0), rtol=1e-12)
    assert np.abs(got.position[..., 0] - np.cos(TIMES)).max() < 1e-10
    alone = BODY.simulate(TIMES, starts[7], load=load, position=(1, 0, 0), rtol=1e-12)
    assert np.array_equal(got.omega[7], alone.omega)


@pytest.mark.parametrize("method", ["dop853", "radau"])
@pytest.mark.parametrize("function", ["drag", "spring"])
def test_a_function_alone_and_in_a_sum_have_the_same_bits(
    library: ctypes.CDLL, function: str, method: Any
) -> None:
    """A function alone is called directly; in a sum it adds to what the others exert."""
    alone = loads.compiled(LowLevelCallable(getattr(library, function)))
    in_sum = alone + loads.compiled(LowLevelCallable(library.nothing))
    here, there = (
        BODY.simulate(TIMES, RATES, load=load, position=(1, 0, 0), method=method, rtol=1e-11)
        for load in (alone, in_sum)
    )
    assert here.evaluations == there.evaluations
    for name in ("omega", "quaternion", "position", "velocity"):
        assert np.array_equal(getattr(here, name), getattr(there, name)), name


def test_what_is_no_number_ends_the_run(library: ctypes.CDLL) -> None:
    load = loads.compiled(address(library.nothing_real))
    with pytest.raises(ValueError, match="not finite at t = "):
        BODY.simulate([0.0, 3.0], RATES, load=load)


def test_mistakes_are_named(library: ctypes.CDLL) -> None:
    with pytest.raises(TypeError, match=r"wrap a Python function in loads\.callback"):
        loads.compiled(lambda *_: None)
    with pytest.raises(ValueError, match="address is 0"):
        loads.compiled(0)
    for number in (-1, 2**64, 10**40):
        with pytest.raises(ValueError, match=f"function: expected an address between 1 and .*, got {number}"):
            loads.compiled(number)
    library.spring.argtypes = [ctypes.c_double]
    with pytest.raises(ValueError, match="expected the signature"):
        loads.compiled(LowLevelCallable(library.spring))
    with pytest.raises(TypeError, match="cannot be pickled"):
        pickle.dumps(loads.compiled(address(library.drag)))
