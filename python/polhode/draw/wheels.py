"""Wheels in a body, drawn as discs on its outside: their places and their angles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np

from polhode.draw.load_parts import Part, parts_of
from polhode.draw.sampling import TURN
from polhode.draw.shape import longest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import GyrostatMotion, Trajectory
    from polhode.draw.sampling import Footage
    from polhode.draw.shape import Shape

    Floats = NDArray[np.float64]

__all__ = ["RINGS", "SPOKE", "SPOKES", "Disc", "Spin", "discs_of", "slowdown"]

_RADIUS: Final = 0.2
"""Radius of a disc, relative to the length of the body; not to scale, because the size is unknown."""
_HALF: Final = 0.035
"""Half the thickness of a disc, in the same unit."""
SPOKES: Final = 6
"""Number of narrow spokes, beside the broad one that shows the angle."""
SPOKE: Final = 0.86
"""Length of a spoke, relative to the radius."""
RINGS: Final = (0.3, 0.55, 0.8)
"""Radii of the rings on a disc whose angle is unknown."""
_BESIDE: Final = 0.95
"""The cosine between axes above which discs stand one behind the other."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)


@dataclass(frozen=True)
class Spin:
    """How a wheel turns, relative to the body.

    Attributes
    ----------
    name : str
        As the viewer reads it.
    axis : numpy.ndarray, shape (3,)
        In the body frame, a unit vector.
    rate, angle : numpy.ndarray, shape (T,), or None
        Its speed about the axis, and the integral of that since the first time. None where the momentum alone
        is known, and so no speed.
    """

    name: str
    axis: Floats
    rate: Floats | None
    angle: Floats | None


@dataclass(frozen=True)
class Disc(Spin):
    """A wheel as it is drawn: a disc normal to its axis.

    Attributes
    ----------
    middle : numpy.ndarray, shape (3,)
        Of the disc, from the point of reference, in the body frame: beyond a plane that has the whole body on
        its other side.
    radius, half : float
        Its radius and half its thickness, not to scale.
    """

    middle: Floats
    radius: float
    half: float

    def circle(self, angles: Floats, radius: float, height: float) -> Floats:
        """Return points about the axis, so far from it, and so far along it from the middle."""
        across = np.cross(self.axis, np.eye(3)[np.abs(self.axis).argmin()])
        across /= np.linalg.norm(across)
        beside = np.cross(self.axis, across)  # counterclockwise about the axis
        around: Floats = np.outer(np.cos(angles), across) + np.outer(np.sin(angles), beside)
        return self.middle + height * self.axis + radius * around

    def factor(self, between: float) -> float:
        """Return the factor by which its rotation is drawn slower, for this time between two pictures."""
        return 1.0 if self.rate is None else slowdown(float(np.abs(self.rate).max()) * between)

    def words(self, frame: int, factor: float, time_unit: str) -> str:
        """Return the text with the speed of the wheel and the factor of the drawing."""
        if self.rate is None:
            return f"{self.name}: speed not known"
        drawn = f", drawn {factor:,g}× slower" if factor > 1.0 else ""
        return f"{self.name}: {self.rate[frame]:.4g} rad/{time_unit}{drawn}"


def slowdown(turn: float) -> float:
    """Return the factor 1, 2, 5, 10, … by which a rotation is drawn slower than it is.

    Parameters
    ----------
    turn : float
        The true one from picture to picture, in radians. What is drawn is `TURN` at most: by half a turn and
        more, a wheel would seem to stand still or to turn backward.
    """
    if not turn > TURN * (1.0 + 1e-9):
        return 1.0
    decade = 10.0 ** np.floor(np.log10(turn / TURN))
    steps = decade * np.array([1.0, 2.0, 5.0, 10.0])
    return float(steps[steps * TURN >= turn * (1.0 - 1e-9)][0])


def discs_of(footage: Footage, shape: Shape, motion: GyrostatMotion | None) -> tuple[Disc, ...]:
    """Find the wheels of a motion at its frames.

    Parameters
    ----------
    footage : Footage
        The states that are shown.
    shape : Shape
        The body as it is drawn, on whose outside they stand.
    motion : GyrostatMotion or None
        The closed form of the same motion, from its first time on.
    """
    trajectory = footage.trajectory
    spins = _of_load(trajectory) if motion is None else _of_gyrostat(motion, trajectory)
    chosen = footage.chosen
    return _place_discs(
        [
            Spin(
                one.name,
                one.axis,
                None if one.rate is None else one.rate[chosen],
                None if one.angle is None else one.angle[chosen],
            )
            for one in spins
        ],
        shape,
        trajectory.body.center_of_mass - trajectory.about,
    )


def _of_gyrostat(motion: GyrostatMotion, trajectory: Trajectory) -> list[Spin]:
    """Return the wheels of a gyrostat, and the momentum besides them as a rotor.

    The integral of ω along the axis of a free one is that of a formula of six nodes between two times.
    """
    t, wheels = trajectory.t, motion.gyrostat.wheels
    _, (_, rest, _) = cast("tuple[Any, tuple[Any, Floats, Any]]", motion.gyrostat.__reduce__())
    since = t - t[0]
    spins: list[Spin] = []
    between = None
    for number, wheel in enumerate(wheels, 1):
        axis = np.asarray(wheel.axis) / np.linalg.norm(wheel.axis)
        name = "wheel" if len(wheels) == 1 else f"wheel {number}"
        if not wheel.inertia > 0.0:
            spins += _rotor(wheel.momentum * axis, name)
        elif wheel.mode == "held":
            rate = np.full(len(t), wheel.rate)
            spins.append(Spin(name, axis, rate, rate * since))
        else:
            total = wheel.rate + float(axis @ motion.omega)  # in space, which it keeps
            if between is None:
                step = np.diff(since)[:, np.newaxis]
                nodes = since[:-1, np.newaxis] + step * (0.5 + 0.5 * _NODES)
                between = np.einsum("knj,n->kj", motion.at(nodes).omega, 0.5 * _WEIGHTS) * step
            turned = np.concatenate([[0.0], np.cumsum(between @ axis)])
            spins.append(Spin(name, axis, total - trajectory.omega @ axis, total * since - turned))
    return spins + _rotor(np.asarray(rest, dtype=np.float64), "rotor")


def _of_load(trajectory: Trajectory) -> list[Spin]:
    """Return the wheels and rotors of the load of a run."""
    spins: list[Spin] = []
    for part in parts_of(trajectory.load) if trajectory.load is not None else []:
        if part.made_by == "wheel":
            spins.append(_driven(trajectory, part))
        elif part.made_by == "rotor":
            spins += _rotor(part.load.carried(0.0, np.zeros(3))[0], "rotor")
    return spins


def _driven(trajectory: Trajectory, wheel: Part) -> Spin:
    """Return a wheel of a load; its momentum in the body is J Ω a. Between the times Ω follows cubics."""
    axis, inertia = wheel.number(0, axes=1), float(wheel.number(1))
    axis = axis / np.linalg.norm(axis)
    (state,), t = wheel.states, trajectory.t
    own, *asked = wheel.load.states  # those of a controller say nothing of the momentum
    states = {name: np.zeros((*t.shape, wheel.load.states[name])) for name in asked}
    momentum, _ = wheel.load.carried(t, trajectory.omega, states | {own: trajectory.states[state]})
    rate = momentum @ axis / inertia
    turned = 0.5 * np.diff(t) * (rate[1:] + rate[:-1])
    if len(t) > 2:
        turned -= np.diff(t) ** 2 / 12.0 * np.diff(np.gradient(rate, t, edge_order=2))
    return Spin(state.replace("_", " "), axis, rate, np.concatenate([[0.0], np.cumsum(turned)]))


def _rotor(momentum: Floats, name: str) -> list[Spin]:
    """Return a wheel of which only the momentum is known: an axis without a speed."""
    size = float(np.linalg.norm(momentum))
    return [Spin(name, momentum / size, None, None)] if size > 0.0 else []


def _place_discs(spins: list[Spin], shape: Shape, center: Floats) -> tuple[Disc, ...]:
    """Put discs on the outside of a body, each on the line along its axis through the centre of mass."""
    reach = longest(shape.vertices)
    discs: list[Disc] = []
    for spin in spins:
        before = sum(float(spin.axis @ one.axis) > _BESIDE for one in discs)
        outside = float((shape.vertices @ spin.axis).max(initial=0.0)) - float(spin.axis @ center)
        along = outside + reach * _HALF * (2.0 + 3.0 * before)
        known: dict[str, Any] = vars(spin)
        discs.append(
            Disc(**known, middle=center + along * spin.axis, radius=_RADIUS * reach, half=_HALF * reach)
        )
    return tuple(discs)
