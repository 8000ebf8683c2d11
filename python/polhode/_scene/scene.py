"""What an animation shows: the frames of a motion and the body in them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from polhode import _core
from polhode._scene.footage import of_motion, of_samples
from polhode._scene.shape import Shape, equivalent_box, given_shape

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode import FreeMotion, GyrostatMotion, HeavyTop, Trajectory
    from polhode._scene.footage import Footage

    Floats = NDArray[np.float64]

__all__ = ["Scene"]


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
    ellipsoid : numpy.ndarray, shape (F, 3)
        Semi-axes of ω·Iω = 2T, along the principal axes about the point of reference.
    axes : numpy.ndarray, shape (3, 3)
        Those axes, as columns in the body frame.
    shape : Shape
        The surface drawn.
    title, time_unit : str
        As the viewer reads them.
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
    ellipsoid: Floats
    axes: Floats
    shape: Shape
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
        shape: tuple[ArrayLike, ArrayLike] | None,
        title: str,
        time_unit: str,
        is_film: bool = False,
    ) -> Scene:
        """Choose the frames of a motion and work out what is drawn in them.

        Where nothing acts on the body its motion is known between the samples too, and the frames are as many
        as it needs; else, or where `frames` says how many, they are samples.
        """
        trajectory._check_series("animate")
        if trajectory.omega.ndim != 2:
            stack = trajectory.omega.shape[:-2]
            raise ValueError(
                f"animate: expected the motion of one body, got a stack of shape {stack}; index it"
            )
        if not np.isfinite(trajectory.omega).all() or not np.isfinite(trajectory.quaternion).all():
            raise ValueError("animate: the motion holds states that are not numbers; it ended early")
        _check_duration(duration)
        motion = trajectory._exact() if frames is None else None
        if motion is not None:
            footage = of_motion(motion, trajectory, duration=duration, is_film=is_film, time_unit=time_unit)
        else:
            footage = of_samples(
                trajectory, frames=frames, duration=duration, is_film=is_film, time_unit=time_unit
            )
        return cls._of_footage(footage, shape, title, time_unit)

    @classmethod
    def of_motion(
        cls,
        motion: FreeMotion | HeavyTop | GyrostatMotion,
        end: float,
        *,
        shape: tuple[ArrayLike, ArrayLike] | None,
        title: str,
        is_film: bool,
    ) -> Scene:
        """Choose the frames of a motion in closed form from 0 s to its end."""
        ends = motion.at([0.0, end])
        footage = of_motion(motion, ends, duration=None, is_film=is_film, time_unit="s")
        return cls._of_footage(footage, shape, title, "s")

    @classmethod
    def _of_footage(
        cls, footage: Footage, shape: tuple[ArrayLike, ArrayLike] | None, title: str, time_unit: str
    ) -> Scene:
        trajectory, chosen = footage.trajectory, footage.chosen
        about = trajectory.about
        principal = trajectory.body.principal_about(about)
        in_axes = trajectory.omega[chosen] @ principal.axes
        momentum = trajectory.angular_momentum().spin[chosen]
        doubled = (in_axes**2) @ principal.moments
        with np.errstate(divide="ignore", invalid="ignore"):
            ellipsoid = np.sqrt(doubled[:, np.newaxis] / principal.moments)
        # About an axis without a moment the ellipsoid is a cylinder without end.
        reach = 1.5 * np.linalg.norm(in_axes, axis=1, keepdims=True).max()
        ellipsoid = np.where(np.isfinite(ellipsoid), np.minimum(ellipsoid, reach), reach)
        return cls(
            t=trajectory.t[chosen],
            quaternion=trajectory.quaternion[chosen],
            omega=trajectory.omega[chosen],
            sample=chosen,
            path=_core.rotate(trajectory.quaternion, trajectory.omega),
            momentum=momentum,
            inside=None if trajectory.carried is None else trajectory.carried[0][chosen],
            ellipsoid=ellipsoid,
            axes=principal.axes,
            shape=equivalent_box(trajectory.body, about) if shape is None else given_shape(*shape, about),
            title=title,
            time_unit=time_unit,
            duration=footage.duration,
            notes=footage.notes,
        )


def _check_duration(duration: float | None) -> None:
    if duration is not None and not (duration > 0.0 and np.isfinite(duration)):
        raise ValueError(f"duration: {duration} is not a positive number of seconds")
