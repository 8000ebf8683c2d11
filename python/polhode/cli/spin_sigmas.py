"""What ``polhode spin`` tells of an uncertain motion: at its start and at its end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _core
from polhode.cli.layout import Field
from polhode.uncertainty.motions import each_motion

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from polhode import FreeMotion, GyrostatMotion, HeavyTop, RigidBody
    from polhode.cli.sigmas import Told

    Floats = NDArray[np.float64]

__all__ = ["attitude_field", "of_end", "of_shape", "of_start"]


def of_start(motion: FreeMotion | HeavyTop | GyrostatMotion, axes: Floats, rate: float) -> Told:
    """Sigma of the angular velocity at the start, along these axes; `rate` units are one rad/s."""
    omega = None if isinstance(motion, _core.GyrostatMotion) else motion.uncertain_start[0]
    if omega is None:
        return {}
    if isinstance(motion, _core.FreeMotion) and motion._from_periods is not None:
        found = each_motion(motion, lambda _body, omega: rate * omega @ axes, (3,))
        return {"sigma": found.sigma, "linear": found.linear}
    return {"sigma": rate * _along(axes, omega.covariance), "linear": np.ones(3, dtype=bool)}


def of_shape(motion: FreeMotion) -> Callable[[str], Told]:
    """Compute sigmas of energy ratio, modulus and angles from L; give what looks them up, nothing if none.

    The angles of axis k, ``"nutation k"``, are in degrees.
    """
    if motion.body.covariance is None and motion.uncertain_start[0] is None:
        return lambda _name: {}

    def numbers(body: RigidBody, omega: Any) -> Floats:
        near = body.free_motion(omega)
        return np.array([near.energy_ratio, near.modulus, *np.rad2deg(near.nutation).ravel()])

    found = each_motion(motion, numbers, (8,))
    places: dict[str, int | slice] = {"energy_ratio": 0, "modulus": 1}
    places |= {f"nutation {k}": slice(2 * k + 2, 2 * k + 4) for k in range(3)}
    return lambda name: {"sigma": found.sigma[places[name]], "linear": found.linear[places[name]]}


def of_end(motion: FreeMotion | HeavyTop | GyrostatMotion, until: float, axes: Floats, rate: float) -> Told:
    """Give it at the end."""
    found = _end(motion, until)
    if found is None:
        return {}
    covariance, linear = found
    is_linear = bool(linear[3:].all())
    return {"sigma": rate * _along(axes, covariance[3:, 3:]), "linear": np.full(3, is_linear)}


def attitude_field(motion: FreeMotion | HeavyTop | GyrostatMotion, until: float) -> list[Field]:
    """Sigmas of the small angles by which the body may be turned at the end."""
    found = _end(motion, until)
    if found is None:
        return []
    covariance, linear = found
    sigma = np.degrees(np.sqrt(np.diagonal(covariance)[:3]))
    hint = "sigma of its rotation about its x y z"
    cells = [
        f"{angle:.2g}{'' if is_linear else '*'}" for angle, is_linear in zip(sigma, linear[:3], strict=True)
    ]
    return [
        Field(
            "attitude_end", "turned by, end", None, "deg", hint, sigma=sigma, linear=linear[:3], cells=cells
        )
    ]


def _end(motion: FreeMotion | HeavyTop | GyrostatMotion, until: float) -> tuple[Floats, Any] | None:
    """Give the covariance of attitude and angular velocity at the end, and what of it is linear."""
    run = motion.at([0.0, until])
    if run.covariance is None or run.sigma is None:
        return None
    linear = run.sigma.linear
    return run.covariance[-1], np.concatenate([linear.attitude[-1], linear.omega[-1]])


def _along(axes: Floats, covariance: Floats) -> Floats:
    """Give the standard deviations of components along axes, the columns."""
    return np.sqrt(np.maximum(np.diagonal(axes.T @ covariance @ axes), 0.0))
