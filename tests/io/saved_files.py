"""Files as this version saves them, which later ones read: ``python tests/io/saved_files.py`` at a release.

They stay in ``tests/io/saved``, a folder for each version that changed what is saved; all are read by
``test_saved_files.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import polhode
from polhode import RigidBody, Trajectory, solids

FOLDER = Path(__file__).with_name("saved")

#: Two boxes: of 12 kg, with edges 1, 2, 3 m, at x = 1 m; and one twice as heavy.
MASSES = np.array([12.0, 24.0])
#: Their moments about C, m (b² + c²)/12.
MOMENTS = np.array([5.0, 10.0, 13.0])
#: One standard deviation of the mass.
SIGMA = 0.25
#: About the axis of the largest moment, so that ω stays what it is: rad/s, and when.
RATE = 0.5
TIMES = np.array([0.0, 1.0, 3.0])


def boxes() -> RigidBody:
    """The stack, its axes those of the frame in the order z, y, x."""
    return solids.box((1.0, 2.0, 3.0), mass=MASSES).translated((1.0, 0.0, 0.0))


def uncertain() -> RigidBody:
    """The first box, its mass uncertain."""
    return solids.box((1.0, 2.0, 3.0), mass=polhode.Uncertain(12.0, SIGMA))


def motion() -> Trajectory:
    """The first box, turning about x."""
    return solids.box((1.0, 2.0, 3.0), mass=12.0).simulate(TIMES, (RATE, 0.0, 0.0))


def main() -> None:
    """Write the files of this version."""
    folder = FOLDER / polhode.__version__
    folder.mkdir(parents=True, exist_ok=True)
    for suffix in ("json", "npz"):
        boxes().save(folder / f"bodies.{suffix}")
        uncertain().save(folder / f"uncertain.{suffix}")
        motion().save(folder / f"motion.{suffix}")


if __name__ == "__main__":
    main()
