"""The energy that a moving page tells: of motion, and of position where the load has a potential."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from polhode._scene.parts import parts_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import Trajectory
    from polhode._scene.footage import Footage

    Floats = NDArray[np.float64]

__all__ = ["Energy", "energy_of"]


@dataclass(frozen=True)
class Energy:
    """What is known of the energy at the frames.

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
    if potential is None:
        return Energy(kinetic[chosen], None, _why(trajectory), 0.0)
    if not potential.any():
        return Energy(kinetic[chosen], None, "", 0.0, travel)
    size = 0.0 if is_exact else float((kinetic + np.abs(potential)).max())
    return Energy(kinetic[chosen], potential[chosen], "", size)


def _why(trajectory: Trajectory) -> str:
    """Name the parts of a load that have no potential."""
    if trajectory.load is None:
        return "not known: a file does not hold the load"
    states = trajectory.body, trajectory.quaternion[0], trajectory.position[0], trajectory._about_word()
    parts = [part.made_by for part in parts_of(trajectory.load) if part.load.potential(*states) is None]
    names = sorted({"wheel with motor or friction" if name == "wheel" else name for name in parts})
    return f"no potential: {', '.join(names) or 'a compiled part'}"
