"""What reports tell of an uncertain body: the sigma of each number, and whether the first order is enough."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, TypedDict

import numpy as np

from polhode._tangents import changes_in_principal_axes
from polhode.cli.layout import NOT_LINEAR, ROUNDING, Field

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode import RigidBody
    from polhode.cli.layout import Report

    Floats = NDArray[np.float64]

__all__ = ["Told", "about_point", "angle_field", "moments_slopes", "note_linear", "squared", "told"]

_LARGE: Final = 0.17
"""Relative sigma of a number above which its square has another one than twice that, by a percent."""


class Told(TypedDict, total=False):
    """What a field is told besides its value; nothing where the body has no covariance."""

    sigma: ArrayLike | None
    linear: ArrayLike | None


def told(body: RigidBody, name: str) -> Told:
    """Give a number of :class:`polhode.results.Sigma` with its flag."""
    if body.sigma is None:
        return {}
    return {"sigma": getattr(body.sigma, name), "linear": getattr(body.sigma.linear, name)}


def squared(value: Floats, of_value: Told) -> Told:
    """Give the sigma of the square of a number."""
    if not of_value:
        return {}
    sigma = np.asarray(of_value["sigma"])
    return {
        "sigma": 2.0 * value * sigma,
        "linear": np.asarray(of_value["linear"]) & (sigma <= _LARGE * value),
    }


def about_point(body: RigidBody, point: Floats) -> Told:
    """Sigma of the tensor about a point that is known exactly."""
    sigma = body.sigma_about(point)
    return {} if sigma is None else {"sigma": sigma.inertia, "linear": sigma.linear.inertia}


def moments_slopes(body: RigidBody) -> Floats | None:
    """Give what one sigma of each variable does to the principal moments, shape (k, 3).

    Each moment is e·I e, and turning the axes e adds nothing to it at first. Sums of these cancel to
    rounding, those of a covariance to its root.
    """
    changes = changes_in_principal_axes(body)
    return None if changes is None else np.diagonal(changes[0], axis1=-2, axis2=-1)


def angle_field(body: RigidBody) -> list[Field]:
    """Sigmas of the small angles by which the principal axes may be turned."""
    if body.sigma is None:
        return []
    angles, linear = np.degrees(body.sigma.axes), np.asarray(body.sigma.linear.axes)
    cells = [
        "not determined" if np.isnan(angle) else _angle(angle) + ("" if is_linear else NOT_LINEAR)
        for angle, is_linear in zip(angles.tolist(), linear.tolist(), strict=True)
    ]
    hint = "sigma of their rotation about e1 e2 e3"
    return [Field("axes", "  turned by", None, "deg", hint, sigma=angles, linear=linear, cells=cells)]


def _angle(degrees: float) -> str:
    return f"{degrees:.2g}" if degrees > math.degrees(ROUNDING) else "0"


def note_linear(report: Report) -> None:
    """Say what ± is, and what to do about marked numbers."""
    fields = [item for _, items in report.sections for item in items if isinstance(item, Field)]
    told = [item for item in fields if item.sigma is not None]
    if not told:
        return
    report.notes.append("± is one standard deviation, to first order")
    if any(
        np.any(~np.asarray(item.linear, bool) & ~np.isnan(np.asarray(item.sigma, float))) for item in told
    ):
        report.notes.append(
            f"{NOT_LINEAR}: the first order is not enough; in Python "
            'polhode.uncertainty.propagate(f, body, method="monte-carlo", seed=1) tells what is right'
        )
