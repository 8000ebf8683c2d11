"""The surface in the body on which a motion's path lies: an ellipsoid, or the sphere of L."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from polhode import _core
from polhode.draw.load_parts import Part, parts_of
from polhode.errors import PolhodeError
from polhode.motion.gyrostat import wheel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import Equilibria, FreeMotion, GyrostatMotion, HeavyTop, Trajectory

    Floats = NDArray[np.float64]

__all__ = [
    "Mark",
    "Surface",
    "energy_level",
    "inertia_semi_axes",
    "principal_circles",
    "separatrix",
    "surface_of",
]

_AROUND: Final = 288
"""Parts of a separatrix: chords of it are at most half a pixel off."""
_NOTHING: Final = 1e-9
"""An L that small, beside I ω and h, has no direction in the body."""


@dataclass(frozen=True)
class Mark:
    """A steady spin of a gyrostat, as it is marked on the sphere of L.

    Attributes
    ----------
    kind : str
        ``"minimum"``, ``"maximum"``, ``"saddle"`` or ``"degenerate"``, see `polhode.Equilibria`.
    direction : numpy.ndarray, shape (3,)
        L/|L| in the body frame.
    circle : numpy.ndarray, shape (3,), or None
        Axis of the circle of equilibria that it stands for.
    level : float
        Its energy, see `energy_level`.
    curve : numpy.ndarray, shape (n, 3), or None
        Of a saddle its separatrix, through unit vectors in the body frame.
    """

    kind: str
    direction: Floats
    circle: Floats | None
    level: float
    curve: Floats | None


@dataclass(frozen=True)
class Surface:
    """The surface that is fixed in the body during a motion, and that is drawn with the path.

    Attributes
    ----------
    kind : {"free", "gyrostat", "torque-free", "loaded"}
        ``"free"``: a body on which no torque acts; ω moves on the ellipsoid ω·I ω = 2T. ``"gyrostat"``: it
        also carries a constant momentum h, as a rotor or as wheels that turn freely or at constant rates; L
        moves on the sphere ``|L|`` = const., along a curve of constant ``½ ω·I ω``. ``"torque-free"``: no
        torque acts from outside, but motors or dampers do inside; L moves on its sphere, and its energy
        changes. ``"loaded"``: neither T nor ``|L|`` need stay as they are.
    momentum : numpy.ndarray, shape (3,), or None
        Of a gyrostat and of a torque-free body the constant L, components in space; None where it is zero.
    level : float or None
        Energy of a gyrostat, see `energy_level`.
    marks : tuple of Mark
        The steady spins of a gyrostat with this ``|L|``.
    is_reduced : bool
        Whether I of a gyrostat is without the moments of its free wheels about their axes.
    """

    kind: Literal["free", "gyrostat", "torque-free", "loaded"]
    momentum: Floats | None = None
    level: float | None = None
    marks: tuple[Mark, ...] = ()
    is_reduced: bool = False


def energy_level(inertia: Floats, inside: Floats, n: Floats) -> Any:
    """Compute ``½ ω·I ω`` of a gyrostat with L along n, in units of L² over the largest element of I.

    Parameters
    ----------
    inertia : numpy.ndarray, shape (3, 3)
        I in the equations of motion.
    inside : numpy.ndarray, shape (3,)
        ``h/|L|``.
    n : numpy.ndarray, shape (..., 3)
        ``L/|L|``, components as those of I.
    """
    off = n - inside
    inverse = np.linalg.inv(inertia) * np.max(np.abs(inertia))
    return 0.5 * np.einsum("...i,ij,...j", off, inverse, off)


def separatrix(inertia: Floats, inside: Floats, n: Floats) -> Floats | None:
    """Compute the curve of constant energy through a saddle on the sphere of L/|L|.

    In a saddle n the angular velocity ``ω = I⁻¹ (L - h)`` is along L: ``ω = r L``. Let d be a unit vector.
    The energy at the mirror image ``n - 2 (n·d) d`` differs from that at n by
    ``2 L² (n·d)² (d·I⁻¹ d - r)``. So the curve consists of the mirror images for all d of the cone
    ``d·I⁻¹ d = r``.

    Parameters
    ----------
    inertia : numpy.ndarray, shape (3, 3)
        I in the equations of motion.
    inside : numpy.ndarray, shape (3,)
        ``h/|L|``, in the frame of I.
    n : numpy.ndarray, shape (3,)
        The saddle.

    Returns
    -------
    numpy.ndarray, shape (n, 3), or None
        None where the energy at n is no saddle.
    """
    moments, axes = np.linalg.eigh(inertia)
    rate = float(n @ np.linalg.solve(inertia, n - inside))
    weights = 1.0 / moments - rate  # descending; the cone is Σ weight d² = 0
    if not weights[0] > 0.0 > weights[2]:
        return None
    # The axis whose weight has a sign of its own, the other extreme, and the one between.
    alone, other = (0, 2) if weights[1] <= 0.0 else (2, 0)
    sizes = np.abs(weights)
    to_other, to_middle = sizes[alone] / (sizes[alone] + sizes[[other, 1]])
    around = np.linspace(0.0, 2.0 * np.pi, _AROUND + 1)
    d = np.empty((len(around), 3))
    d[:, other] = np.sqrt(to_other) * np.cos(around)
    d[:, 1] = np.sqrt(to_middle) * np.sin(around)
    d[:, alone] = np.sqrt((1.0 - to_other) * np.cos(around) ** 2 + (1.0 - to_middle) * np.sin(around) ** 2)
    d = d @ axes.T
    curve: Floats = n - 2.0 * (d @ n)[:, np.newaxis] * d
    return curve


def surface_of(trajectory: Trajectory, motion: FreeMotion | HeavyTop | GyrostatMotion | None) -> Surface:
    """Find the surface on which the path of one body's motion lies.

    Parameters
    ----------
    trajectory : Trajectory
    motion : GyrostatMotion or other
        The closed form of the same motion, where there is one.
    """
    if trajectory._kept_directions() is not True:
        return Surface("loaded")
    if trajectory.carried is None:
        return Surface("free")
    inside = trajectory.carried[0][0]
    momentum = trajectory.angular_momentum().spin[0]
    size = float(np.linalg.norm(momentum))
    in_body = trajectory.angular_momentum("body").spin[0]
    if not size > _NOTHING * float(max(np.linalg.norm(inside), np.linalg.norm(in_body - inside))):
        return Surface("torque-free")
    gyrostat = motion if isinstance(motion, _core.GyrostatMotion) else _gyrostat_motion(trajectory)
    if gyrostat is None:
        return Surface("torque-free", momentum)
    tensor, rotor = np.asarray(gyrostat.gyrostat.inertia), gyrostat.rotor / size
    return Surface(
        "gyrostat",
        momentum,
        float(energy_level(tensor, rotor, in_body / size)),
        _marks(gyrostat.equilibria(), tensor, rotor),
        bool(gyrostat.gyrostat._rotor()[1].any()),
    )


def _marks(found: Equilibria, tensor: Floats, inside: Floats) -> tuple[Mark, ...]:
    marks = []
    for n, axis, kind in zip(found.direction, found.circle, found.kind, strict=True):
        is_saddle = str(kind) == "saddle" and not axis.any()
        curve = separatrix(tensor, inside, n) if is_saddle else None
        level = float(energy_level(tensor, inside, n))
        marks.append(Mark(str(kind), n, axis if axis.any() else None, level, curve))
    return tuple(marks)


def _gyrostat_motion(trajectory: Trajectory) -> GyrostatMotion | None:
    """Find the motion of the gyrostat that a load makes of a body; None where its momentum changes."""
    about, omega = trajectory._about_word(), trajectory.omega[0]
    rest, wheels = np.zeros(3), []
    parts = parts_of(trajectory.load) if trajectory.load is not None else []
    for part in parts:
        if part.made_by == "rotor":
            rest = rest + part.load.carried(0.0, np.zeros(3))[0]
        elif part.made_by == "wheel" and (mode := _mode(part)) is not None:
            axis, inertia = part.number(0, axes=1), float(part.number(1))
            axis = axis / np.linalg.norm(axis)
            relative = float(trajectory.states[part.states[0]][0, 0]) - inertia * float(axis @ omega)
            wheels.append(wheel(axis=axis, inertia=inertia, momentum=relative, mode=mode))
        elif part.load.carries or part.load.keeps_momentum(about) is not True:
            return None
    if not parts:
        return None
    try:
        body = _core.RigidBody(trajectory.body.mass, trajectory.body.inertia_about(about))  # without sigmas
        return body.gyrostat(rest, wheels=wheels).free_motion(omega, trajectory.quaternion[0])
    except PolhodeError:  # of a body with a zero moment there is no closed form
        return None


def _mode(part: Part) -> Literal["free", "held"] | None:
    """Find whether a wheel turns freely or at a constant rate; None where a motor or friction acts."""
    options = part.options(3)
    if options["speed"] is not None:
        return "held" if options["times"] is None else None
    acts = any(options[name] is not None for name in ("torque", "friction", "dry_friction"))
    return None if acts else "free"


_LONGEST: Final = 3.0
"""A semi-axis without end, that of a zero moment, is cut at so many times the longest other one."""


def inertia_semi_axes(moments: Floats) -> Floats:
    """Compute the semi-axes of r·I r = 1, shape (3,); those of zero moments are cut.

    Parameters
    ----------
    moments : numpy.ndarray, shape (3,)
        Principal moments, not all zero.
    """
    if not moments.any():
        raise ValueError("body: all its moments are zero; a point has no ellipsoid of inertia")
    with np.errstate(divide="ignore"):
        semi_axes: Floats = 1.0 / np.sqrt(moments)
    longest = semi_axes[np.isfinite(semi_axes)].max()
    cut: Floats = np.minimum(semi_axes, _LONGEST * longest)
    return cut


def principal_circles() -> Floats:
    """Return the circles of the unit sphere in the planes normal to its axes, shape (3, 181, 3)."""
    around = np.linspace(0.0, 2.0 * np.pi, 181)
    circles = np.zeros((3, 181, 3))
    for k, circle in enumerate(circles):
        circle[:, (k + 1) % 3], circle[:, (k + 2) % 3] = np.cos(around), np.sin(around)
    return circles
