"""Pictures of the ellipsoid of inertia: alone, with polhodes, with error ellipses, rolling on a plane."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode._format import at_most
from polhode._hints import check_kind, with_hints
from polhode.draw.plot.axes import (
    arrow,
    axes_3d,
    azimuth_beside,
    curve_on,
    plain_frame,
    solid_ellipsoid,
    to_upright,
    toward_viewer,
)
from polhode.draw.plot.bodies import principal_axes
from polhode.draw.sampling import drawn_times, once_round
from polhode.draw.shape import check_one
from polhode.draw.style import AXIS_COLORS, MOMENTUM_COLOR, OMEGA_COLOR
from polhode.draw.surface import inertia_semi_axes, principal_circles
from polhode.uncertainty.variables import changes_in_principal_axes

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d.axes3d import Axes3D
    from numpy.typing import ArrayLike, NDArray

    from polhode import FreeMotion, GyrostatMotion, RigidBody

    Floats = NDArray[np.float64]


__all__ = [
    "angle_covariance",
    "axis_scatter",
    "ellipsoid",
    "error_ellipses",
    "poinsot",
    "polhode",
    "polhodes",
]


def ellipsoid(
    body: RigidBody,
    ax: Axes3D | None = None,
    *,
    size: float = 1.0,
    center: ArrayLike | None = None,
    opacity: float = 1.0,
    coverage: float | None = 0.95,
    enlarged: float = 1.0,
) -> Axes3D:
    """Draw the ellipsoid of inertia about the centre of mass and the principal axes.

    If the tensor of the body has sigmas, each axis ends in an error ellipse. The axis points into this
    ellipse with the probability `coverage`, to first order. The legend gives the semi-axes of the ellipses as
    angles. An ellipse is dashed where the first order is not enough (see `polhode.Linear`). If two moments
    are equal, their axes are not determined; a dotted circle shows all directions that they may have.

    Parameters
    ----------
    body : RigidBody
        One body.
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
        Where to draw; a new figure by default. To see a body of :func:`body` inside the ellipsoid, use an
        `opacity` of 0.3.
    size : float
        Length of the longest semi-axis. The semi-axes are proportional to 1/√I_k; for a zero moment the
        ellipsoid is infinitely long and is cut off.
    center : array_like, shape (3,), optional
        Where to draw the centre of mass; at its own position by default.
    opacity : float
        Opacity of the surface, from 0 to 1.
    coverage : float or None
        Probability of the error ellipses, 0.95 for 2.4477 standard deviations; None draws none.
    enlarged : float
        Factor by which the ellipses are enlarged; the legend tells it.

    Returns
    -------
    mpl_toolkits.mplot3d.axes3d.Axes3D
    """
    check_kind(body, "body", "RigidBody")
    check_one(body.shape, "body")
    is_given = ax is not None
    ax = axes_3d(ax)
    new = not (is_given and ax.has_data())
    middle = _core.real_numbers(body.center_of_mass if center is None else center, "center")
    semi_axes = inertia_semi_axes(body.principal.moments)
    semi_axes *= size / semi_axes.max()
    solid_ellipsoid(ax, semi_axes, body.principal.axes, middle, opacity)
    for ring in principal_circles():
        points, normals = ((ring * s) @ body.principal.axes.T for s in (semi_axes, 1.0 / semi_axes))
        curve_on(ax, points + middle, normals, "#6B7486", linewidth=0.9)
    principal_axes(body, ax, length=1.2 * size, center=middle)
    if coverage is not None and body.sigma is not None:
        error_ellipses(ax, body, semi_axes, middle, coverage, enlarged)
    if new:
        plain_frame(ax, middle - 1.1 * size, middle + 1.1 * size)
    return ax


@with_hints
def polhodes(
    body: RigidBody,
    ax: Axes3D | None = None,
    *,
    count: int = 4,
    energy: float = 0.5,
    rate_label: str = "rad/s",
) -> Axes3D:
    """Draw polhodes of a body: the curves of ω on the ellipsoid ω·I ω = 2T of one kinetic energy.

    Polhodes about the axis of the least moment are blue and dashed. Polhodes about the axis of the greatest
    moment are green and dash-dotted. The separatrix through the intermediate axis is a solid vermilion line.
    The components of ω are along the principal axes.

    Parameters
    ----------
    body : RigidBody
        One body without zero moments.
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
        Where to draw; a new figure by default.
    count : int
        Number of polhodes about each end of each of the two axes.
    energy : float
        T, in the units of the body.
    rate_label : str
        Word for the unit of ω; it converts no number.

    Returns
    -------
    mpl_toolkits.mplot3d.axes3d.Axes3D
    """
    check_kind(body, "body", "RigidBody")
    check_one(body.shape, "body")
    moments = body.principal.moments
    if moments[0] == 0.0:
        raise ValueError("body: its least moment is zero, so that its ellipsoid of inertia has no end")
    if not energy > 0.0:
        raise ValueError(f"energy: {energy} is not positive")
    ax = axes_3d(ax)
    ax.view_init(elev=18.0, azim=42.0)
    free = _core.RigidBody.from_principal(body.mass, moments)
    semi_axes = np.sqrt(2.0 * energy) * inertia_semi_axes(moments)
    solid_ellipsoid(ax, semi_axes, np.eye(3), np.zeros(3), 1.0)
    # Where the separatrix meets the plane of axes 1 and 3: the angle from axis 3 on the unit sphere.
    edge = np.arctan2(np.sqrt(moments[2] - moments[1]), np.sqrt(moments[1] - moments[0]))
    for axis, dash, span in ((0, "--", np.pi / 2 - edge), (2, "-.", edge)):
        if span == 0.0:
            continue
        for angle in span * np.arange(1, count + 1) / (count + 1):
            start = np.zeros(3)
            start[axis], start[2 - axis] = np.cos(angle), np.sin(angle)
            curve = free.free_motion(start * semi_axes).polhode(241)
            for side in (curve, -curve):
                curve_on(ax, side, side * moments, AXIS_COLORS[axis], linestyle=dash, linewidth=1.3)
    around = np.linspace(0.0, 2.0 * np.pi, 241)[:, np.newaxis]
    for sign in (1.0, -1.0):
        across = np.array([np.sin(edge), 0.0, sign * np.cos(edge)])
        curve = (np.cos(around) * across + np.sin(around) * np.array([0.0, 1.0, 0.0])) * semi_axes
        curve_on(ax, curve, curve * moments, AXIS_COLORS[1])
    reach = 1.1 * semi_axes.max()
    for k, color in enumerate(AXIS_COLORS):
        tip = np.zeros(3)
        tip[k] = semi_axes[k] + 0.2 * semi_axes.max()
        ax.plot(*np.stack([0.0 * tip, tip], axis=-1), color=color, linewidth=1.6, zorder=1)
        ax.text(*(tip * (1.0 + 0.1 * semi_axes.max() / tip[k])), rf"$\omega_{k + 1}$", color=color,
                ha="center", va="center", fontsize=13, zorder=6)  # fmt: skip
    lengths = ", ".join(f"{a:.3g}" for a in semi_axes)
    ax.text2D(
        0.5, 0.03, f"semi-axes {lengths} {rate_label}", transform=ax.transAxes, ha="center", in_layout=False
    )
    plain_frame(ax, 3 * [-reach], 3 * [reach])
    return ax


@with_hints
def polhode(
    motion: FreeMotion | GyrostatMotion,
    ax: Axes3D | None = None,
    *,
    rate_label: str = "rad/s",
) -> Axes3D:
    """Draw the polhode of a motion: the path of ω in the body, on the ellipsoid ω·I ω = 2T of its energy.

    For a gyrostat, T is :meth:`polhode.GyrostatMotion.kinetic_energy`, which leaves out energy of the
    wheels, and I is the tensor in the equations of motion. A disc marks the start of the motion.

    Parameters
    ----------
    motion : FreeMotion or GyrostatMotion
        Motion of one body without zero moments.
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
        Where to draw; a new figure by default.
    rate_label : str
        Word for the unit of ω; it converts no number.

    Returns
    -------
    mpl_toolkits.mplot3d.axes3d.Axes3D
    """
    check_kind(motion, "motion", "FreeMotion", "GyrostatMotion")
    check_one(motion.shape, "motion")
    if isinstance(motion, _core.GyrostatMotion):
        inertia = np.asarray(motion.gyrostat.inertia)
        path = motion.at(once_round(motion)).omega
    else:
        inertia, path = motion.body.inertia, motion.polhode(361)
    principal = _core.principal_axes(inertia)
    energy = float(motion.kinetic_energy().rotational)
    if principal.moments[0] == 0.0:
        raise ValueError("motion: the body has a zero moment, and its ellipsoid no end")
    if not energy > 0.0:
        raise ValueError("motion: the body is at rest, and its ellipsoid of energy is a point")
    new = ax is None
    ax = axes_3d(ax)
    if new:
        start = path[0] / np.linalg.norm(path[0])
        ax.view_init(elev=20.0, azim=float(np.rad2deg(np.arctan2(start[1], start[0]))) + 25.0)
    semi_axes = np.sqrt(2.0 * energy) * inertia_semi_axes(principal.moments)
    solid_ellipsoid(ax, semi_axes, principal.axes, np.zeros(3), 1.0)
    if len(path) > 1:
        curve_on(ax, path, path @ inertia, AXIS_COLORS[1], linewidth=2.2)
    viewer = toward_viewer(ax)
    near = (path[0] @ inertia) @ viewer >= 0.0
    ax.plot(*path[0][:, np.newaxis], linestyle="none", marker="o", markersize=5.0, color=OMEGA_COLOR,
            zorder=8 if near else 3)  # fmt: skip
    for k, color in enumerate(AXIS_COLORS):
        tip = principal.axes[:, k] * (semi_axes[k] + 0.2 * semi_axes.max())
        ax.plot(*np.stack([0.0 * tip, tip], axis=-1), color=color, linewidth=1.6, zorder=1)
        ax.text(*(1.12 * tip), rf"$\omega_{k + 1}$", color=color, ha="center", va="center",
                fontsize=13, zorder=6, alpha=1.0 if tip @ viewer >= 0.0 else 0.4)  # fmt: skip
    sizes = np.linalg.norm(path, axis=1)
    words = f"|ω| from {sizes.min():.3g} to {sizes.max():.3g} {rate_label}"
    ax.text2D(0.5, 0.03, words, transform=ax.transAxes, ha="center", in_layout=False)
    reach = 1.1 * semi_axes.max()
    plain_frame(ax, 3 * [-reach], 3 * [reach])
    return ax


@with_hints
def poinsot(
    motion: FreeMotion,
    t: ArrayLike,
    ax: Axes3D | None = None,
    *,
    rate_label: str = "rad/s",
) -> Axes3D:
    """Draw Poinsot's construction: the ellipsoid that rolls on a fixed plane, polhode and herpolhode.

    Parameters
    ----------
    motion : FreeMotion
        Motion of one body.
    t : array_like, shape (T,)
        Times of the herpolhode; further times are added in between where needed. The ellipsoid is drawn in
        its position at the last time.
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
        Where to draw; a new figure by default. L is drawn upward.
    rate_label : str
        Word for the unit of ω; it converts no number.

    Returns
    -------
    mpl_toolkits.mplot3d.axes3d.Axes3D
    """
    check_kind(motion, "motion", "FreeMotion")
    check_one(motion.shape, "motion")
    times = drawn_times(motion, t)
    found = motion.poinsot(times)
    if not np.isfinite(found.semi_axes).all():
        raise ValueError("motion: the body has a zero moment, and its ellipsoid no end")
    if not np.linalg.norm(motion.angular_momentum().spin) > 0.0:
        raise ValueError("motion: the body is at rest, and nothing rolls")
    ax = axes_3d(ax)
    upright = to_upright(found.normal)
    herpolhode = found.contact @ upright.T
    ax.view_init(elev=17.0, azim=azimuth_beside(herpolhode[-1]))
    attitude = upright @ _core.rotate(motion.at(times[-1:]).quaternion[0], np.eye(3)).T
    axes = attitude @ motion.body.principal.axes
    solid_ellipsoid(ax, found.semi_axes, axes, np.zeros(3), 1.0)
    polhode = motion.polhode(361)
    curve_on(ax, polhode @ attitude.T, (polhode @ motion.body.inertia) @ attitude.T, AXIS_COLORS[1])
    reach = 1.25 * max(found.radii[1], 0.6 * found.semi_axes.max())
    _disc(ax, found.distance, reach)
    ax.plot(*herpolhode.T, color=AXIS_COLORS[0], linewidth=1.3, zorder=5)
    tip = herpolhode[-1]
    ax.scatter(*tip[:, np.newaxis], color=OMEGA_COLOR, s=22, zorder=7, depthshade=False)
    arrow(ax, tip, OMEGA_COLOR, r"$\omega$")
    height = 1.35 * found.distance
    arrow(ax, np.array([0.0, 0.0, height]), MOMENTUM_COLOR, "L")
    ax.text2D(
        0.5, 0.02,
        f"polhode (vermilion) rolls on herpolhode (blue);\nplane at 2T/L = {found.distance:.4g} {rate_label}",
        transform=ax.transAxes, ha="center", in_layout=False,
    )  # fmt: skip
    side = max(reach, float(found.semi_axes.max()))
    plain_frame(ax, (-side, -side, -side), (side, side, height))
    return ax


def _disc(ax: Axes3D, height: float, radius: float) -> None:
    around = np.linspace(0.0, 2.0 * np.pi, 121)
    rim = np.stack([radius * np.cos(around), radius * np.sin(around), np.full(121, height)])
    ax.plot(*rim, color="0.45", linewidth=0.9, zorder=4)
    ax.plot_trisurf(*rim[:, :-1], color="0.6", alpha=0.16, linewidth=0, zorder=4)


_AROUND: Final = np.linspace(0.0, 2.0 * np.pi, 121)
_INK: Final = "#222222"
"""Colour of the circle of axes with any direction in a plane."""


def error_ellipses(
    ax: Axes3D, body: RigidBody, semi_axes: Floats, center: Floats, coverage: float, enlarged: float
) -> None:
    """Draw error ellipses about the ends of the axes, with their sizes; nothing for a certain body.

    Parameters
    ----------
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D
    body : RigidBody
        One body.
    semi_axes : numpy.ndarray, shape (3,)
        Of the ellipsoid that is drawn.
    center : numpy.ndarray, shape (3,)
    coverage : float
        Probability that an axis points into its ellipse.
    enlarged : float
        How many times larger the ellipses are drawn.
    """
    check_kind(body, "body", "RigidBody")
    if not 0.0 < coverage < 1.0:
        raise ValueError(f"coverage: {coverage} is not between 0 and 1; it is a probability, as 0.95")
    if not 0.0 < enlarged < np.inf:
        raise ValueError(f"enlarged: {enlarged} is not positive")
    covariance, sigma = angle_covariance(body), body.sigma
    if covariance is None or sigma is None:
        return
    # In two dimensions the square of a normal distance is exponential: 2.4477 deviations hold 95 %.
    radius = float(np.sqrt(-2.0 * np.log1p(-coverage)))
    ellipses, loose = _ellipses(covariance, radius)
    is_linear = np.asarray(sigma.linear.axes)
    legend: list[Any] = []
    if ellipses:
        widest = max(ellipses, key=lambda k: ellipses[k][0][1])
        angle = float(ellipses[widest][0][1])
        if enlarged * angle >= 0.5 * np.pi:
            raise ValueError(
                f"enlarged: {enlarged:g} times the {np.rad2deg(angle):.3g}° of axis {widest + 1} is no "
                f"ellipse; give less than {at_most(0.5 * np.pi / angle)}"
            )
    for k, (half, vectors) in ellipses.items():
        color, others = AXIS_COLORS[k], [(k + 1) % 3, (k + 2) % 3]
        dash = "-" if is_linear[others].all() else "--"
        # Offsets of the tip along the two other axes, and the directions to them on the unit sphere.
        offsets = (enlarged * half * np.stack([np.cos(_AROUND), np.sin(_AROUND)], axis=-1)) @ vectors.T
        angle = np.linalg.norm(offsets, axis=-1, keepdims=True)
        directions = np.zeros((len(_AROUND), 3))
        directions[:, [k]] = np.cos(angle)
        directions[:, others] = np.sinc(angle / np.pi) * offsets
        for sense in (1.0, -1.0):
            _on_ellipsoid(ax, sense * directions, body, semi_axes, center, color, linestyle=dash)
        size = " × ".join(f"{angle:.2g}°" for angle in np.rad2deg(half[::-1]))
        doubt = "" if dash == "-" else ", first order not enough"
        (line,) = ax.plot([], [], [], color=color, linestyle=dash, label=f"$e_{k + 1}$: ± {size}{doubt}")
        legend.append(line)
    legend += _free_axes(ax, body, semi_axes, center, loose)
    times = "" if enlarged == 1.0 else f",\ndrawn {enlarged:g} times as large"
    title = f"where the axes point with {100.0 * coverage:.4g} %{times}"
    fonts = {"fontsize": "small", "title_fontsize": "small"}
    drawn = ax.legend(handles=legend, title=title, loc="lower center", frameon=False, **fonts)
    drawn.set_in_layout(False)


def _ellipses(
    covariance: Floats, radius: float
) -> tuple[dict[int, tuple[Floats, Floats]], NDArray[np.bool_]]:
    """Return semi-axes and their directions for each axis that has an ellipse, and the angles that are free.

    Free is an angle that is not determined, and one that reaches a right angle: an axis has no sense, so
    that it may point anywhere then.
    """
    loose = np.isnan(np.diagonal(covariance))
    ellipses: dict[int, tuple[Floats, Floats]] = {}
    for k in range(3):
        others = [(k + 1) % 3, (k + 2) % 3]
        if loose[others].any():
            continue
        values, vectors = np.linalg.eigh(axis_scatter(covariance, k))
        half = radius * np.sqrt(np.maximum(values, 0.0))
        ellipses[k] = half, vectors
        if half[1] >= 0.5 * np.pi:
            loose[others[int(np.diagonal(covariance)[others].argmax())]] = True
    # An axis may have come before the one that told.
    kept = {k: found for k, found in ellipses.items() if not np.delete(loose, k).any()}
    return kept, loose


def _free_axes(
    ax: Axes3D, body: RigidBody, semi_axes: Floats, center: Floats, loose: NDArray[np.bool_]
) -> list[Any]:
    """Draw the circle of two axes that may have any direction in their plane; none for a ball."""
    if not loose.any():
        return []
    if loose.sum() > 1:
        return list(ax.plot([], [], [], linestyle="none", label="axes not determined: anywhere"))
    k = int(loose.argmax())
    i, j = sorted({0, 1, 2} - {k})
    _on_ellipsoid(ax, principal_circles()[k], body, semi_axes, center, _INK, linestyle=":", linewidth=2.4)
    label = f"$e_{i + 1}$, $e_{j + 1}$: not determined, anywhere on the circle"
    return list(ax.plot([], [], [], color=_INK, linestyle=":", linewidth=2.4, label=label))


def _on_ellipsoid(
    ax: Axes3D,
    directions: Floats,
    body: RigidBody,
    semi_axes: Floats,
    center: Floats,
    color: str,
    **style: Any,
) -> None:
    """Draw a curve of directions in principal axes where they meet the ellipsoid."""
    points = directions / np.linalg.norm(directions / semi_axes, axis=-1, keepdims=True)
    normals = points / semi_axes**2
    axes = body.principal.axes.T
    curve_on(ax, points @ axes + center, normals @ axes, color, **style)


def angle_covariance(body: RigidBody) -> Floats | None:
    """Compute the covariance of the small rotation φ of the principal axes about them, in rad², shape (3, 3).

    Not numbers where an angle is not determined, as in ``body.sigma.axes``; None where nothing is uncertain.

    Parameters
    ----------
    body : RigidBody
        One body.

    Notes
    -----
    With W = Vᵀ δI V perturbation theory gives φ_k = W_ij / (I_j - I_i) for (i, j, k) in turn.
    """
    check_one(body.shape, "body")
    changes, sigma = changes_in_principal_axes(body), body.sigma
    if changes is None or sigma is None:
        return None
    moments, turned = body.principal.moments, changes[0]
    angles = np.full((3, len(turned)), np.nan)
    for k in np.flatnonzero(~np.isnan(sigma.axes)):
        i, j = (k + 1) % 3, (k + 2) % 3
        gap = moments[j] - moments[i]
        angles[k] = turned[:, i, j] / gap if gap != 0.0 else 0.0  # equal, and nothing about them uncertain
    return np.asarray(angles @ angles.T)


def axis_scatter(covariance: Floats, k: int) -> Floats:
    """Compute the covariance of the direction of axis k, along axes k + 1 and k + 2, shape (2, 2).

    Parameters
    ----------
    covariance : numpy.ndarray, shape (3, 3)
        Of the small rotation φ: the axis moves by φ × e_k.
    k : int
    """
    i, j = (k + 1) % 3, (k + 2) % 3
    return np.array([[covariance[j, j], -covariance[i, j]], [-covariance[i, j], covariance[i, i]]])
