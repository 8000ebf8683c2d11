"""Content of an animation: the frames of a motion, the body in them, and the energy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _core
from polhode.draw.ground import Ground, ground_of, surface_shape
from polhode.draw.load_parts import parts_of
from polhode.draw.pivot import Pivot, pivot_of, top_of
from polhode.draw.sampling import of_motion, of_samples
from polhode.draw.shape import Shape, body_shape, check_size, notes_on, shape_of
from polhode.draw.surface import Surface, surface_of
from polhode.draw.wheels import Disc, discs_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import FreeMotion, GyrostatMotion, HeavyTop, Trajectory
    from polhode.draw.sampling import Footage
    from polhode.draw.shape import GivenShape

    Floats = NDArray[np.float64]

__all__ = [
    "Energy",
    "Scene",
    "energy_of",
]

_FACES = 20_000
"""Triangles of a mesh that pages and films still turn smoothly."""


@dataclass(frozen=True)
class Scene:
    """The frames of one body's motion.

    Attributes
    ----------
    t : numpy.ndarray, shape (F,)
        Time of each frame.
    quaternion, omega : numpy.ndarray, shapes (F, 4) and (F, 3)
        R_NB and the angular velocity in the body frame.
    sample : numpy.ndarray, shape (F,)
        Which sample of the motion each frame is.
    path : numpy.ndarray, shape (T, 3)
        The angular velocity at every sample, components in space.
    momentum : numpy.ndarray, shape (F, 3)
        Spin angular momentum about the point of reference, wheels included, components in space.
    inside : numpy.ndarray, shape (F, 3), or None
        What of it the body carries along beside I ω, components in the body frame.
    axes : numpy.ndarray, shape (3, 3)
        The principal axes about the point of reference, as columns in the body frame.
    moments : numpy.ndarray, shape (3,)
        The moments about them.
    is_free : bool
        Whether the motion is that of a free body, which its first frame determines.
    surface : Surface
        On what the path in the body lies.
    pivot : Pivot or None
        Of a body with a fixed point: what is drawn of that.
    axis_path : numpy.ndarray, shape (T, 3), or None
        Where its axis points at every sample, in space.
    ground : Ground or None
        Of a body that rolls: the plane and the contact, at every sample.
    shape : Shape
        The surface drawn.
    discs : tuple of Disc
        The wheels that turn in the body.
    energy : Energy
        What is known of it.
    title, time_unit : str
        Title and unit of time as they are shown.
    duration : float
        Seconds that the whole motion takes on the screen.
    notes : tuple of str
        What the viewer does not see of the motion.
    """

    t: Floats
    quaternion: Floats
    omega: Floats
    sample: NDArray[np.int64]
    path: Floats
    momentum: Floats
    inside: Floats | None
    axes: Floats
    moments: Floats
    is_free: bool
    surface: Surface
    pivot: Pivot | None
    axis_path: Floats | None
    ground: Ground | None
    shape: Shape
    discs: tuple[Disc, ...]
    energy: Energy
    title: str
    time_unit: str
    duration: float
    notes: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        trajectory: Trajectory,
        *,
        frames: int | None,
        duration: float | None,
        shape: GivenShape | None,
        title: str,
        time_unit: str,
        is_film: bool = False,
        is_page: bool = False,
        fps: float | None = None,
    ) -> Scene:
        """Choose the frames of a motion and compute the content of each.

        Where nothing acts on the body, or gravity alone on a symmetric top, its motion is known between the
        samples too, and the frames are as many as it needs; else, or where `frames` says how many, they are
        samples.
        """
        trajectory._check_series("animate")
        if trajectory.omega.ndim != 2:
            stack = trajectory.omega.shape[:-2]
            raise ValueError(
                f"animate: expected the motion of one body, got a stack of shape {stack}; ask for the motion "
                "of one, as bodies[0].simulate(t, omega[0])"
            )
        known = np.isfinite(trajectory.omega).all(axis=-1) & np.isfinite(trajectory.quaternion).all(axis=-1)
        if not known.all():
            first = f"{trajectory.t[known.argmin()]:.6g} {time_unit}"
            raise ValueError(
                f"animate: from t = {first} on the states are not numbers, since the motion ended early; "
                "simulate to an earlier time"
            )
        _check_duration(duration)
        motion = trajectory._exact() or top_of(trajectory)
        options: dict[str, Any] = {
            "duration": duration,
            "time_unit": time_unit,
            "is_film": is_film,
            "is_page": is_page,
            "fps": fps,
        }
        if motion is not None and frames is None:
            footage = of_motion(motion, trajectory, **options)
        else:
            footage = of_samples(trajectory, frames=frames, **options)
        travel = float(trajectory.kinetic_energy().translational[0])
        return cls._of_footage(
            footage,
            motion,
            shape,
            title,
            time_unit,
            is_cut=not is_page,
            at_most=_FACES if is_page or is_film else None,
            travel=travel if isinstance(motion, _core.FreeMotion) and frames is None else 0.0,
        )

    @classmethod
    def of_motion(
        cls,
        motion: FreeMotion | HeavyTop | GyrostatMotion,
        end: float,
        *,
        shape: GivenShape | None,
        title: str,
        duration: float | None = None,
        time_unit: str = "s",
        is_film: bool = False,
        is_page: bool = False,
        fps: float | None = None,
    ) -> Scene:
        """Choose the frames of a motion in closed form from time 0 to its end."""
        if motion.shape:
            raise ValueError(
                f"animate: expected the motion of one body, got a stack of shape {motion.shape}; ask for the "
                "motion of one, as bodies[0].free_motion(omega[0])"
            )
        if not np.isfinite(end):
            raise ValueError(f"end: {end} is not a finite time")
        _check_duration(duration)
        footage = of_motion(
            motion,
            motion.at([0.0, end]),
            duration=duration,
            time_unit=time_unit,
            is_film=is_film,
            is_page=is_page,
            fps=fps,
        )
        return cls._of_footage(footage, motion, shape, title, time_unit, is_cut=not is_page, at_most=_FACES)

    @classmethod
    def _of_footage(
        cls,
        footage: Footage,
        motion: FreeMotion | HeavyTop | GyrostatMotion | None,
        shape: GivenShape | None,
        title: str,
        time_unit: str,
        *,
        is_cut: bool,
        at_most: int | None,
        travel: float = 0.0,
    ) -> Scene:
        trajectory, chosen = footage.trajectory, footage.chosen
        trajectory._check_constant("animate", "the picture draws one body; plot() draws the states")
        about = trajectory.about
        pivot = pivot_of(trajectory, motion)
        principal = trajectory.body.principal_about(about)
        check_size(principal.moments, "animate: the moments of inertia", "mass and length")
        check_size(trajectory.omega[chosen], "animate: the angular velocity", "time")
        momentum = trajectory.angular_momentum().spin[chosen]
        gyrostat = motion if isinstance(motion, _core.GyrostatMotion) else None
        ground = ground_of(trajectory)
        notes: tuple[str, ...] = ()
        if ground is not None and shape is None:  # what touches the plane, which another shape may not
            assert trajectory._contact is not None
            drawn = surface_shape(trajectory._contact.surface, about)
        elif shape is None:
            drawn, notes = body_shape(trajectory.body, about, is_cut=is_cut)
        else:
            drawn = shape_of(shape, about, is_cut=is_cut, at_most=at_most)
            notes = notes_on(drawn)
        return cls(
            t=trajectory.t[chosen],
            quaternion=trajectory.quaternion[chosen],
            omega=trajectory.omega[chosen],
            sample=chosen,
            path=_core.rotate(trajectory.quaternion, trajectory.omega),
            momentum=momentum,
            inside=None if trajectory.carried is None else trajectory.carried[0][chosen],
            axes=principal.axes,
            moments=principal.moments,
            is_free=isinstance(motion, _core.FreeMotion),
            surface=surface_of(trajectory, motion),
            pivot=pivot,
            axis_path=None if pivot is None else _core.rotate(trajectory.quaternion, pivot.axis),
            ground=ground,
            shape=drawn,
            discs=discs_of(footage, drawn, gyrostat),
            energy=energy_of(footage, is_exact=motion is not None, travel=travel),
            title=title,
            time_unit=time_unit,
            duration=footage.duration,
            notes=(*footage.notes, *notes),
        )


def _check_duration(duration: float | None) -> None:
    if duration is not None and not (duration > 0.0 and np.isfinite(duration)):
        raise ValueError(f"duration: {duration} is not a positive number of seconds")


@dataclass(frozen=True)
class Energy:
    """The energy at the frames, as far as it is known.

    Attributes
    ----------
    kinetic : numpy.ndarray, shape (F,)
        T, that of the way of the centre of mass and of what the body carries along included.
    potential : numpy.ndarray, shape (F,), or None
        V; None where there is none, or where the load has no part in the energy at all.
    why : str
        Why there is no V though something acts.
    size : float
        The greatest T + |V|, with which a drift is compared; 0 where the states are those of a closed form.
    travel : float
        Of T the part of a free body's centre of mass.
    """

    kinetic: Floats
    potential: Floats | None
    why: str
    size: float
    travel: float = 0.0


def energy_of(footage: Footage, *, is_exact: bool, travel: float = 0.0) -> Energy:
    """Find the energy at the frames of a motion.

    Parameters
    ----------
    footage : Footage
        The states that are shown.
    is_exact : bool
        Whether they are those of a closed form, which has no drift.
    travel : float
        Energy of the centre of mass of a free body, whose closed form has it at rest.
    """
    trajectory, chosen = footage.trajectory, footage.chosen
    kinetic = trajectory.kinetic_energy().total + travel
    potential = trajectory._potential()
    if _plane_works(trajectory):
        return Energy(kinetic[chosen], None, "T + V is not kept: the plane does work", 0.0)
    if potential is None:
        return Energy(kinetic[chosen], None, _why(trajectory), 0.0)
    if not potential.any():
        return Energy(kinetic[chosen], None, "", 0.0, travel)
    size = 0.0 if is_exact else float((kinetic + np.abs(potential)).max())
    return Energy(kinetic[chosen], potential[chosen], "", size)


def _plane_works(trajectory: Trajectory) -> bool:
    """Return whether the plane on which the body rolls or slips may give or take energy."""
    plane, contact = trajectory._contact, trajectory.contact
    if plane is None or contact is None:
        return False
    slips = (contact.phase == "sliding").any() and plane.friction != 0.0
    return bool(plane.turntable or plane.resistance or slips)


def _why(trajectory: Trajectory) -> str:
    """Name the parts of a load that have no potential."""
    if trajectory.load is None:
        return "not known: a file does not hold the load"
    states = trajectory.body, trajectory.quaternion[0], trajectory.position[0], trajectory._about_word()
    parts = [part.made_by for part in parts_of(trajectory.load) if part.load.potential(*states) is None]
    names = sorted({"wheel with motor or friction" if name == "wheel" else name for name in parts})
    return f"no potential: {', '.join(names) or 'a compiled part'}"
