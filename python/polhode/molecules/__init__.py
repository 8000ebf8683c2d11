"""Molecules as rigid bodies: isotope masses and rotational constants.

Masses are in unified atomic mass units (u) and lengths in angstrom; each moment of inertia is then in u
angstrom^2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from polhode import _core
from polhode.errors import PolhodeError
from polhode.molecules.bonding import CellBond, CellCrossings, bonds, cell_crossings, uncertain_positions
from polhode.molecules.nuclides import Isotope, Masses, isotopes, uncertain_masses

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "ATOMIC_MASS_CONSTANT",
    "PLANCK_CONSTANT",
    "SPEED_OF_LIGHT",
    "CellBond",
    "CellCrossings",
    "Isotope",
    "bonds",
    "cell_crossings",
    "inertial_defect",
    "isotopes",
    "planar_moments",
    "ray_kappa",
    "rotational_constants",
    "rotational_constants_sigma",
    "uncertain_masses",
    "uncertain_positions",
]

# CODATA 2022 (Mohr, Newell, Taylor, Tiesinga, "CODATA recommended values of the fundamental physical
# constants: 2022"); the first two are exact by the definition of the SI.
PLANCK_CONSTANT: Final = 6.62607015e-34
"""h in J s, exact."""
SPEED_OF_LIGHT: Final = 299792458.0
"""c in m/s, exact."""
ATOMIC_MASS_CONSTANT: Final = 1.66053906892e-27
"""One u in kg; standard uncertainty 0.00000000052e-27."""

_SIGMA_OF_U: Final = 0.00000000052e-27 / ATOMIC_MASS_CONSTANT
"""Relative standard uncertainty of one u."""

_ANGSTROM: Final = 1e-10


def body_of_atoms(
    masses: ArrayLike,
    positions: ArrayLike,
    *,
    source: Masses | Literal["own"] = "most_common",
    rounding: float = 0.0,
) -> _core.RigidBody:
    """Make the body of a molecule, whether its atoms come from a file or from another library's object.

    Parameters
    ----------
    masses : array_like, shape (n,)
        Masses of the atoms.
    positions : array_like, shape (n, 3)
        Positions of the atoms, in the unit of length of the body.
    source : {"most_common", "average", "own"}
        Whose masses they are: of isotopes, of elements, or given with the atoms. `provenance` tells it.
    rounding : float
        Largest amount by which a coordinate was rounded, where that is known. The class of the top then takes
        moments as equal that differ by no more than this can make.

    Returns
    -------
    RigidBody
    """
    body = _core.RigidBody.from_particles(masses, positions)
    return body._of_atoms(source, rounding)


def rotational_constants(moments: ArrayLike, unit: Literal["MHz", "cm^-1"] = "MHz") -> Floats:
    r"""Compute the rotational constants A >= B >= C of principal moments.

    .. math:: A = \frac{h}{8 \pi^2 I_1}\ \text{(frequency)},\qquad
              \frac{A}{c} = \frac{h}{8 \pi^2 c\, I_1}\ \text{(wave number)}

    Parameters
    ----------
    moments : array_like, shape (..., 3)
        Principal moments in u angstrom^2, ascending.
    unit : {"MHz", "cm^-1"}
        Frequency or wave number.

    Returns
    -------
    numpy.ndarray, shape (..., 3)
        Rotational constants; infinite where the moment is zero, as about the axis of a linear molecule or for
        an atom.

    Examples
    --------
    >>> from polhode.molecules import rotational_constants
    >>> rotational_constants([0.0, 1.0, 1.0]).round(1)
    array([    inf, 505379., 505379.])
    """
    if unit == "MHz":
        scale = 1e-6
    elif unit == "cm^-1":
        scale = 1e-2 / SPEED_OF_LIGHT
    else:
        raise ValueError(f"unit: expected 'MHz' or 'cm^-1', got {unit!r}")
    inertia = np.moveaxis(_components(moments), 0, -1)
    numerator = scale * PLANCK_CONSTANT / (8.0 * np.pi**2 * ATOMIC_MASS_CONSTANT * _ANGSTROM**2)
    with np.errstate(divide="ignore", over="ignore"):
        constants: Floats = np.divide(numerator, inertia)
    return constants


def rotational_constants_sigma(
    moments: ArrayLike, sigma: ArrayLike, unit: Literal["MHz", "cm^-1"] = "MHz"
) -> Floats:
    r"""Compute the standard deviations of rotational constants, to first order.

    .. math:: \frac{\sigma_A}{A} = \sqrt{\left(\frac{\sigma_{I_1}}{I_1}\right)^2
              + \left(\frac{\sigma_\mathrm{u}}{\mathrm{u}}\right)^2}

    Parameters
    ----------
    moments : array_like, shape (..., 3)
        Principal moments in u angstrom^2, ascending.
    sigma : array_like, shape (..., 3)
        Standard deviations of the moments, as in :attr:`polhode.RigidBody.sigma`.
    unit : {"MHz", "cm^-1"}
        Frequency or wave number.

    Returns
    -------
    numpy.ndarray, shape (..., 3)
        Standard deviations; NaN where the constant is infinite. They include the uncertainty of the atomic
        mass constant, 3.1e-10 of each constant, which is the same error for all constants of all molecules.

    Raises
    ------
    PolhodeError
        For a sigma that is negative or not a number.

    Examples
    --------
    >>> from polhode.molecules import rotational_constants_sigma
    >>> rotational_constants_sigma([1.0, 2.0, 3.0], [0.01, 0.01, 0.02]).round(1)
    array([5053.8, 1263.4, 1123.1])
    """
    constants = rotational_constants(moments, unit)
    inertia = np.moveaxis(_components(moments), 0, -1)
    deviations = _core.real_numbers(sigma, "sigma")
    if deviations.shape[-1:] != (3,):
        raise ValueError(f"sigma: expected shape (..., 3), got {deviations.shape}")
    if not (deviations >= 0.0).all():
        raise PolhodeError("sigma: expected standard deviations of 0 or more")
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        found: Floats = constants * np.hypot(deviations / inertia, _SIGMA_OF_U)
    return np.where(np.isfinite(constants), found, np.nan)


def ray_kappa(constants: ArrayLike) -> Any:
    """Compute Ray's asymmetry parameter (2 B - A - C) / (A - C).

    Parameters
    ----------
    constants : array_like, shape (..., 3)
        A >= B >= C in any unit.

    Returns
    -------
    float or numpy.ndarray, shape (...)
        -1 for a prolate, +1 for an oblate symmetric top. NaN where A = C or A is infinite: the parameter is
        not defined there.

    Examples
    --------
    >>> from polhode.molecules import ray_kappa
    >>> float(ray_kappa([3.0, 2.0, 1.0]))
    0.0
    """
    a, b, c = np.moveaxis(_core.real_numbers(constants, "constants"), -1, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return ((b - c) - (a - b)) / (a - c)


def inertial_defect(moments: ArrayLike) -> Any:
    r"""Compute the inertial defect of principal moments; it is zero for matter in a plane.

    .. math:: \Delta = I_c - I_a - I_b = -2 \sum_i m_i c_i^2

    Parameters
    ----------
    moments : array_like, shape (..., 3)
        Principal moments about the centre of mass, ascending, in any unit.

    Returns
    -------
    float or numpy.ndarray, shape (...)
        Inertial defect in the unit of the moments. For a rigid body it is zero or negative, but for rounding
        (a few units in the last place of the largest moment). For a vibrating planar molecule it is positive.

    Examples
    --------
    >>> from polhode.molecules import inertial_defect
    >>> float(inertial_defect([1.0, 2.0, 2.5]))
    -0.5
    """
    a, b, c = _components(moments)
    return (c - b) - a


def planar_moments(moments: ArrayLike) -> Floats:
    r"""Compute the planar moments of principal moments: the spread of matter along each axis.

    .. math:: P_{aa} = \tfrac12 (I_b + I_c - I_a) = \sum_i m_i a_i^2,\ \ldots

    Parameters
    ----------
    moments : array_like, shape (..., 3)
        Principal moments about the centre of mass, ascending, in any unit.

    Returns
    -------
    numpy.ndarray, shape (..., 3)
        :math:`P_{aa} \ge P_{bb} \ge P_{cc} \ge 0` in the same unit, but for the rounding of the moments; the
        last is half of minus the inertial defect.

    Examples
    --------
    >>> from polhode.molecules import planar_moments
    >>> planar_moments([1.0, 2.0, 2.5])
    array([1.75, 0.75, 0.25])
    """
    a, b, c = _components(moments)
    return np.stack([(c - a) + b, (c - b) + a, a - (c - b)], axis=-1) / 2.0


def _components(moments: ArrayLike) -> Any:
    inertia = _core.real_numbers(moments, "moments")
    if inertia.shape[-1:] != (3,):
        raise ValueError(f"moments: expected shape (..., 3), got {inertia.shape}")
    return np.moveaxis(inertia, -1, 0)
