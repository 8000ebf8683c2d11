"""What a spectroscopist reads off a body: rotational constants, planar moments, each with its sigma."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode._rounding import with_sigma
from polhode.cli.layout import NOT_LINEAR, ROUNDING, Cell, Field, number
from polhode.cli.sigmas import Told, angle_field, moments_slopes
from polhode.cli.tables import top_fields
from polhode.molecules import (
    inertial_defect,
    planar_moments,
    ray_kappa,
    rotational_constants,
    rotational_constants_sigma,
)
from polhode.uncertainty.propagation import propagate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import RigidBody
    from polhode.cli.loading import LoadedBody

    Floats = NDArray[np.float64]

__all__ = ["constant_fields", "isotopologue_row", "rotation_fields", "straightened"]

_UNIT: Final = "u angstrom^2"
_LARGE: Final = 0.043
"""Relative sigma of a moment above which its reciprocal has another one by a percent."""
_PLANAR: Final = 0.5 * np.array([[-1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, -1.0]])
_DEFECT: Final = np.array([-1.0, -1.0, 1.0])


class _Moments(NamedTuple):
    """Principal moments; what one sigma of each variable does to them; where the first order is enough."""

    values: Floats
    slopes: Floats | None
    linear: NDArray[np.bool_]

    @property
    def sigma(self) -> Floats | None:
        return None if self.slopes is None else np.sqrt((self.slopes**2).sum(axis=0))

    def told(self) -> Told:
        return {} if self.slopes is None else {"sigma": self.sigma, "linear": self.linear}

    def told_of_constants(self, unit: Any) -> Told:
        sigma = self.sigma
        if sigma is None:
            return {}
        linear = self.linear & (sigma <= _LARGE * self.values)
        return {
            "sigma": rotational_constants_sigma(self.values, sigma, unit),
            "linear": linear | (self.values == 0.0),
        }


class _Derived(NamedTuple):
    """What is told of numbers that follow from the moments, of which those sigmas may cancel."""

    defect: Told
    planar: Told
    kappa: Told


def _derived(body: RigidBody, moments: _Moments, top: str) -> _Derived:
    """Sigmas of inertial defect, planar moments and Ray's kappa.

    Where first-order terms cancel, as those of kappa do for a molecule that is as symmetric as water, the
    moments' own flags tell nothing: draws along the body's covariance do. Numbers are raised by their scale,
    so that what is zero counts as zero.
    """
    if moments.slopes is None:
        return _Derived({}, {}, {})
    a, b, c = constants = rotational_constants(moments.values)
    by_constants = np.zeros(3)
    if top == "asymmetric":
        by_constants = np.array([-2.0 * (b - c), 2.0 * (a - c), 2.0 * (b - a)]) / (a - c) ** 2
        by_constants *= -constants / moments.values
    weights = np.vstack([_DEFECT, _PLANAR, by_constants])
    sigma = np.sqrt(((moments.slopes @ weights.T) ** 2).sum(axis=0))

    def raised(one: RigidBody) -> Floats:
        values = one.principal_moments
        if top == "linear":
            along = planar_moments(values)[0]
            values = np.array([0.0, along, along])
        kappa = ray_kappa(rotational_constants(values)) if top == "asymmetric" else 0.0
        scale = float(moments.values[2])
        return np.array([inertial_defect(values) + scale, *(planar_moments(values) + scale), kappa + 2.0])

    linear = propagate(raised, body).linear
    return _Derived(
        Told(sigma=sigma[0], linear=linear[0]),
        Told(sigma=sigma[1:4], linear=linear[1:4]),
        Told(sigma=sigma[4], linear=linear[4]),
    )


def _moments(body: RigidBody, rtol: float | None = None) -> _Moments:
    """Principal moments; of a linear molecule, from the positions of its atoms along the axis alone.

    By the last digits of its file it may be bent. Then Ia is 0 and Ib = Ic is Paa, the sum of m a^2, which is
    what one straight line has; Ia = 0 beside the other two as they stand would be no body's.
    """
    moments, slopes = body.principal_moments, moments_slopes(body)
    linear = np.full(3, True) if body.sigma is None else np.asarray(body.sigma.linear.principal_moments)
    if body.principal.classify(rtol) != "linear":
        return _Moments(moments, slopes, linear)
    along = planar_moments(moments)[0]
    if slopes is not None:
        slopes = slopes @ np.array([np.zeros(3), _PLANAR[0], _PLANAR[0]]).T
    linear = np.array([True, linear[1:].all(), linear[1:].all()])
    return _Moments(np.array([0.0, along, along]), slopes, linear)


def straightened(body: RigidBody, rtol: float | None = None) -> list[str]:
    """Give a note where a molecule counts as linear although the last digits of its file bend it."""
    least = body.principal_moments[0]
    if least == 0.0 or body.principal.classify(rtol) != "linear":
        return []
    return [
        f"by its last digits not quite straight, Ia = {least:.3g} u angstrom^2; the constants are those of "
        "the atoms' places along the axis, Ia = 0 and Ib = Ic = Paa"
    ]


def constant_fields(body: RigidBody, rtol: float | None = None) -> list[Field]:
    """Rotational constants, and of an asymmetric top Ray's kappa."""
    moments = _moments(body, rtol)
    frequencies = rotational_constants(moments.values, "MHz")
    waves = rotational_constants(moments.values, "cm^-1")
    of_frequencies, of_waves = (moments.told_of_constants(unit) for unit in ("MHz", "cm^-1"))
    fields = [
        Field("rotational_constants_MHz", "A  B  C", frequencies, "MHz", decimals=3, **of_frequencies),
        Field("rotational_constants_cm^-1", "", waves, "cm^-1", decimals=6, **of_waves),
    ]
    top = str(body.principal.classify(rtol))
    if top == "asymmetric":
        kappa = float(ray_kappa(frequencies))
        of_kappa = _derived(body, moments, top).kappa
        fields.append(Field("ray_kappa", "Ray's kappa", kappa, scale=1.0 if of_kappa else 0.0, **of_kappa))
    return fields


def rotation_fields(loaded: LoadedBody, rtol: float | None) -> list[Field]:
    """Class of the top, moments, axes and constants of a molecule."""
    body = loaded.body
    moments = _moments(body, rtol)
    values, scale = moments.values, float(moments.values[2])
    derived = _derived(body, moments, str(body.principal.classify(rtol)))
    return [
        *top_fields(loaded, rtol),
        Field("principal_moments", "Ia Ib Ic", values, _UNIT, **moments.told()),
        Field("axes", "axes a b c", body.principal.axes, hint="columns", scale=1.0),
        *angle_field(body),
        *constant_fields(body, rtol),
        Field(
            "inertial_defect",
            "inertial defect",
            inertial_defect(values),
            _UNIT,
            "Ic - Ia - Ib",
            scale=scale,
            **derived.defect,
        ),
        Field(
            "planar_moments",
            "planar Paa Pbb Pcc",
            planar_moments(values),
            _UNIT,
            scale=scale,
            **derived.planar,
        ),
    ]


def isotopologue_row(name: str, body: RigidBody, rtol: float | None) -> dict[str, Any]:
    """Tell of one isotopologue, as the fields above."""
    moments = _moments(body, rtol)
    values = moments.values
    constants = rotational_constants(values, "MHz")
    top = str(body.principal.classify(rtol))
    row = {
        "isotopes": name,
        "mass": float(body.mass),
        "principal_moments": values,
        "rotational_constants_MHz": constants,
        "rotational_constants_cm^-1": rotational_constants(values, "cm^-1"),
        "inertial_defect": float(inertial_defect(values)),
        "planar_moments": planar_moments(values),
        "ray_kappa": float(ray_kappa(constants)) if top == "asymmetric" else None,
        "top": top,
    }
    if body.sigma is None:
        return row
    derived = _derived(body, moments, top)
    tellings = {
        "mass": Told(sigma=body.sigma.mass, linear=body.sigma.linear.mass),
        "principal_moments": moments.told(),
        "rotational_constants_MHz": moments.told_of_constants("MHz"),
        "rotational_constants_cm^-1": moments.told_of_constants("cm^-1"),
        "inertial_defect": derived.defect,
        "planar_moments": derived.planar,
    }
    if top == "asymmetric":
        tellings["ray_kappa"] = derived.kappa
    for key, decimals in (("rotational_constants_MHz", 3), ("inertial_defect", 6), ("ray_kappa", 6)):
        if row[key] is not None:
            scale = float(values[2]) if key == "inertial_defect" else 0.0
            row[key] = Cell(_text(row[key], tellings[key], decimals, scale), row[key])
    return {
        **row,
        "sigma": {key: told["sigma"] for key, told in tellings.items()},
        "linear": {key: told["linear"] for key, told in tellings.items()},
    }


def _text(value: Any, told: Told, decimals: int, scale: float) -> str:
    sigmas, flags = np.ravel(np.asarray(told["sigma"])), np.ravel(np.asarray(told["linear"]))
    words = []
    for x, sigma, is_linear in zip(np.ravel(value).tolist(), sigmas.tolist(), flags.tolist(), strict=True):
        text = with_sigma(x, sigma) if sigma > ROUNDING * max(abs(x), scale) else number(x, decimals)
        words.append(text if is_linear else f"{text}{NOT_LINEAR}")
    return "  ".join(words)
