"""From a gyro's log to the tensor, beside MuJoCo's system identification, on the same logs.

``python benchmarks/identification.py [--seeds N] [VARIANT ...]`` compares errors with the bound of Cramér and
Rao, and times. It needs an environment with SciPy, polhode and MuJoCo's extra, ``pip install
"mujoco[sysid]>=4"``; without the extra ``run.py`` leaves the row of this file out.

A free body tumbles for 8 s without gravity, with a gyro of 100 samples a second and an unknown offset. Both
sides estimate tensor, offset and angular velocity at the start. MuJoCo simulates with RK4 and steps of the
gyro. Its start is a body whose moments are wrong by up to 30 % and whose axes are 0.2 rad aside, the first
row of the log, and no offset. It has the best chances that its interface offers:

- Its initial states are given. A function for `custom_rollout` makes the angular velocity a parameter.
- Of its ten inertial parameters the mass and the place of the centre stay as they are, since the log does not
  depend on them. The same holds for the scale of the tensor. It is free in the first variant, where all six
  stretches and shears are estimated; in the others one stretch stays too.
- Its residuals are divided by the size of each component of the log. In the last variant they are not: all
  components have the same noise, so this is the most likely body, as ours is.

Three things in MuJoCo 4.0.0 are worked around. The function that sets the parameters of a pseudo-inertia
leaves the quaternion of the axes NaN, and no model compiles. A transform of the signal of a sensor with three
components raises an error where two dictionaries of arrays are compared. And a rollout labels the row of a
sensor with the time at the end of the step; here the times of the log are labelled likewise.
"""

from __future__ import annotations

import os

if __name__ == "__main__":
    # Before anything imports NumPy: the same threads on both sides.
    for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "POLHODE_NUM_THREADS"):
        os.environ.setdefault(_variable, "1")

import argparse
import contextlib
import io
import math
import time
from importlib.metadata import version
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np
from harness import Row, _human, _processor
from polhode import RigidBody, identify
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

MOMENTS = np.array([0.2, 0.35, 0.45])
AXES = Rotation.from_rotvec([0.7, -0.4, 1.1]).as_matrix()
TENSOR = AXES @ np.diag(MOMENTS) @ AXES.T
START = AXES @ np.array([1.0, 3.0, 0.5])  # rad/s
OFFSET = np.array([0.05, -0.02, 0.03])
NOISE, STEP, COUNT = 0.01, 0.01, 800
GUESS = MOMENTS * np.array([1.3, 0.9, 0.85])
GUESSED_AXES = AXES @ Rotation.from_rotvec([0.1, -0.15, 0.1]).as_matrix()
VARIANTS = {
    "its six stretches and shears": {"scale_free": True, "normalize": True},
    "one stretch known": {"scale_free": False, "normalize": True},
    "one stretch known, equal weights": {"scale_free": False, "normalize": False},
}
BEST = "one stretch known, equal weights"
FASTER = 20.0
"""The bar: we are so many times faster than the fastest variant."""
NEEDED = ("absl", "colorama", "mujoco", "tabulate", "yaml")
"""Modules that MuJoCo's sysid imports; without one of them it is empty."""


def exact() -> Floats:
    """The angular velocity at the times of the log, by SciPy."""
    inverse = np.linalg.inv(TENSOR)
    times = STEP * np.arange(COUNT)
    found = solve_ivp(
        lambda _, omega: inverse @ np.cross(TENSOR @ omega, omega),
        (0.0, times[-1]), START, "DOP853", times, rtol=1e-12, atol=1e-13,
    )  # fmt: skip
    return np.asarray(found.y.T)


def log(motion: Floats, seed: int) -> Floats:
    """A log with noise and offset."""
    noise: Floats = np.random.default_rng(seed).normal(0.0, NOISE, motion.shape)
    return np.asarray(motion + OFFSET + noise)


def ours(gyro: Floats) -> Floats:
    """The tensor of trace 1 by polhode."""
    return np.asarray(identify.from_tumble(STEP * np.arange(COUNT), gyro, bias=True).body.inertia)


def theirs(gyro: Floats, *, scale_free: bool, normalize: bool) -> Floats:
    """The tensor of trace 1 by MuJoCo."""
    import mujoco
    from mujoco import sysid
    from mujoco.sysid._src import model_modifier

    w, x, y, z = Rotation.from_matrix(GUESSED_AXES).as_quat(scalar_first=True)
    spec = mujoco.MjSpec.from_string(
        f"""<mujoco><option timestep="{STEP}" gravity="0 0 0" integrator="RK4"/><worldbody><body name="body">
        <freejoint/><inertial pos="0 0 0" mass="1" quat="{w} {x} {y} {z}"
        diaginertia="{GUESS[0]} {GUESS[1]} {GUESS[2]}"/><site name="place"/></body></worldbody>
        <sensor><gyro name="gyro" site="place"/></sensor></mujoco>"""
    )
    model = spec.compile()
    whole = sysid.body_inertia_param(spec, model, "body", sysid.InertiaType.Pseudo)
    free = np.array([1, 2, 3, 4, 5, 6] if scale_free else [1, 2, 4, 5, 6])
    nominal = whole.nominal.copy()

    def all_ten(numbers: Floats) -> Floats:
        theta = nominal.copy()
        theta[free] = numbers
        return theta

    def change(spec: Any, parameter: Any) -> None:
        model_modifier.apply_body_theta_inertia(spec, "body", all_ten(parameter.value))
        spec.body("body").iquat[:] = (1.0, 0.0, 0.0, 0.0)  # NaN otherwise

    params = sysid.ParameterDict()
    bounds = whole.min_value[free], whole.max_value[free]
    params.add(sysid.Parameter("inertia", nominal[free], *bounds, modifier=change))
    params.add(sysid.Parameter("start", gyro[0], gyro[0] - 1.0, gyro[0] + 1.0))
    params.add(sysid.Parameter("offset", np.zeros(3), -np.ones(3), np.ones(3)))
    transform = sysid.SignalTransform(normalize=normalize)
    transform.bias("gyro", params["offset"], target="predicted")

    def rollout(*, initial_states: Any, param_dicts: Any, **given: Any) -> Any:
        states = np.array(initial_states)
        states[:, -3:] = [one["start"].value for one in param_dicts]
        return sysid.sysid_rollout(initial_states=states, **given)

    def residual(*arguments: Any, **given: Any) -> Any:
        rest, predicted, measured = transform.apply(*arguments, **given)
        # The same object: two dictionaries of arrays cannot be compared.
        return rest, predicted, sysid.TimeSeries(measured.times, measured.data, predicted.signal_mapping)

    rest = sysid.create_initial_state(model, np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]), np.zeros(6))
    control = sysid.TimeSeries(STEP * np.arange(COUNT + 1), np.zeros((COUNT + 1, 0)))
    measured = sysid.TimeSeries.from_names(STEP * np.arange(1, COUNT + 1), gyro, model)
    sequences = sysid.ModelSequences("throw", spec, "gyro", rest, control, measured)
    differences = sysid.build_residual_fn(
        models_sequences=[sequences], custom_rollout=rollout, modify_residual=residual, n_threads=1
    )
    with contextlib.redirect_stdout(io.StringIO()):  # a line for each step
        found, _ = sysid.optimize(params, differences, verbose=False)
    tensor = model_modifier.pi_from_theta(all_ten(found["inertia"].value))[4:].reshape(3, 3)
    return np.asarray(tensor / np.trace(tensor))


def bound() -> float:
    """Square root of the least mean square of the error of the tensor: the bound of Cramér and Rao."""
    body = RigidBody(mass=1.0, inertia=TENSOR)
    told = identify.design(body, START, STEP * np.arange(COUNT), NOISE, bias=True)
    return math.sqrt(float(np.diagonal(told.crlb)[3:9] @ (1.0, 1.0, 1.0, 2.0, 2.0, 2.0)))


def error(tensor: Floats) -> float:
    return float(np.linalg.norm(tensor - TENSOR))


def rows() -> Iterator[Row]:
    """Yield the comparison of this file."""
    if not all(find_spec(name) for name in NEEDED):
        return
    gyro, least = log(exact(), 0), bound()

    def same(ours: Floats, theirs: Floats) -> None:
        assert np.linalg.norm(ours - theirs) < 0.01 * least
        assert error(ours) < 3.0 * least

    yield Row(
        name="a tensor from a gyro's log of 8 s, 800 samples, unknown offset",
        peer="MuJoCo sysid, RK4, one thread",
        ours=lambda: ours(gyro),
        theirs=lambda: theirs(gyro, **VARIANTS[BEST]),
        compare=same,
        at_least=FASTER,
    )


def main() -> None:
    """Print errors and times of the variants over the seeds, and whether the bars are met."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("variants", nargs="*", metavar="VARIANT", help=f"any of {', '.join(VARIANTS)}")
    parser.add_argument("--seeds", type=int, default=10)
    options = parser.parse_args()
    unknown = [name for name in options.variants if name not in VARIANTS]
    if unknown or options.seeds < 2:
        parser.error(f"no variant: {unknown[0]!r}" if unknown else "--seeds: at least 2")
    missing = [name for name in NEEDED if not find_spec(name)]
    if missing:
        raise SystemExit(f'{", ".join(missing)}: not installed; pip install "mujoco[sysid]>=4"')
    motion, least = exact(), bound()
    names = ["polhode", *(options.variants or VARIANTS)]
    errors, times = np.zeros((2, len(names), options.seeds))
    apart = np.zeros((len(names), options.seeds))
    for seed in range(-1, options.seeds):  # the first is for what is done once, outside the clock
        gyro = log(motion, options.seeds if seed < 0 else seed)
        own = np.zeros((3, 3))
        for k, name in enumerate(names):
            start = time.perf_counter()
            found = theirs(gyro, **VARIANTS[name]) if k else ours(gyro)
            times[k, seed] = time.perf_counter() - start
            errors[k, seed] = error(found) / least
            own = own if k else found
            apart[k, seed] = np.linalg.norm(found - own) / least
    rms = np.sqrt(np.mean(errors**2, axis=1))
    # Both sides see the same noise: the difference of their errors is known better than either.
    doubt = np.std(errors**2 - errors[0] ** 2, axis=1, ddof=1) / math.sqrt(options.seeds) / (2.0 * rms[0])
    print(f"on {_processor()}; MuJoCo {version('mujoco')}; {options.seeds} logs")
    print("errors of the tensor relative to the bound; differences beside polhode, with standard error")
    head = ("rms", "largest", "difference of rms", "apart", "time", "times faster")
    print(f"{'':40}{head[0]:>7}{head[1]:>9}{head[2]:>20}{head[3]:>8}{head[4]:>9}{head[5]:>22}  bars")
    for k, name in enumerate(names):
        ratios = times[k] / times[0]
        faster = f"{np.median(ratios):.3g} ({ratios.min():.3g} to {ratios.max():.3g})"
        bars = rms[0] <= rms[k] + 2.0 * doubt[k], np.median(ratios) >= FASTER
        verdict = "met" if all(bars) else "NOT MET"
        print(
            f"{'MuJoCo, ' + name if k else name:40}{rms[k]:7.4f}{errors[k].max():9.4g}"
            f"{rms[k] - rms[0]:+12.4f} ±{doubt[k]:.4f}{apart[k].max():8.2g}"
            f"{_human(float(np.median(times[k]))):>9}{faster:>22}  {verdict if k else ''}"
        )


if __name__ == "__main__":
    main()
