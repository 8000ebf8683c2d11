"""Motions for moving pictures; checks of the frames of a picture and of the elements of a page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from oracles.bodies import matrix
from polhode import RigidBody, Trajectory, euler_angles, solids
from polhode.draw.sampling import TURN

if TYPE_CHECKING:
    from browser import Browser
    from numpy.typing import NDArray
    from polhode import FreeMotion, HeavyTop

    Floats = NDArray[np.float64]


BRICK = RigidBody.from_principal(1.0, (1.0, 3.0, 3.2))
CONE = solids.cone(radius=0.03, height=0.06, mass=0.1).rotated((1.0, 0.0, 0.0, 0.0)).translated((0, 0, 0.045))
DESK, PHONE, ON_ITS_SIDE = (1200, 820), (390, 844), (700, 420)
START = (0.01, 6.0, 0.0)
TOLD = """Object.fromEntries([...document.querySelectorAll("#readouts div")].map(
  (row) => [...row.children].map((cell) => cell.textContent)))"""
IN_VIEW = """(() => {{
  const box = document.getElementById("{}").getBoundingClientRect(), right = box.right <= innerWidth;
  return box.width > 0 && box.left >= 0 && box.top >= 0 && right && box.bottom <= innerHeight;
}})()"""


def top(spin: float, tilt: float = 0.5, nod: float = 0.0) -> HeavyTop:
    return CONE.heavy_top((nod, 0.0, spin), euler_angles.to_quaternion((0.0, tilt, 0.0)), (0.0, 0.0, -9.81))


def angles(quaternion: Floats) -> Floats:
    """The turn from each attitude to the next, by the shorter way."""
    products = np.abs((quaternion[1:] * quaternion[:-1]).sum(axis=-1))
    return np.asarray(2.0 * np.arccos(np.minimum(1.0, products)))


def check_frames(
    motion: FreeMotion | HeavyTop, t: Floats, rate: float, turn: float = TURN, chord: float = 0.002
) -> None:
    """No turn above 20 degrees, no chord deeper than 0.2 %: of the ellipsoid; in space of the longest ω."""
    shown = motion.at(t)
    assert angles(shown.quaternion).max() <= turn * (1.0 + 1e-9)
    assert (np.abs(np.diff(t)) * rate).max() <= turn * (1.0 + 1e-9)
    body = motion.body
    tensor = body.inertia_about(shown.about)
    middles = 0.5 * (shown.omega[1:] + shown.omega[:-1])
    doubled = np.einsum("ti,ij,tj->t", shown.omega, tensor, shown.omega)
    level = np.einsum("ti,ij,tj->t", middles, tensor, middles)
    if np.ptp(doubled) <= 1e-9 * doubled.max():  # one ellipsoid
        assert (level >= (1.0 - chord) ** 2 * doubled[0] * (1.0 - 1e-9)).all()
    check_chords(lambda times: in_space(motion.at(times)) / rate, t, chord)


def check_chords(curve: Any, t: Floats, deepest: float = 0.002) -> None:
    """Halfway in time the curve is no farther from its chord than that."""
    ends, middle = curve(t), curve(0.5 * (t[1:] + t[:-1]))
    chord = ends[1:] - ends[:-1]
    length = np.maximum(np.linalg.norm(chord, axis=-1, keepdims=True), 1e-300)
    off = middle - ends[:-1]
    across = off - (off * chord / length).sum(axis=-1, keepdims=True) * chord / length
    assert np.linalg.norm(across, axis=-1).max() <= deepest * (1.0 + 1e-9)


def in_space(shown: Trajectory) -> Floats:
    return np.stack([matrix(q) @ w for q, w in zip(shown.quaternion, shown.omega, strict=True)])


def inside(browser: Browser, identity: str) -> bool:
    """Whether an element is in view as a whole, without scrolling."""
    return bool(browser.run(IN_VIEW.format(identity)))


def middle(browser: Browser, identity: str) -> tuple[float, float]:
    x, y = browser.run(
        f"(() => {{ const b = document.getElementById({identity!r}).getBoundingClientRect();"
        "return [b.left + b.width / 2, b.top + b.height / 2] })()"
    )
    return x, y
