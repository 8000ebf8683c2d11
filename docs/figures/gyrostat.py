"""Paths of the angular momentum in a body with wheels, as the momentum of the wheels grows."""

import itertools

import numpy as np
from _scene import BLUE, GRAY, GREEN, INK, RED, Scene, X, Y, Z, save, unit
from matplotlib.figure import Figure
from polhode import Gyrostat, RigidBody

BODY = RigidBody.from_principal(1.0, (1.0, 1.8, 2.6))
INSIDE = unit((0.25, 0.2, 0.3))
SIZES = (0.12, 0.27, 0.6)
"""Of h, in units of L: six, four and two equilibria."""
LOOKS = {"minimum": (GREEN, "o"), "maximum": (BLUE, "^"), "saddle": (RED, "X")}


def draw() -> Figure:
    """Draw one sphere for each size of h: curves of constant energy, equilibria, and h itself."""
    scene = Scene(9.6, 4.0, azimuth=42.0, elevation=20.0, panels=len(SIZES))
    theta, phi = np.meshgrid(np.linspace(0, np.pi, 40), np.linspace(0, 2 * np.pi, 80))
    sphere = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    for number, size in enumerate(SIZES):
        gyrostat = BODY.gyrostat(size * INSIDE)
        found = gyrostat.equilibria(1.0)
        scene.panel(number, f"$h = {size:g}\\,L$: {len(found.kind)} equilibria")
        scene.hull(sphere.reshape(-1, 3))
        for start, color in starts(gyrostat, found.direction, found.kind.tolist()):
            curve(scene, gyrostat, start, color)
        for kind, n in zip(found.kind.tolist(), found.direction, strict=True):
            mark(scene, n, kind)
        for axis, name in ((X, "$1$"), (Y, "$2$"), (Z, "$3$")):
            scene.line(axis, 1.2 * axis, color=INK, linewidth=1.2)
            scene.label(1.34 * axis, name)
        scene.line(INSIDE, 1.25 * INSIDE, color=INK, linewidth=2.6, zorder=6)
        scene.label(1.36 * INSIDE, r"$\mathbf{h}$")
    return scene.figure


def energy(gyrostat: Gyrostat, n: np.ndarray) -> float:
    """Of the body, where L is this unit vector."""
    off = n - gyrostat.momentum
    return float(0.5 * off @ np.linalg.solve(gyrostat.inertia, off))


def starts(gyrostat: Gyrostat, points: np.ndarray, kinds: list[str]) -> list[tuple[np.ndarray, str]]:
    """Where curves begin: at saddles, and on the ways from each equilibrium to its neighbours."""
    found: list[tuple[np.ndarray, str]] = []
    saddles = [n for n, kind in zip(points, kinds, strict=True) if kind == "saddle"]
    levels = sorted(energy(gyrostat, n) for n in saddles)
    for n, kind in zip(points, kinds, strict=True):
        if kind == "saddle":
            continue
        nearest = sorted(saddles or points, key=lambda other, n=n: float(-other @ n))[0 if saddles else -1]
        parts = (0.2, 0.4, 0.62) if saddles else (0.12, 0.24, 0.36, 0.48)
        found += [(way(n, nearest, part), LOOKS[kind][0]) for part in parts]
    for low, high in itertools.pairwise(levels):
        a, b = (next(n for n in saddles if energy(gyrostat, n) == level) for level in (low, high))
        found += [(way(a, b, part), GRAY) for part in (0.3, 0.45, 0.6)]
    for n in saddles:
        found += [(n + 1e-3 * across, RED) for across in level_directions(gyrostat, n)]
    return found


def level_directions(gyrostat: Gyrostat, n: np.ndarray) -> list[np.ndarray]:
    """The four ways from a saddle on which the energy stays as it is."""
    u = unit(np.cross(n, X if abs(n[0]) < 0.8 else Y))
    v = np.cross(n, u)
    angles = np.linspace(0.0, 2.0 * np.pi, 7201)
    rings = n + 1e-3 * (np.cos(angles)[:, np.newaxis] * u + np.sin(angles)[:, np.newaxis] * v)
    rings /= np.linalg.norm(rings, axis=1)[:, np.newaxis]
    above = np.array([energy(gyrostat, ring) for ring in rings]) > energy(gyrostat, n)
    return [(rings[k] - n) / 1e-3 for k in np.flatnonzero(above[1:] != above[:-1])]


def way(a: np.ndarray, b: np.ndarray, part: float) -> np.ndarray:
    """A point on the great circle from a to b."""
    angle = np.arccos(np.clip(a @ b, -1.0, 1.0))
    if angle > 3.1:
        b = unit(np.cross(a, X))
        angle = 0.5 * np.pi
    return (np.sin((1 - part) * angle) * a + np.sin(part * angle) * b) / np.sin(angle)


def curve(scene: Scene, gyrostat: Gyrostat, start: np.ndarray, color: str) -> None:
    """The path of L, its part on the far side faint."""
    omega = np.linalg.solve(gyrostat.inertia, unit(start) - gyrostat.momentum)
    motion = gyrostat.free_motion(omega)
    fine = motion.at(np.linspace(0.0, motion.periods.rotation, 4001)).omega @ gyrostat.inertia + motion.rotor
    gone = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1))])
    count = max(16, int(gone[-1] / 0.06))
    path = np.stack(
        [np.interp(np.linspace(0.0, gone[-1], count), gone, column) for column in fine.T], axis=-1
    )
    near = path @ scene.toward_viewer >= 0.0
    width = 1.7 if color == RED else 1.0
    for side, style in ((near, {"linewidth": width}), (~near, {"linewidth": 0.6, "alpha": 0.3})):
        shown = side | np.roll(side, 1) if side is near else side
        scene.line(np.where(shown[:, np.newaxis], path, np.nan), color=color, **style)


def mark(scene: Scene, n: np.ndarray, kind: str) -> None:
    """An equilibrium, faint on the far side."""
    color, marker = LOOKS[kind]
    is_near = bool(n @ scene.toward_viewer >= 0.0)
    x, y = scene.flat(n)
    scene.ax.plot(
        [x], [y], linestyle="none", marker=marker, color=color, markersize=8 if is_near else 6,
        markeredgecolor="white", markeredgewidth=0.8, alpha=1.0 if is_near else 0.4, zorder=5,
    )  # fmt: skip


if __name__ == "__main__":
    save(draw(), __file__)
