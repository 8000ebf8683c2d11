"""The exceptions of polhode.

Every one of them is a :class:`ValueError`, so that ``except ValueError`` catches bad input whatever
its kind. Each message names the argument, the row of a stack, the number that offends, the law it
breaks and the way out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from polhode._core import RigidBody
    from polhode.trajectory import Trajectory

__all__ = [
    "FileFormatError",
    "IntegrationError",
    "InvalidInertiaError",
    "MeshError",
    "PolhodeError",
    "QuadratureError",
    "SingularAttitudeError",
]


class PolhodeError(ValueError):
    """Base class of the errors that polhode raises about physics and data."""


class InvalidInertiaError(PolhodeError):
    """Mass properties that no real body has."""


class MeshError(PolhodeError):
    """A mesh that does not bound a solid: open, inconsistently wound, inverted or degenerate.

    Attributes
    ----------
    law : str
        ``"closed"`` where the mesh is open; else ``""``.
    way_out : str
        What the message names as the way out, at its end; ``""`` where `law` is.
    """

    law: str = ""
    way_out: str = ""

    def offer(self, way_out: str) -> None:
        """Name another way out, before the one that the message has."""
        fault = str(self).removesuffix(self.way_out)
        self.args = (f"{fault}{way_out}; or {self.way_out}" if self.way_out else f"{fault} ({way_out})",)


class FileFormatError(PolhodeError):
    """A file that is not what its name or header says."""


class IntegrationError(PolhodeError):
    """An integration that could not go on; the message tells why.

    Attributes
    ----------
    row : int
        Which body of the stack, counted through the flattened stack.
    time : float
        The time that was reached.
    state : tuple of numpy.ndarray
        ``(quaternion, omega)`` at that time.
    partial : Trajectory
        What had been computed; not a number after ``time``.
    """

    row: int
    time: float
    state: tuple[object, object]
    partial: Trajectory | None


class QuadratureError(PolhodeError):
    """An integral over a density that did not reach its tolerance.

    Attributes
    ----------
    estimate : RigidBody
        The body as far as it is known.
    error : float
        Its estimated relative error.
    evaluations : int
        Number of points at which the density was asked for.
    """

    estimate: RigidBody
    error: float
    evaluations: int


class SingularAttitudeError(PolhodeError):
    """An attitude at which the Euler angles or rates asked for are not defined."""
