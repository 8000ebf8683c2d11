"""Tables of several reports: tensors, principal axes, class of the top, sigmas, provenance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypedDict

import numpy as np

from polhode.cli.layout import NOT_LINEAR, ROUNDING, Field
from polhode.equimomental import ellipsoid
from polhode.io.mesh_solid import MeshSolid
from polhode.results import TOP_RTOL
from polhode.uncertainty.variables import changes_in_principal_axes
from polhode.units import metres_per, quantity

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode import RigidBody
    from polhode.cli.layout import Report
    from polhode.cli.loading import LoadedBody

    Floats = NDArray[np.float64]

__all__ = [
    "FileUnits",
    "Sigmas",
    "about_point",
    "angle_field",
    "body_fields",
    "ellipsoid_fields",
    "moments_slopes",
    "note_linear",
    "sigmas_of",
    "sigmas_of_square",
    "tensor_fields",
    "top_fields",
    "trust_fields",
]


@dataclass(frozen=True)
class FileUnits:
    """The units that results are also given in: the file's length, and the mass that was asked for."""

    length: str | None = None
    mass: str | None = None

    def fields(
        self,
        key: str,
        label: str,
        value: ArrayLike,
        unit: str,
        *,
        length: int = 0,
        mass: int = 0,
        scale: float = 0.0,
        sigma: ArrayLike | None = None,
        linear: ArrayLike | None = None,
    ) -> list[Field]:
        """Return powers of length and mass, and where the file has other units also in those.

        Parameters
        ----------
        key, label, value, unit, scale, sigma, linear
            See `Field`; the value in kg and m.
        length, mass : int
            The powers.
        """
        fields = [Field(key, label, value, unit, scale=scale, sigma=sigma, linear=linear)]
        if self.length is None or (self.mass is None if mass else self.length == "m"):
            return fields
        one = metres_per(self.length) ** length
        name = self.length + (f"^{length}" if length > 1 else "") if length else ""
        if mass and self.mass is not None:
            one *= quantity(f"1 {self.mass}", "kg", "--mass-unit") ** mass
            name = f"{self.mass} {name}".strip()
        deviation = None if sigma is None else np.divide(sigma, one)
        fields.append(
            Field(
                f"in_file_unit.{key}",
                "",
                np.divide(value, one),
                name,
                scale=scale / one,
                sigma=deviation,
                linear=linear,
            )
        )
        return fields


def tensor_fields(
    loaded: LoadedBody, units: FileUnits, about: tuple[float, float, float] | None
) -> list[Field]:
    """Compute the inertia tensors about C, about O and about a point that was asked for."""
    body = loaded.body
    tensors = [
        ("center_of_mass", "about C", body.inertia, body.center_of_mass),
        ("origin", "about O", body.inertia_about("origin"), np.zeros(3)),
    ]
    if about is not None:
        tensors.append(("point", "about the point", body.inertia_about(about), np.array(about)))
    fields: list[Field] = []
    for name, label, tensor, point in tensors:
        of_tensor = sigmas_of(body, "inertia") if name == "center_of_mass" else about_point(body, point)
        fields += units.fields(
            f"inertia_about_{name}",
            label,
            tensor,
            loaded.moment_unit,
            length=2,
            mass=1,
            scale=tensor.max(),
            **of_tensor,
        )
    if about is not None:
        point = np.array(about)
        fields += units.fields("point", "  the point", point, loaded.length, length=1, scale=loaded.extent)
    return fields


def body_fields(loaded: LoadedBody, units: FileUnits) -> list[Field]:
    """Compute the principal moments, axes and class of a body."""
    body = loaded.body
    principal = body.principal
    per_mass = principal.moments / body.mass
    square, radius = f"{loaded.length}^2", np.sqrt(per_mass)
    of_moments, of_radii = sigmas_of(body, "principal_moments"), sigmas_of(body, "radii_of_gyration")
    of_squares = sigmas_of_square(radius, of_radii)
    return [
        *units.fields(
            "principal_moments",
            "I1 I2 I3",
            principal.moments,
            loaded.moment_unit,
            length=2,
            mass=1,
            **of_moments,
        ),
        *units.fields("moments_per_mass", "I1 I2 I3 / mass", per_mass, square, length=2, **of_squares),
        *units.fields("radii_of_gyration", "radii of gyration", radius, loaded.length, length=1, **of_radii),
        Field("axes", "e1 e2 e3", principal.axes, hint="columns", scale=1.0),
        *angle_field(body),
        Field("gaps", "gaps 2-1, 3-2", principal.gaps, hint="of I3"),
        *top_fields(loaded),
    ]


def ellipsoid_fields(loaded: LoadedBody, units: FileUnits) -> list[Field]:
    """Compute the semi-axes of the ellipsoid with the same mass and moments, and of that of equal volume."""
    plain = ellipsoid(loaded.body)
    fields = units.fields(
        "equivalent_ellipsoid.semi_axes",
        "same moments",
        plain.semi_axes,
        loaded.length,
        length=1,
        scale=float(plain.semi_axes.max()),
    )
    if np.isfinite(loaded.volume) and plain.volume > 0.0:
        fields += units.fields(
            "equivalent_ellipsoid.equal_volume",
            "scaled to volume",
            ellipsoid(loaded.body, loaded.volume).semi_axes,
            loaded.length,
            length=1,
        )
    return fields


def top_fields(loaded: LoadedBody, rtol: float | None = None) -> list[Field]:
    """Compute the class of the top, and of a molecule the tolerance at which it is decided, and why."""
    principal, rounding = loaded.body.principal, float(loaded.body.provenance.rounding)
    top = Field("top", "top", str(principal.classify(rtol)))
    if isinstance(loaded.source, MeshSolid) or not loaded.source:
        return [top]
    rtols = np.broadcast_to(principal.top_rtol if rtol is None else rtol, (3,))
    if rtol is not None:
        why = "as --rtol says"
    elif rounding == 0.0:
        why = "the default: the coordinates in the file have no decimals"
    elif rtols.max() <= TOP_RTOL:
        why = "the default: the file has enough digits"
    else:
        why = f"what rounding of the coordinates by {rounding:.2g} {loaded.length}, by their digits, can make"
    return [
        top,
        Field("top_rtol", "equal within", rtols, hint="of the largest moment: I1 = 0, I1 = I2, I2 = I3"),
        Field("top_rtol_from", "", why),
    ]


def trust_fields(loaded: LoadedBody) -> list[Field]:
    """Find where the numbers come from and what rounding can have done to them."""
    provenance, bound = loaded.body.provenance, loaded.body.error_bound
    return [
        Field("provenance", "made of", str(provenance)),
        Field("error_bound.mass", "bound on mass", bound.mass, loaded.mass_unit),
        Field("error_bound.center_of_mass", "  on centre", bound.center_of_mass, loaded.length),
        Field("error_bound.inertia", "  on inertia", bound.inertia, loaded.moment_unit),
    ]


_LARGE: Final = 0.17
"""Relative sigma of a number above which its square has another one than twice that, by a percent."""


class Sigmas(TypedDict, total=False):
    """What a field is told besides its value; nothing where the body has no covariance."""

    sigma: ArrayLike | None
    linear: ArrayLike | None


def sigmas_of(body: RigidBody, name: str) -> Sigmas:
    """Return a number of :class:`polhode.results.Sigma` with its flag."""
    if body.sigma is None:
        return {}
    return {"sigma": getattr(body.sigma, name), "linear": getattr(body.sigma.linear, name)}


def sigmas_of_square(value: Floats, of_value: Sigmas) -> Sigmas:
    """Return the sigma of the square of a number."""
    if not of_value:
        return {}
    sigma = np.asarray(of_value["sigma"])
    return {
        "sigma": 2.0 * value * sigma,
        "linear": np.asarray(of_value["linear"]) & (sigma <= _LARGE * value),
    }


def about_point(body: RigidBody, point: Floats) -> Sigmas:
    """Compute the sigma of the tensor about a point that is known exactly."""
    sigma = body.sigma_about(point)
    return {} if sigma is None else {"sigma": sigma.inertia, "linear": sigma.linear.inertia}


def moments_slopes(body: RigidBody) -> Floats | None:
    """Return what one sigma of each variable does to the principal moments, shape (k, 3).

    Each moment is e·I e, and turning the axes e adds nothing to it at first. Sums of these cancel to
    rounding, those of a covariance to its root.
    """
    changes = changes_in_principal_axes(body)
    return None if changes is None else np.diagonal(changes[0], axis1=-2, axis2=-1)


def angle_field(body: RigidBody) -> list[Field]:
    """Compute the sigmas of the small angles by which the principal axes may be turned."""
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
            'polhode.uncertainty.propagate(f, body, method="monte-carlo", seed=1) computes the right one'
        )
