"""What reports tell of an uncertain body: the sigma of each number, and whether the first order is enough."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final, TypedDict

import numpy as np

from polhode.cli.layout import NOT_LINEAR, ROUNDING, Field

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode import RigidBody
    from polhode.cli.layout import Report

    Floats = NDArray[np.float64]

__all__ = ["Told", "about_point", "angle_field", "moments_slopes", "note_linear", "squared", "told"]

_LACKING: Final = 0.015
"""Largest part of a variance that the first order may lack, as that of a body's own sigmas."""
_LARGE: Final = 0.17
"""Relative sigma of a number above which its square has another one than twice that, by a percent."""
_ELEMENTS: Final = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


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
    """Sigma of the tensor about a point that is known exactly.

    I_P = I_C + m (d² 1 - d dᵀ), d from P to C: of third degree in the ten numbers. With the derivatives g, H
    and T of an element and the covariance S its variance is g S g + tr(H S H S)/2 + g S (T : S) and less.
    The first term is reported, the others tell whether it is enough.
    """
    sigma = body.sigma
    covariance: Any = body.covariance
    if covariance is None or sigma is None:
        return {}
    m, d = float(body.mass), body.center_of_mass - point
    deviations, flags = np.zeros((3, 3)), np.zeros((3, 3), dtype=bool)
    noise = ROUNDING * float(np.trace(body.inertia) + m * d @ d)
    own = np.asarray(sigma.linear.inertia) & bool(sigma.linear.mass)
    for place, (i, j) in enumerate(_ELEMENTS):
        # The element is q(d) m + its own, with the quadratic form q = d·Q d.
        unit = np.zeros((3, 3))
        unit[i, j] += 0.5
        unit[j, i] += 0.5
        form = np.eye(3) * float(i == j) - unit
        gradient = np.zeros(10)
        gradient[0], gradient[1:4], gradient[4 + place] = d @ form @ d, 2.0 * m * form @ d, 1.0
        bend = np.zeros((10, 10))
        bend[0, 1:4] = bend[1:4, 0] = 2.0 * form @ d
        bend[1:4, 1:4] = 2.0 * m * form
        # T : S, which is what the third order adds to the gradient, twice.
        third = np.zeros(10)
        third[0] = 2.0 * np.sum(form * covariance[1:4, 1:4])
        third[1:4] = 4.0 * form @ covariance[0, 1:4]
        first = gradient @ covariance @ gradient
        product = bend @ covariance
        lacking = 0.5 * np.sum(product * product.T) + gradient @ covariance @ third
        deviations[i, j] = deviations[j, i] = math.sqrt(max(float(first), 0.0))
        by_center = np.where(sigma.linear.center_of_mass, 0.0, gradient[1:4] * sigma.center_of_mass)
        missing = abs(lacking) + by_center @ by_center
        flags[i, j] = flags[j, i] = own[i, j] and missing <= _LACKING * first + noise * noise
    return {"sigma": deviations, "linear": flags}


def moments_slopes(body: RigidBody) -> Floats | None:
    """Give what one sigma of each variable does to the principal moments, shape (k, 3).

    Each moment is e·I e, and turning the axes e adds nothing to it at first. Sums of these cancel to
    rounding, those of a covariance to its root.
    """
    state = body._doubts()
    if state is None:
        return None
    axes = body.principal.axes
    by_element = [axes[i] * axes[j] * (1.0 if i == j else 2.0) for i, j in _ELEMENTS]
    found: Floats = state["tangents"][:, 4:] @ np.array(by_element)
    return found


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
