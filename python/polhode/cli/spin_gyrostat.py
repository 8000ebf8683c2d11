"""What ``polhode spin`` tells of a body with wheels that turn in it: a gyrostat."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._drift import drift
from polhode._lengths import lengths
from polhode._quantities import has_unit, quantity
from polhode.cli.layout import Cell, Column, Field, Table
from polhode.cli.spin_kinds import period_fields
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from polhode import GyrostatMotion, Trajectory
    from polhode.cli.loading import LoadedBody

    Floats = NDArray[np.float64]

__all__ = ["GyrostatKind", "momentum_inside"]

_WAY_OUT: Final = 'write "z, 2.5 kg m^2/s" or "0, 0, 1, 2.5 kg m^2/s"'
_MODES: Final = {
    "steady": "L rests in the body",
    "circular": "L goes round in the body as sines and cosines do",
    "separatrix": "L departs from an unstable steady rotation, and comes back to one, once",
    "paired": "L goes round on one of the two curves in the body with this energy",
    "single": "L goes round on the only curve in the body with this energy",
}
_KINDS: Final = {
    "minimum": "stable, of least energy",
    "maximum": "stable, of most energy",
    "saddle": "unstable",
    "degenerate": "neutral: some meet here",
}


def momentum_inside(texts: Sequence[str], axes: Floats, loaded: LoadedBody) -> Floats:
    """Read the wheels and sum up their momenta.

    Parameters
    ----------
    texts : sequence of str
        ``"z, 2.5 kg m^2/s"``, ``"0, 0, 1, 2.5 kg m^2/s"``.
    axes : numpy.ndarray, shape (3, 3)
        Those of the components, as columns in the body frame.
    loaded : LoadedBody
        In whose units a bare number is.

    Returns
    -------
    numpy.ndarray, shape (3,)
        In the body frame.
    """
    if loaded.assumed:
        raise PolhodeError("--wheel: what it does depends on the mass of the body; state --density or --mass")
    if loaded.body.covariance is not None:
        raise PolhodeError(
            "--wheel: sigmas are not followed through the motion of a body with wheels; write the numbers of "
            "the body alone"
        )
    total = np.zeros(3)
    for text in texts:
        *parts, momentum = (part.strip() for part in text.split(","))
        axis = _axis(parts, text, axes, loaded)
        total += _momentum(momentum, loaded) * axis
    return total


def _momentum(text: str, loaded: LoadedBody) -> float:
    unit = f"{loaded.moment_unit}/s"
    if loaded.length != "unit":
        return quantity(text, unit, "--wheel")
    if has_unit(text):
        raise PolhodeError(
            f"--wheel: {text!r} has a unit, but the file's coordinates have none; state --length-unit too"
        )
    return quantity(text, "kg m^2/s", "--wheel")


def _axis(parts: list[str], text: str, axes: Floats, loaded: LoadedBody) -> Floats:
    """Read the direction of an axis: a name, or three numbers."""
    words = parts[0].split() if len(parts) == 1 else parts
    if words in (["x"], ["y"], ["z"]):
        return np.asarray(axes[:, "xyz".index(words[0])])
    if words in (["e1"], ["e2"], ["e3"]):
        return np.asarray(loaded.body.principal.axes[:, int(words[0][1]) - 1])
    try:
        along = np.array([float(word) for word in words])
    except ValueError:
        along = np.zeros(0)
    if along.shape != (3,):
        raise PolhodeError(
            f"--wheel: {text!r} is not an axis (x, y, z, e1, e2, e3 or three numbers), a comma and a "
            f"momentum; {_WAY_OUT}"
        )
    size = math.hypot(*along)
    if not 0.0 < size < math.inf:
        raise PolhodeError(f"--wheel: the axis of {text!r} has no direction; {_WAY_OUT}")
    return np.asarray(axes @ (along / size))


class GyrostatKind:
    """A body in which wheels keep their momentum, and on which nothing acts."""

    def __init__(self, motion: GyrostatMotion, axes: Floats) -> None:
        self._motion = motion
        self._axes = axes
        self._rate, self._rate_unit = 1.0, "rad/s"

    def fields(self, rate: float, rate_unit: str) -> list[Field]:
        """Tell how L moves in the body, and the body about L."""
        self._rate, self._rate_unit = rate, rate_unit
        motion = self._motion
        mode = str(motion.mode)
        hint = "of the body about L, but for whole turns in a period"
        return [
            Field("mode", "mode", mode, hint=_MODES[mode]),
            *self._periods(),
            Field("mean_precession", "mean precession", motion.mean_precession * rate, rate_unit, hint),
        ]

    def _periods(self) -> list[Field]:
        """Return the periods that this mode has, by the words of the glossary."""
        motion = self._motion
        if not np.isnan(motion.period):
            hint = "" if np.isfinite(motion.period) else "omega never returns"
            return period_fields("period", "period in the body", motion.period, hint, {})
        speed = float(lengths(motion.omega))
        if speed == 0.0:
            return [Field("turn_period", "one turn", math.inf, "s", "the body is at rest")]
        turn = period_fields(
            "turn_period", "one turn", 2.0 * math.pi / speed, "about an axis at rest in the body", {}
        )
        along = motion.gyrostat.inertia @ motion.omega + motion.rotor
        if float(lengths(along)) > 0.0:
            found = motion.equilibria
            square = float(found.squared_rate[int(np.argmax(found.direction @ along))])
        else:  # a small L rests in space, and the body turns below it
            square = speed**2
        if square > 0.0:
            hint = "of small oscillations of omega in the body"
            return [
                *turn,
                *period_fields("wobble_period", "wobble", 2.0 * math.pi / math.sqrt(square), hint, {}),
            ]
        why = "the spin is unstable" if square < 0.0 else "the spin is neutral"
        return [*turn, Field("wobble_period", "wobble", None, hint=why, cells=["none"])]

    def constants(self, moment_unit: str) -> list[Field]:
        """Give what is conserved: the energy, the angular momentum, and what of it is inside."""
        motion, unit = self._motion, f"{moment_unit}/s"
        momentum, inside = motion.angular_momentum, motion.rotor
        size, held = float(lengths(momentum)), float(lengths(inside))
        hint = "half of omega.I omega: without the wheels' own"
        return [
            Field("kinetic_energy", "kinetic energy", motion.kinetic_energy, f"{moment_unit}/s^2", hint),
            Field("angular_momentum", "|L|", size, unit, "with the wheels"),
            Field("angular_momentum_vector", "L, in space", momentum, unit, scale=max(size, held)),
            Field(
                "momentum_inside", "h, in the body", inside @ self._axes, unit, "of the wheels", scale=held
            ),
        ]

    def stability(self) -> list[Field | Table]:
        """Give the steady rotations with this length of L."""
        motion = self._motion
        if not float(lengths(motion.angular_momentum)) > 0.0:
            return [Field("stability", "steady rotations", "none with an axis of its own: L is zero")]
        found = motion.equilibria
        rows: list[dict[str, Any]] = []
        for k, kind in enumerate(found.kind.tolist()):
            circle = _clean(found.circle[k] @ self._axes) if found.circle[k].any() else None
            words = _KINDS[kind]
            if circle is not None:
                words += f", one of a circle about ({' '.join(f'{x:.4g}' for x in circle)})"
            rows.append(
                {
                    "direction": _cell(found.direction[k] @ self._axes, "9.5f"),
                    "omega": _cell(found.omega[k] @ self._axes * self._rate, "10.4g"),
                    "kind": Cell(words, kind),
                    "circle": circle,
                    "kinetic_energy": float(found.kinetic_energy[k]),
                    "squared_rate": float(found.squared_rate[k]),
                }
            )
        return [
            Table(
                "equilibria",
                [
                    Column("direction", "L / |L|"),
                    Column("omega", "omega", self._rate_unit),
                    Column("kind", "steady rotation"),
                ],
                rows,
            )
        ]

    def drifts(self, trajectory: Trajectory) -> list[Field]:
        """Tell how well the trajectory keeps what is conserved."""
        energy = trajectory.kinetic_energy().total
        momentum = trajectory.angular_momentum().total
        held = float(lengths(self._motion.rotor))
        size = np.maximum(lengths(momentum), held)  # L may be zero where neither part of it is
        return [
            Field(
                "kinetic_energy_drift",
                "drift of energy",
                drift(energy, np.abs(energy)),
                hint="largest, relative",
            ),
            Field(
                "angular_momentum_drift",
                "drift of L",
                drift(momentum, size),
                hint="largest, relative to L or h; the vector in space",
            ),
        ]


def _cell(vector: Floats, form: str) -> Cell:
    """Give a vector, and how a table shows it."""
    numbers = _clean(vector)
    return Cell(" ".join(f"{x:{form}}" for x in numbers), numbers)


def _clean(vector: Floats) -> list[float]:
    """Put zero for what is rounding beside the largest component."""
    size = float(np.abs(vector).max())
    return [float(x) if abs(x) > 1e-15 * size else 0.0 for x in vector]
