"""What ``polhode spin`` tells of an uncertain motion: at its start and at its end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _core
from polhode.cli.layout import Field

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import FreeMotion, GyrostatMotion, HeavyTop
    from polhode.cli.sigmas import Told

    Floats = NDArray[np.float64]

__all__ = ["attitude_field", "of_end", "of_start"]


def of_start(motion: FreeMotion | HeavyTop | GyrostatMotion, axes: Floats, rate: float) -> Told:
    """Sigma of the angular velocity at the start, along these axes; `rate` units are one rad/s."""
    omega = None if isinstance(motion, _core.GyrostatMotion) else motion.uncertain_start[0]
    if omega is None:
        return {}
    return {"sigma": rate * _along(axes, omega.covariance), "linear": np.ones(3, dtype=bool)}


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
